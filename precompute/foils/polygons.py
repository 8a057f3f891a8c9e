"""The foil of polygons: the cells of points scattered over a torus, so that it repeats."""

from __future__ import annotations

import numpy as np

from precompute.foils.pieces import Pieces, foil_of_pieces
from precompute.foils.places import from_nearest, spread_points
from precompute.foils.recipe import PolygonsFoilRecipe
from precompute.maps import Map


def polygons_foil(recipe: PolygonsFoilRecipe) -> Map:
    """A tile of polygons."""
    rng = np.random.default_rng(recipe.seed)
    points = spread_points(rng, recipe.polygons)
    cell, _, _, to_border = from_nearest(points, recipe.size)
    turn = rng.permutation(recipe.polygons)
    pieces = Pieces(cell, to_border < 2 * recipe.border, turn)
    return foil_of_pieces(recipe, pieces, rng)
