"""The foil of faceted stars, as large as their places let them be."""

from __future__ import annotations

import numpy as np

from precompute.foils.pieces import Pieces, foil_of_pieces
from precompute.foils.places import ROOMY, from_nearest, room, spread_points
from precompute.foils.recipe import StarsFoilRecipe
from precompute.maps import Map


def stars_foil(recipe: StarsFoilRecipe) -> Map:
    """A tile of stars, turned at random, that touch the nearest of the others' discs at most."""
    rng = np.random.default_rng(recipe.seed)
    return foil_of_pieces(recipe, _parted(recipe, rng), rng)


def _parted(recipe: StarsFoilRecipe, rng: np.random.Generator) -> Pieces:
    points = spread_points(rng, recipe.stars, ROOMY)
    turned = rng.random(recipe.stars) * 2 * np.pi
    star, distance, direction, to_cell = from_nearest(points, recipe.size)
    tip = room(points)[star]

    # Facets from one point's line to the next notch's, then on to the next point's, and so on;
    # the odd ones are mirrored so that the edge always runs from the point (tip, 0) to the notch.
    facets = 2 * recipe.points
    angle = np.pi / recipe.points
    from_tip = np.mod(direction - turned[star], 2 * np.pi)
    facet = np.minimum((from_tip / angle).astype(np.intp), facets - 1)
    within = from_tip - facet * angle
    within = np.where(facet % 2 == 1, angle - within, within)
    x, y = distance * np.cos(within), distance * np.sin(within)
    notch = recipe.notch * tip
    edge_x, edge_y = notch * np.cos(angle) - tip, notch * np.sin(angle)
    inwards = (edge_x * y - edge_y * (x - tip)) / np.hypot(edge_x, edge_y)
    to_ridge = distance * np.sin(np.minimum(within, angle - within))

    inside = inwards > 0
    to_seam = np.minimum(np.abs(inwards), np.where(inside, to_ridge, to_cell / 2))
    bare = to_seam < recipe.border
    if not recipe.ground:
        bare |= ~inside
    index = star * (facets + 1) + np.where(inside, facet, facets)
    # Different in all pieces of a star, as far as orientations go; all equally often on the tile.
    turn = rng.permutation(recipe.stars)[:, None] + rng.permutation(facets + 1)
    return Pieces(index, bare, turn.ravel())
