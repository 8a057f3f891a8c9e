"""Recipes: the JSON files from which maps are baked."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError, field_validator

from precompute.errors import unreadable
from precompute.gratings import Positive
from precompute.profiles import Profile
from precompute.spectra import Observer
from precompute.validation import first_failure


class _Recipe(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class ProfileRecipe(_Recipe):
    """A table of efficiencies η_m(φ).

    Attributes:
        profile: The shape of one period.
        max_order: Largest |m| in the table.
        max_phase: Largest φ, rad; 20 serves heights up to 0.6 µm.
        samples: Phases in the table.
    """

    kind: Literal["profile"]
    profile: Profile
    max_order: Annotated[int, Field(ge=1, le=256)] = 16
    max_phase: Positive = 20.0
    samples: Annotated[int, Field(ge=8, le=8192)] = 512

    @field_validator("profile", mode="before")
    @classmethod
    def _name_is_kind(cls, value: Any) -> Any:
        return {"kind": value} if isinstance(value, str) else value


class LobesRecipe(_Recipe):
    """The colours of lobes under one illuminant.

    Attributes:
        illuminant: Name, or path of a CSV beside the recipe.
        observer: Whose colour-matching functions.
        wavenumbers: Texels along the lobe's wavenumber.
        widths: Texels along the lobe's width.
    """

    kind: Literal["lobes"]
    illuminant: str = "D65"
    observer: Observer = "1931-2"
    wavenumbers: Annotated[int, Field(ge=8, le=4096)] = 192
    widths: Annotated[int, Field(ge=4, le=256)] = 12


class MetalsRecipe(_Recipe):
    """The reflectances of all metals in one table."""

    kind: Literal["metals"]
    wavenumbers: Annotated[int, Field(ge=8, le=4096)] = 128


class PolygonsFoilRecipe(_Recipe):
    """A repeating tile of polygons, each a grating of its own orientation.

    Attributes:
        size: Texels along each side of the tile.
        tile_mm: Its side, mm.
        polygons: How many.
        orientations: How many different ones, at equal steps over 180°.
        periods: Their gratings' periods, µm, taken in turn.
        height: Of all gratings, µm.
        profile: Name of a baked profile.
        border: Width of the undiffracting seam between polygons, as a share of the tile's side.
        seed: Of the random arrangement.
    """

    kind: Literal["foil"]
    design: Literal["polygons"]
    size: Annotated[int, Field(ge=16, le=4096)] = 256
    tile_mm: Positive = 25.0
    polygons: Annotated[int, Field(ge=2, le=4096)] = 48
    orientations: Annotated[int, Field(ge=1, le=256)] = 12
    periods: Annotated[tuple[Positive, ...], Field(min_length=1)] = (1.66,)
    height: Positive = 0.15
    profile: str = "sinusoidal"
    border: Annotated[float, Field(ge=0, lt=0.1)] = 0.004
    seed: int = 1


Recipe: TypeAlias = Annotated[
    ProfileRecipe | LobesRecipe | MetalsRecipe | PolygonsFoilRecipe, Field(discriminator="kind")
]

_RECIPE: TypeAdapter[Recipe] = TypeAdapter(Recipe)


def read_recipe(file: Path) -> Recipe:
    """Read a recipe.

    Raises:
        InputError: The file is missing, is no JSON, or a field is unknown, missing or out of range.
    """
    return validated(file, _RECIPE)


def validated(file: Path, adapter: TypeAdapter[Any]) -> Any:
    """A JSON file's contents as the type of `adapter`, with `InputError` for whatever is wrong."""
    try:
        contents = json.loads(file.read_text("utf-8"))
    except (OSError, ValueError) as failure:
        raise unreadable(file, failure) from failure
    try:
        return adapter.validate_python(contents)
    except ValidationError as failure:
        raise first_failure(file, failure) from failure
