"""The recipe of photographs that nobody took: a foil, a camera, lamps, and what is not ideal."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, TypeAdapter

from precompute.acquisition.capture import Filter, FlashLight
from precompute.acquisition.taking import Albedo, Length, Part, Taking
from precompute.gratings import Positive
from precompute.recipes import validated

Omitted = Literal[
    "camera.position_mm",
    "camera.rotation_deg",
    "camera.focal_px",
    "camera.distortion",
    "camera.spectral_response_csv",
    "photographs.corners_px",
    "sample.tile_mm",
    "sample.reference_tile_px",
]


class Surface(Part):
    """The sheet and how far from ideal it is.

    Attributes:
        size_mm: Width and height.
        coherence_um: σ of the coherence window.
        roughness_deg: Standard deviation of the normal within a point.
        bumps_deg: Standard deviation of the normal from point to point, along each axis.
        bump_mm: How far apart points are whose normals differ, a Gaussian's standard deviation.
        shift_mm: By how much each tile is off its place, in a direction of its own; all are then
            counted from the reference tile, so that others are off by up to twice as much.
        warp_mm: Standard deviation of a smooth displacement of the pattern.
        haze: Albedo, no unit, of what the plastic scatters.
        table: Albedo, no unit, of what the sheet lies on.
    """

    size_mm: tuple[Positive, Positive]
    coherence_um: Positive = 16.25
    roughness_deg: Annotated[float, Field(ge=0, le=10)] = 0.0
    bumps_deg: Annotated[float, Field(ge=0, le=10)] = 0.0
    bump_mm: Positive = 5.0
    shift_mm: Length = 0.0
    warp_mm: Length = 0.0
    haze: Albedo = 0.02
    table: Albedo = 0.3


class Flash(Part):
    """One photograph, in as many brackets as it has exposures.

    Attributes:
        light: The lamp.
        filter: Before it.
        exposures_s: A white matt sheet at the sample's centre reaches full scale in 1 s.
    """

    light: FlashLight
    filter: Filter | None = None
    exposures_s: Annotated[tuple[Positive, ...], Field(min_length=1)]


class Simulation(Taking):
    """A flash capture to be simulated.

    Attributes:
        surface: The sheet.
        photographs: What is photographed.
        omit: What the capture file does not say.
        step_nm: Of wavelength.
    """

    kind: Literal["flash-capture"]
    surface: Surface
    photographs: Annotated[tuple[Flash, ...], Field(min_length=1)]
    omit: tuple[Omitted, ...] = ()
    step_nm: Annotated[int, Field(ge=1, le=20)] = 4

    @property
    def roughness(self) -> float:
        """Standard deviation of the normal within a point, rad."""
        return float(np.radians(self.surface.roughness_deg))


_SIMULATION: TypeAdapter[Simulation] = TypeAdapter(Simulation)


def read_simulation(file: Path) -> Simulation:
    """Read the recipe of a simulated capture.

    Raises:
        InputError: It is missing, no JSON, or a field is unknown, missing or out of range.
    """
    return validated(file, _SIMULATION)
