"""The recipe of photographs that nobody took: a foil, a camera, lamps, and what is not ideal."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, PositiveInt, TypeAdapter, model_validator

from precompute.acquisition.capture import Camera, Filter, FlashLight
from precompute.gratings import Positive
from precompute.recipes import validated

Length = Annotated[float, Field(ge=0)]
Albedo = Annotated[float, Field(ge=0, le=1)]
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


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Surface(_Part):
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
        haze: Albedo of what the plastic scatters.
        table: Albedo of what the sheet lies on.
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


class SensorNoise(_Part):
    """What the sensor adds to the light, and how it is stored.

    Attributes:
        file: ``tif``, ``png`` or ``exr``.
        bits: Of the numbers in it; an EXR holds floats, which do not clip.
        full_well: Electrons at white, which give shot noise; without it there is none.
        read_noise: Standard deviation of read noise, electrons.
        noise_db: White noise so far below full scale instead of the two.
    """

    file: Literal["tif", "png", "exr"] = "tif"
    bits: Literal[8, 12, 16] = 16
    full_well: Positive | None = None
    read_noise: Length = 0.0
    noise_db: Positive | None = None

    @model_validator(mode="after")
    def _one_noise(self) -> SensorNoise:
        if self.noise_db is not None and self.full_well is not None:
            raise ValueError("full_well or noise_db, not both")
        if self.read_noise > 0 and self.full_well is None:
            raise ValueError("full_well, in whose electrons read_noise is given")
        return self


class Flash(_Part):
    """One photograph, in as many brackets as it has exposures.

    Attributes:
        light: The lamp.
        filter: Before it.
        exposures_s: A white matt sheet at the sample's centre reaches full scale in 1 s.
    """

    light: FlashLight
    filter: Filter | None = None
    exposures_s: Annotated[tuple[Positive, ...], Field(min_length=1)]


class Simulation(_Part):
    """A flash capture to be simulated.

    Attributes:
        foil: Recipe of the foil, beside this one.
        surface: The sheet.
        camera: Where it is, and its lens.
        size_px: Width and height of its pictures.
        photographs: What is photographed.
        sensor: Its noise and files.
        omit: What the capture file does not say.
        step_nm: Of wavelength.
        subpixels: Along each side of a pixel in which gratings differ.
        seed: Of noise, bumps and shifts.
    """

    kind: Literal["flash-capture"]
    foil: str
    surface: Surface
    camera: Camera
    size_px: tuple[PositiveInt, PositiveInt]
    photographs: Annotated[tuple[Flash, ...], Field(min_length=1)]
    sensor: SensorNoise = SensorNoise()
    omit: tuple[Omitted, ...] = ()
    step_nm: Annotated[int, Field(ge=1, le=20)] = 4
    subpixels: Annotated[int, Field(ge=1, le=8)] = 2
    seed: int = 1

    @model_validator(mode="after")
    def _camera_is_known(self) -> Simulation:
        if self.camera.position_mm is None or self.camera.focal_px is None:
            raise ValueError("camera.position_mm and camera.focal_px, to be simulated")
        if self.camera.response != "linear" and self.sensor.file == "exr":
            raise ValueError("a linear response for exr")
        return self

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
