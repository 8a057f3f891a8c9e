"""Frame times of a scene's methods, as ratios within each launch of the browser."""

from __future__ import annotations

from dataclasses import dataclass, field
from statistics import median
from typing import Any

from precompute.report.scenes import Scene

FRAMES = 15
"""Frames of each material in a launch, of a slow one fewer, of which the shortest counts."""

LAUNCHES = 3

STANDARD = "MeshStandardMaterial"
IRIDESCENT = "MeshPhysicalMaterial with iridescence"
WITHOUT = "diffraction: false"


def timing_request(scene: Scene) -> dict[str, Any]:
    """The scene under three's own materials, without diffraction, and by each of its methods."""
    materials: list[dict[str, Any]] = [
        {"name": STANDARD, "kind": "standard"},
        {"name": IRIDESCENT, "kind": "iridescent"},
        {"name": WITHOUT, "kind": "diffraction", "material": {"diffraction": False}},
    ]
    for index, method in enumerate(scene.methods):
        material = scene.drawn_by(method)["material"]
        materials.append({"name": str(index), "kind": "diffraction", "material": material})
    description = scene.description | {"size": scene.timing_size}
    return {"scene": description, "materials": materials, "frames": FRAMES}


@dataclass
class Times:
    """Shortest frames of one scene, ms, by material, one entry a launch."""

    launches: list[dict[str, float]] = field(default_factory=list)

    def ratios(self, material: str, over: str = STANDARD, beyond: str | None = None) -> list[float]:
        """Ratios of frame times, one a launch.

        Args:
            material: Name of the material, for a method its index.
            over: The material to divide by.
            beyond: What to subtract from both first: the ratio is of the time added to it.
        """
        return [
            (times[material] - (times[beyond] if beyond else 0))
            / (times[over] - (times[beyond] if beyond else 0))
            for times in self.launches
        ]

    def ratio(self, material: str, over: str = STANDARD, beyond: str | None = None) -> float:
        """The median of `ratios`."""
        return median(self.ratios(material, over, beyond))
