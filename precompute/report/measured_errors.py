"""The table from which a material chooses its method for an error: what the report has measured.

`DiffractionMaterial` reads it as web/materials/measured-errors.json. Scenes fall into classes by
their surface, and into those under lights alone and those in an environment. In each class a
setting has the worst error and the longest frame of all the class's scenes.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from precompute.report.rows import Ratio, Row, Share
from precompute.report.scenes import Knobs, Method, Scene

Part = Literal["lights", "environment"]

KNOBS: dict[Part, str] = {"lights": "wavelength_step", "environment": "environment_nodes"}
"""The knob that each part of a scene's light is drawn with."""


class _Entry(BaseModel):
    model_config = ConfigDict(extra="forbid")


class Setting(_Entry):
    """One way to draw the scenes of a class.

    Attributes:
        options: Options of the material, its defaults where missing.
        rel_rmse: The worst relative RMSE of the class's scenes.
        time_ratio: The longest frame over MeshStandardMaterial's, of those that were timed.
    """

    options: dict[str, str | int | float]
    rel_rmse: Share
    time_ratio: Ratio


class Measured(_Entry):
    """The settings that all scenes of a class were measured with.

    Attributes:
        scenes: How many there are.
        settings: In the order of their times.
    """

    scenes: Annotated[int, Field(ge=1)]
    settings: list[Setting]


class MeasuredErrors(_Entry):
    """measured-errors.json: by class of surface, then by what lights it."""

    generated_by: Literal["npm run report"] = "npm run report"
    classes: dict[str, dict[Part, Measured]]

    def to_json(self) -> str:
        """The file's text."""
        return self.model_dump_json(indent=2, exclude_none=True) + "\n"


def surface_class(scene: Scene) -> str:
    """The class of a scene's surface, as the material's surfaces name it (`measuredAs`)."""
    is_rough = scene.description.get("material", {}).get("roughness", 0) > 0
    if scene.surface == "foil":
        return "foil"
    if scene.surface == "grating":
        return "rough grating" if is_rough else "grating"
    if "tiles" in scene.description["surface"]:
        return "repeated height field"
    return "rough height field" if is_rough else "sharp height field"


def measured_errors(rows: Iterable[Row], scenes: Iterable[Scene]) -> MeasuredErrors:
    """Derive the table from the report's rows.

    Args:
        rows: Of report.json.
        scenes: What they are rows of.
    """
    known = {scene.name: scene for scene in scenes}
    rows = list(rows)
    # The table of a flat surface is for some meshes only: what is drawn without it too counts so.
    any_mesh = {(row.scene, row.method) for row in rows if not row.knobs.get("planar", True)}
    groups: dict[tuple[str, Part], list[Row]] = defaultdict(list)
    for row in rows:
        if "planar" not in row.knobs and (row.scene, row.method) in any_mesh:
            continue
        part: Part = "lights" if row.lighting in ("directional", "point") else "environment"
        if row.lighting == "mixed" and "environment" not in known[row.scene].description:
            part = "lights"
        groups[surface_class(known[row.scene]), part].append(row)
    classes: dict[str, dict[Part, Measured]] = defaultdict(dict)
    for (name, part), members in sorted(groups.items()):
        classes[name][part] = _measured(members, part)
    return MeasuredErrors(classes=dict(classes))


def _measured(rows: list[Row], part: Part) -> Measured:
    scenes = sorted({row.scene for row in rows})
    settings = []
    for method, knob in sorted({_key(row, part) for row in rows}, key=str):
        own = [row for row in rows if _key(row, part) == (method, knob)]
        errors = [_error(rows, part, scene, method, knob) for scene in scenes]
        measured = [error for error in errors if error is not None]
        if len(measured) < len(scenes):
            continue
        settings.append(
            Setting(
                options=_options(rows[0], part, method, knob),
                rel_rmse=_rounded(max(measured)),
                time_ratio=_rounded(max(row.time_ratio for row in own)),
            )
        )
    settings.sort(key=lambda setting: setting.time_ratio)
    return Measured(scenes=len(scenes), settings=settings)


def _key(row: Row, part: Part) -> tuple[str, float | None]:
    """Method and knob: what a row's error depends on."""
    # A height field's environment is drawn in the same way whatever the method.
    any_method = row.surface == "height_field" and part == "environment"
    return "" if any_method else row.method, row.knobs.get(KNOBS[part])


def _error(
    rows: list[Row], part: Part, scene: str, method: str, knob: float | None
) -> float | None:
    """A setting's error in a scene; that of a coarser knob of the same method bounds it."""
    errors = {
        other: row.rel_rmse
        for row in rows
        if row.scene == scene
        for name, other in [_key(row, part)]
        if name == method
    }
    if knob in errors or knob is None:
        return errors.get(knob)
    coarser = [
        error
        for other, error in errors.items()
        if other is not None and (other > knob if part == "lights" else other < knob)
    ]
    return min(coarser, default=None)


def _options(row: Row, part: Part, method: str, knob: float | None) -> dict[str, Any]:
    knobs = Knobs.model_validate({} if knob is None else {KNOBS[part]: knob})
    # A method that does not matter is left to the material: that of the row stands for any.
    made = Method.model_validate({"method": method or row.method, "knobs": knobs})
    options = made.material(row.surface)
    return options if method else {name: options[name] for name in options if name != "method"}


def _rounded(value: float) -> float:
    """To four digits: more would only be noise."""
    return float(f"{value:.4g}")
