"""What recipes of photographs that nobody took have in common: a foil, a camera and its sensor."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, PositiveInt, model_validator

from precompute.acquisition.capture import Camera
from precompute.gratings import Positive

Length = Annotated[float, Field(ge=0)]
Albedo = Annotated[float, Field(ge=0, le=1)]


class Part(BaseModel):
    """A part of a recipe, of which an unknown field is an error."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class SensorNoise(Part):
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

    @property
    def signal_to_noise_db(self) -> float | None:
        """At full scale, a ratio in dB; None without noise."""
        if self.full_well is not None:
            return float(10 * np.log10(self.full_well))
        return self.noise_db

    @model_validator(mode="after")
    def _one_noise(self) -> SensorNoise:
        if self.noise_db is not None and self.full_well is not None:
            raise ValueError("full_well or noise_db, not both")
        if self.read_noise > 0 and self.full_well is None:
            raise ValueError("full_well, in whose electrons read_noise is given")
        return self


class Taking(Part):
    """Photographs of a foil.

    Attributes:
        foil: Recipe of the foil, beside this one.
        camera: Where it is, and its lens.
        size_px: Width and height of its pictures.
        sensor: Its noise and files.
        subpixels: Along each side of a pixel in which gratings differ.
        seed: Of all that is at random.
    """

    foil: str
    camera: Camera
    size_px: tuple[PositiveInt, PositiveInt]
    sensor: SensorNoise = SensorNoise()
    subpixels: Annotated[int, Field(ge=1, le=8)] = 2
    seed: Annotated[int, Field(ge=0)] = 1

    @model_validator(mode="after")
    def _camera_is_known(self) -> Self:
        if self.camera.position_mm is None or self.camera.focal_px is None:
            raise ValueError("camera.position_mm and camera.focal_px, to be simulated")
        if self.camera.response != "linear" and self.sensor.file == "exr":
            raise ValueError("a linear response for exr")
        return self
