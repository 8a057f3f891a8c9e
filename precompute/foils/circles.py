"""The foil of discs in concentric rings, as large as their places let them be."""

from __future__ import annotations

import numpy as np

from precompute.foils.pieces import Pieces, foil_of_pieces
from precompute.foils.places import ROOMY, from_nearest, room, spread_points
from precompute.foils.recipe import CirclesFoilRecipe
from precompute.maps import Map


def circles_foil(recipe: CirclesFoilRecipe) -> Map:
    """A tile of discs, each of which touches its nearest neighbour's disc at most."""
    rng = np.random.default_rng(recipe.seed)
    return foil_of_pieces(recipe, _parted(recipe, rng), rng)


def _parted(recipe: CirclesFoilRecipe, rng: np.random.Generator) -> Pieces:
    points = spread_points(rng, recipe.circles, ROOMY)
    disc, distance, _, to_cell = from_nearest(points, recipe.size)
    width = room(points)[disc] / recipe.rings
    ring = np.minimum((distance / width).astype(np.intp), recipe.rings)  # the last is the ground
    circle = np.clip(np.round(distance / width), 1, recipe.rings)  # the nearest drawn
    to_seam = np.abs(distance - circle * width)

    ground = ring == recipe.rings
    to_seam = np.where(ground, np.minimum(to_seam, to_cell / 2), to_seam)
    bare = to_seam < recipe.border
    if not recipe.ground:
        bare |= ground
    # From ring to ring by an equal step; all equally often on the tile.
    step = max(recipe.orientations // (recipe.rings + 1), 1)
    turn = rng.permutation(recipe.circles)[:, None] + step * np.arange(recipe.rings + 1)
    return Pieces(disc * (recipe.rings + 1) + ring, bare, turn.ravel())
