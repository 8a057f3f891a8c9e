"""From a recipe's file to the files of its maps."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from precompute.efficiencies import profile_map
from precompute.foils.circles import circles_foil
from precompute.foils.disc import disc_foil
from precompute.foils.figures import figures_foil
from precompute.foils.polygons import polygons_foil
from precompute.foils.recipe import (
    CirclesFoilRecipe,
    DiscFoilRecipe,
    FiguresFoilRecipe,
    PolygonsFoilRecipe,
    StarsFoilRecipe,
    StochasticFoilRecipe,
)
from precompute.foils.stars import stars_foil
from precompute.foils.stochastic import stochastic_foil
from precompute.height_fields.baked import baked_map
from precompute.height_fields.expansion import check_taylor
from precompute.height_fields.prepare import prepared
from precompute.height_fields.recipe import HeightFieldRecipe
from precompute.height_fields.terms import terms_map
from precompute.lobes import lobes_map, metals_map
from precompute.maps import Map
from precompute.recipes import (
    LobesRecipe,
    MetalsRecipe,
    ProfileRecipe,
    Recipe,
    read_recipe,
)


def bake(file: Path, folder: Path) -> list[Path]:
    """Bake one recipe; a map takes its recipe's name, a height field's its method's as well.

    Args:
        file: The recipe.
        folder: Where the maps go.

    Returns:
        The files written, each map's sidecar last.

    Raises:
        InputError: The recipe is not one, or what it asks for cannot be made.
    """
    written = []
    for suffix, baked in baked_maps(read_recipe(file), file):
        written += baked.write(folder, file.stem + suffix)
    return written


def baked_maps(recipe: Recipe, file: Path) -> Iterator[tuple[str, Map]]:
    """The maps of a recipe, one after the other, each with what its name adds to the recipe's.

    Args:
        recipe: What to bake.
        file: The recipe's file; others that it names are looked for beside it.
    """
    match recipe:
        case ProfileRecipe():
            yield "", profile_map(recipe)
        case LobesRecipe():
            yield "", lobes_map(recipe, file.parent)
        case MetalsRecipe():
            yield "", metals_map(recipe)
        case PolygonsFoilRecipe():
            yield "", polygons_foil(recipe)
        case StarsFoilRecipe():
            yield "", stars_foil(recipe)
        case CirclesFoilRecipe():
            yield "", circles_foil(recipe)
        case DiscFoilRecipe():
            yield "", disc_foil(recipe)
        case FiguresFoilRecipe():
            yield "", figures_foil(recipe)
        case StochasticFoilRecipe():
            yield "", stochastic_foil(recipe, file.parent)
        case HeightFieldRecipe():
            yield from _height_field_maps(recipe, file)


def _height_field_maps(recipe: HeightFieldRecipe, file: Path) -> Iterator[tuple[str, Map]]:
    """A map for each method."""
    field = prepared(recipe, file.parent)
    if "taylor" in recipe.methods:
        check_taylor(field, file)  # before any of the maps is written
    for method in recipe.methods:
        if method == "baked":
            baked = baked_map(field, recipe, file)
        else:
            stated = recipe.model_dump(mode="json")
            baked = terms_map(field, method, recipe.terms, recipe.error, stated, file)
        yield f"-{method}", baked
