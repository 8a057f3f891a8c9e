"""Tiles of pieces, each a grating of its own: which texel lies in which, and their gratings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from precompute.foils.foil_map import foil_map
from precompute.foils.places import texel_places
from precompute.foils.recipe import DrawnFoilRecipe
from precompute.maps import Map

Array = NDArray[np.float64]


@dataclass
class Pieces:
    """How a tile is parted.

    Attributes:
        index: The piece of each texel, shape (rows, columns).
        bare: Texels that do not diffract, of that shape.
        turn: Each piece's turn in the round robin of orientations, shape (pieces,).
    """

    index: NDArray[np.intp]
    bare: NDArray[np.bool_]
    turn: NDArray[np.intp]


def foil_of_pieces(recipe: DrawnFoilRecipe, pieces: Pieces, rng: np.random.Generator) -> Map:
    """Give each piece its grating: orientations as it is their turn, periods shuffled.

    Args:
        recipe: Which orientations and periods there are.
        pieces: Where they go.
        rng: Shuffles.

    Returns:
        The map of the tile.
    """
    θ = np.pi * (pieces.turn % recipe.orientations) / recipe.orientations
    place = rng.permutation(pieces.turn.size)[pieces.index]
    if recipe.period_range is None:
        periods = np.asarray(recipe.periods, float)
        period = periods[place % periods.size]
    else:
        shortest, longest = recipe.period_range
        share = place / (pieces.turn.size - 1)
        if recipe.variation == "smooth":
            x, y = texel_places(recipe.size)
            share = (2 - np.cos(2 * np.pi * x) - np.cos(2 * np.pi * y)) / 4
        period = shortest + (longest - shortest) * share
    return foil_map(
        θ[pieces.index],
        1 / period,
        np.where(pieces.bare, 0.0, 1.0),
        height=recipe.height,
        tile_mm=recipe.tile_mm,
        recipe=recipe.model_dump(),
    )
