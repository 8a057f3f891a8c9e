"""Recipes: the JSON files from which maps are baked."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    TypeAdapter,
    ValidationError,
    ValidationInfo,
    field_validator,
)

from precompute.errors import unreadable
from precompute.foils.recipe import AnyFoilRecipe
from precompute.gratings import Grating, Light, Positive
from precompute.height_fields.recipe import HeightFieldRecipe
from precompute.methods import Method
from precompute.profiles import Profile
from precompute.spectra import ILLUMINANTS, Observer
from precompute.validation import first_failure


def _known_illuminant(name: str) -> str:
    if name not in ILLUMINANTS and not name.endswith(".csv"):
        raise ValueError(f"one of {', '.join(ILLUMINANTS)} or a .csv file")
    return name


Illuminant = Annotated[str, AfterValidator(_known_illuminant)]


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
    illuminant: Illuminant = "D65"
    observer: Observer = "1931-2"
    wavenumbers: Annotated[int, Field(ge=8, le=4096)] = 192
    widths: Annotated[int, Field(ge=4, le=256)] = 14


class MetalsRecipe(_Recipe):
    """The reflectances of all metals in one table."""

    kind: Literal["metals"]
    wavenumbers: Annotated[int, Field(ge=8, le=4096)] = 128


class GratingRecipe(Grating, Light):
    """A grating, the light on it and the method that is asked about it; nothing is baked from it.

    Attributes:
        illuminant: Name, or path of a CSV beside the recipe.
        method: Which method answers.
        wavelength_step: Step of the wavelength loop, µm.
        efficiencies: Of the wavelength loop: the profile's table, or the second-order Taylor
            coefficients that the 2018 paper uses, for a sinusoid.
    """

    kind: Literal["grating"]
    illuminant: Illuminant = "D65"
    method: Method = "reference"
    wavelength_step: Annotated[float, Field(ge=0.0001, le=0.05)] = 0.005
    efficiencies: Literal["table", "taylor"] = "table"

    @field_validator("efficiencies")
    @classmethod
    def _taylor_is_sinusoidal(cls, value: str, info: ValidationInfo) -> str:
        profile = info.data.get("profile")
        if value == "taylor" and profile is not None and profile.kind != "sinusoidal":
            raise ValueError(f"table, the profile being {profile.kind}, not sinusoidal")
        return value

    def grating(self) -> Grating:
        """The grating alone."""
        return Grating(**{name: getattr(self, name) for name in Grating.model_fields})

    def light(self, folder: Path) -> Light:
        """The light alone, a CSV illuminant's path being relative to `folder`."""
        stated = self.model_fields_set & set(Light.model_fields)
        fields = {name: getattr(self, name) for name in stated}
        if self.illuminant.endswith(".csv"):
            fields["illuminant"] = str(folder / self.illuminant)
        return Light(**fields)


Recipe: TypeAlias = Annotated[
    ProfileRecipe | LobesRecipe | MetalsRecipe | AnyFoilRecipe | HeightFieldRecipe,
    Field(discriminator="kind"),
]

_RECIPE: TypeAdapter[Recipe] = TypeAdapter(Recipe)
_GRATING_RECIPE = TypeAdapter(GratingRecipe)


def read_recipe(file: Path) -> Recipe:
    """Read a recipe.

    Raises:
        InputError: The file is missing, is no JSON, or a field is unknown, missing or out of range.
    """
    return validated(file, _RECIPE)


def read_grating_recipe(file: Path) -> GratingRecipe:
    """Read the recipe of a grating to be evaluated.

    Raises:
        InputError: As `read_recipe`.
    """
    return validated(file, _GRATING_RECIPE)


def validated(file: Path, adapter: TypeAdapter[Any]) -> Any:
    """A JSON file's contents as the type of `adapter`, with `InputError` for whatever is wrong."""
    try:
        contents = json.loads(file.read_text("utf-8"))
        # Half a surrogate pair cannot be encoded, nor can a path hold it or a NUL.
        if b"\\u0000" in json.dumps(contents, ensure_ascii=False).encode():
            raise ValueError("a NUL character")
    except (OSError, ValueError, RecursionError) as failure:
        raise unreadable(file, failure) from failure
    try:
        return adapter.validate_python(contents)
    except ValidationError as failure:
        raise first_failure(file, failure, contents) from failure
