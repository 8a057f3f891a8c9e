"""From a recipe's file to a map's files."""

from __future__ import annotations

from pathlib import Path

from precompute.efficiencies import profile_map
from precompute.foils import polygons_foil
from precompute.lobes import lobes_map, metals_map
from precompute.maps import Map
from precompute.recipes import (
    LobesRecipe,
    MetalsRecipe,
    PolygonsFoilRecipe,
    ProfileRecipe,
    Recipe,
    read_recipe,
)


def bake(file: Path, folder: Path) -> list[Path]:
    """Bake one recipe; the map takes the recipe's name.

    Args:
        file: The recipe.
        folder: Where the map goes.

    Returns:
        The files written, the sidecar last.

    Raises:
        InputError: The recipe is not one.
    """
    return baked_map(read_recipe(file), file.parent).write(folder, file.stem)


def baked_map(recipe: Recipe, beside: Path) -> Map:
    """The map of a recipe; files it names are looked for in `beside`."""
    match recipe:
        case ProfileRecipe():
            return profile_map(recipe)
        case LobesRecipe():
            return lobes_map(recipe, beside)
        case MetalsRecipe():
            return metals_map(recipe)
        case PolygonsFoilRecipe():
            return polygons_foil(recipe)
