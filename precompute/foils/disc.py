"""The foil of one disc of concentric tracks."""

from __future__ import annotations

import numpy as np

from precompute.foils.foil_map import foil_map
from precompute.foils.places import texel_places
from precompute.foils.recipe import DiscFoilRecipe
from precompute.maps import Map


def disc_foil(recipe: DiscFoilRecipe) -> Map:
    """A tile with a disc in its middle, bare within and around it."""
    x, y = (recipe.tile_mm * (place - 0.5) for place in texel_places(recipe.size))
    radius = np.hypot(x, y)
    outer = recipe.tile_mm / 2 if recipe.outer_mm is None else recipe.outer_mm
    return foil_map(
        np.arctan2(y, x),
        1 / recipe.period,
        np.where((radius >= recipe.inner_mm) & (radius <= outer), 1.0, 0.0),
        height=recipe.height,
        tile_mm=recipe.tile_mm,
        recipe=recipe.model_dump(),
    )
