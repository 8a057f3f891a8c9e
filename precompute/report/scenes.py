"""Scenes with the methods they are compared by, and what the browser is asked to draw for each."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from precompute.errors import InputError, unreadable
from precompute.validation import first_failure

MethodName = Literal[
    "closed-form", "wavelength-loop", "taylor", "jacobi-anger", "line-sum", "baked"
]
SurfaceName = Literal["grating", "foil", "height_field"]
Lighting = Literal["directional", "point", "environment", "mixed"]

METHOD_OPTIONS: dict[str, dict[str, str]] = {
    "closed-form": {"method": "closed-form"},
    "wavelength-loop": {"method": "wavelength-loop", "efficiencies": "table"},
    "taylor": {"method": "wavelength-loop", "efficiencies": "taylor"},
}
"""The material's options that choose a grating's method; a height field's are called as here."""


class Knobs(BaseModel):
    """What a method can be given besides the scene.

    Attributes:
        wavelength_step: Step of the loop over wavelengths, µm.
        environment_nodes: Spectral nodes of an environment.
        planar: Whether a flat mesh may read a table of the environment's light.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    wavelength_step: Annotated[float, Field(gt=0)] | None = None
    environment_nodes: Annotated[int, Field(ge=1)] | None = None
    planar: bool | None = None

    def stated(self) -> dict[str, int | float]:
        """The knobs that are set, by name."""
        return self.model_dump(exclude_none=True)


class Method(BaseModel):
    """One way to draw a scene.

    Attributes:
        method: Its name.
        seed: Whether it is a method of the papers, the baseline.
        knobs: Its settings, the material's defaults where unset.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    method: MethodName
    seed: bool = False
    knobs: Knobs = Knobs()

    @property
    def label(self) -> str:
        """Name and knobs, for people."""
        unit = {"wavelength_step": " µm", "environment_nodes": " nodes"}
        stated = self.knobs.stated()
        knobs = [f"{value:g}{unit[name]}" for name, value in stated.items() if name in unit]
        if self.knobs.planar is not None:
            knobs.append("planar table" if self.knobs.planar else "no planar table")
        return ", ".join([self.method, *knobs])

    def material(self, surface: SurfaceName) -> dict[str, Any]:
        """Options of `DiffractionMaterial` that this method needs on a surface."""
        options: dict[str, Any] = (
            {"method": self.method}
            if surface == "height_field"
            else dict(METHOD_OPTIONS[self.method])
        )
        if self.knobs.wavelength_step is not None:
            options["wavelengthStep"] = self.knobs.wavelength_step
        if self.knobs.environment_nodes is not None:
            options["environmentNodes"] = self.knobs.environment_nodes
        if self.knobs.planar is not None:
            options["planarEnvironment"] = self.knobs.planar
        return options


class Scene(BaseModel):
    """A file of tests/scenes; the fields that only the browser reads are in `description`.

    Attributes:
        name: The file's name without extension.
        description: What the browser harness draws.
        methods: How it is to be drawn; empty for a scene that only browser tests use.
        timing_size: Pixels of the frames that are timed.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str
    description: dict[str, Any]
    methods: tuple[Method, ...]
    timing_size: tuple[int, int]

    @staticmethod
    def read(file: Path) -> Scene:
        """Read a scene.

        Raises:
            InputError: The file cannot be read, or a field of it is wrong.
        """
        try:
            description = json.loads(file.read_text("utf-8"))
        except (OSError, ValueError) as failure:
            raise unreadable(file, failure) from failure
        if "methods" not in description:
            expected = "a list of methods, empty for a scene that is not compared"
            raise InputError(file, "methods", None, expected)
        methods = description.pop("methods")
        timing_size = description.pop("timing_size", description.get("size"))
        try:
            return Scene(
                name=file.stem,
                description=description,
                methods=methods,
                timing_size=timing_size,
            )
        except ValidationError as failure:
            raise first_failure(file, failure) from failure

    @property
    def surface(self) -> SurfaceName:
        """Kind of the surface."""
        kind = self.description["surface"]["kind"]
        return "height_field" if kind == "height-field" else kind

    @property
    def field(self) -> str:
        """Name of the height field that the surface shows."""
        return Path(self.description["surface"]["field"]).name.removeprefix("height-field-")

    @property
    def lighting(self) -> Lighting:
        """The one kind of its lights, or ``mixed``."""
        kinds = {light["kind"] for light in self.description.get("lights", [])}
        if "environment" in self.description:
            kinds.add("environment")
        if kinds == {"directional"}:
            return "directional"
        if kinds == {"point"}:
            return "point"
        return "environment" if kinds == {"environment"} else "mixed"

    def drawn_by(self, method: Method) -> dict[str, Any]:
        """The description with the method's options in its material."""
        material = self.description.get("material", {}) | method.material(self.surface)
        return self.description | {"material": material}

    def picture_name(self, index: int) -> str:
        """Name of the files of the method at `index`."""
        return f"{self.name}.{index}"


def read_scenes(folder: Path, chosen: list[str] | None = None) -> list[Scene]:
    """The scenes of a folder that are compared by at least one method.

    Args:
        folder: tests/scenes.
        chosen: Names of scenes; all without it.

    Raises:
        InputError: A scene cannot be read, or a chosen one does not exist or is not compared.
    """
    files = sorted(folder.glob("*.json"))
    compared = [scene for scene in map(Scene.read, files) if scene.methods]
    names = [scene.name for scene in compared]
    for name in chosen or names:
        if name not in names:
            raise InputError(folder, "scene", name, f"one of {', '.join(names)}")
    return [scene for scene in compared if not chosen or scene.name in chosen]
