"""What a scene's shader leaves out by itself, and what each thing left out would cost it.

Each part is forced into the same scene (tests/browser/harness/force.ts), where it adds nothing to
the picture, and drawn beside the scene as it is.
"""

from __future__ import annotations

from dataclasses import dataclass
from statistics import median
from typing import Any

from precompute.report.rows import LeftOut
from precompute.report.scenes import Scene
from precompute.report.shader_cost import StaticCost
from precompute.report.timing import FRAMES, STANDARD

SCENES = (
    "plane-directional",
    "foil-near",
    "environment-studio",
    "height-field-bumps",
)
"""They stand for gratings and foils under a light, environments and height fields."""

PLAIN = "plain"
"""The timed material that leaves out what it can."""


@dataclass(frozen=True)
class Part:
    """Something that a shader can leave out.

    Attributes:
        feature: How its entry in the material's `explain()` begins.
        force: How the harness puts it in.
        of_lights: Whether it is code that a scene without lights has no use for either way.
    """

    feature: str
    force: dict[str, Any]
    of_lights: bool = False


LIGHT = {"kind": "directional", "direction": [0.35, 0, 1], "intensity": 1e-30}
"""Nothing in a sum of floats; what is wholly dark the shader would skip."""

PARTS = (
    Part("lights", {"lights": [LIGHT]}),
    Part("tinted light", {"defines": {"TINTED": ""}}, of_lights=True),
    Part("equirectangular environment", {"environment": {"asset": "studio", "intensity": 0}}),
    Part("lacquer", {"defines": {"COAT": ""}}),
    Part("matt base", {"defines": {"BASE": ""}}),
    Part("normalMap", {"normalMap": True}),
    # All orders that the profile's table has.
    Part("orders beyond", {"defines": {"MAX_ORDER": "TABLE_ORDER"}}),
    Part("wide lobes of all orders", {"defines": {"WIDE_LOBES": ""}}, of_lights=True),
)


@dataclass(frozen=True)
class Drawn:
    """A scene with one part forced in, or as it is.

    Attributes:
        static: Instructions of its shader.
        tables: Bytes of the tables that it reads.
    """

    static: StaticCost
    tables: int

    @property
    def instructions(self) -> int:
        """Of all kinds."""
        return sum(self.static.model_dump().values())


def left_out_parts(
    scene: Scene, explanation: list[dict[str, Any]]
) -> list[tuple[Part, dict[str, Any]]]:
    """The parts that a material says it left out, each with what it says of it.

    Args:
        scene: What it was drawn in.
        explanation: What `explain()` returned for the scene as it is.
    """
    has_lights = bool(scene.description.get("lights"))
    return [
        (part, entry)
        for part in PARTS
        if has_lights or not part.of_lights
        for entry in explanation
        if entry["feature"].startswith(part.feature) and not entry["included"]
    ]


def forced(scene: Scene, part: Part) -> dict[str, Any]:
    """The scene's description by its first method, with a part forced in."""
    return scene.drawn_by(scene.methods[0]) | {"force": part.force}


def timing_request(scene: Scene, parts: list[Part]) -> dict[str, Any]:
    """The scene by its first method as it is and with each of the parts (harness/timing.ts)."""
    plain = {"kind": "diffraction", "material": scene.drawn_by(scene.methods[0])["material"]}
    materials: list[dict[str, Any]] = [
        {"name": STANDARD, "kind": "standard"},
        {"name": PLAIN, **plain},
        *({"name": part.feature, **plain, "force": part.force} for part in parts),
    ]
    description = scene.description | {"size": scene.timing_size}
    return {"scene": description, "materials": materials, "frames": FRAMES}


def left_out_row(
    scene: Scene,
    part: Part,
    entry: dict[str, Any],
    plain: Drawn,
    with_part: Drawn,
    launches: list[dict[str, float]],
) -> LeftOut:
    """What one part would cost a scene.

    Args:
        scene: The scene.
        part: What is left out.
        entry: What the material says of it.
        plain: The scene as it is.
        with_part: The scene with the part.
        launches: Shortest frames by material, ms, of each launch of `timing_request`.
    """
    saved = [(times[part.feature] - times[PLAIN]) / times[STANDARD] for times in launches]
    return LeftOut(
        scene=scene.name,
        feature=entry["feature"],
        why=entry["why"],
        saved_time=median(saved),
        saved_instructions=with_part.instructions - plain.instructions,
        saved_bytes=with_part.tables - plain.tables,
    )
