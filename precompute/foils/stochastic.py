"""The stochastic foil: shapes at random places with gratings drawn from a distribution.

Theory: Toisoul, Dhillon and Ghosh 2018, section 4.5.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from precompute.foils import shapes
from precompute.foils.distribution import GratingDistribution
from precompute.foils.foil_map import foil_map
from precompute.foils.places import from_nearest
from precompute.foils.recipe import FileDistribution, StochasticFoilRecipe
from precompute.foils.spiral import spiral
from precompute.maps import Map
from precompute.validation import first_failure


def stochastic_foil(recipe: StochasticFoilRecipe, folder: Path) -> Map:
    """A tile of strewn shapes.

    Args:
        recipe: The design.
        folder: Where the files are that it names.

    Raises:
        InputError: A file that it names is missing or cannot be used.
    """
    rng = np.random.default_rng(recipe.seed)
    distribution = distribution_of(recipe, folder)
    index = _texture(recipe, folder, rng)
    orientation, frequency = distribution.sample(rng, int(index.max()) + 1)
    return foil_map(
        orientation[index],
        frequency[index],
        np.where(index < 0, 0.0, 1.0),  # what is bare takes the last shape's grating
        height=recipe.height,
        tile_mm=recipe.tile_mm,
        recipe=recipe.model_dump(),
    )


def design_from_file(file: Path, options: Mapping[str, Any]) -> Map:
    """A tile of shapes that follow the distribution of a file.

    Args:
        file: A distribution (`precompute.foils.distribution`).
        options: Fields of a `StochasticFoilRecipe` that are not its defaults; the path of
            ``mask`` is one by itself, not beside the recipe.

    Raises:
        InputError: An option is out of range, or a file cannot be used.
    """
    folder = file.parent
    contents = {
        "kind": "foil",
        "design": "stochastic",
        "distribution": {"kind": "file", "file": file.name},
        **options,
    }
    if "mask" in options:
        contents["mask"] = os.path.relpath(options["mask"], folder)
    try:
        recipe = StochasticFoilRecipe.model_validate(contents)
    except ValidationError as failure:
        raise first_failure("design stochastic", failure, contents) from failure
    return stochastic_foil(recipe, folder)


def distribution_of(recipe: StochasticFoilRecipe, folder: Path) -> GratingDistribution:
    """The distribution that a recipe states or names.

    Raises:
        InputError: As `GratingDistribution.read`.
    """
    if isinstance(recipe.distribution, FileDistribution):
        return GratingDistribution.read(folder / recipe.distribution.file)
    return spiral(recipe.distribution)


def _texture(
    recipe: StochasticFoilRecipe, folder: Path, rng: np.random.Generator
) -> NDArray[np.intp]:
    """The shape at each texel, −1 where there is none."""
    side = recipe.shape_mm / recipe.tile_mm
    if recipe.cover is None:  # polygons
        return from_nearest(rng.random((round(1 / side**2), 2)), recipe.size)[0]
    figure = _figure(recipe, folder)
    count = np.ceil(recipe.cover / (side**2 * shapes.area(figure)))
    return shapes.strewn(figure, rng.random((int(count), 2)), side, recipe.size)


def _figure(recipe: StochasticFoilRecipe, folder: Path) -> shapes.Figure:
    match recipe.shape, recipe.mask:
        case "mask", str(file):
            return shapes.mask(folder / file)
        case "discs", _:
            return shapes.disc
        case _:
            return shapes.square
