"""The capture file: what an acquisition is told of its photographs (docs/acquisition.md).

Sample frame: origin at the sample's centre, x right, y up, z out of the sample towards the camera,
in mm. Pixels: (0, 0) is the centre of the top-left pixel, x right, y down.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    TypeAdapter,
    field_validator,
    model_validator,
)

from precompute.errors import InputError
from precompute.files import written_aside
from precompute.recipes import Illuminant, validated

Positive = Annotated[float, Field(gt=0)]
Point = tuple[float, float]
Vector = tuple[float, float, float]


def _quadrilateral(corners: tuple[Point, ...]) -> tuple[Point, ...]:
    points = np.array(corners)
    edges = np.roll(points, -1, axis=0) - points
    following = np.roll(edges, -1, axis=0)
    turns = edges[:, 0] * following[:, 1] - edges[:, 1] * following[:, 0]
    lengths = np.linalg.norm(edges, axis=1)
    # y points down: clockwise corners turn by positive angles. A sine of 0.02 is a degree.
    if not (np.all(lengths > 1) and np.all(turns > 0.02 * lengths * np.roll(lengths, -1))):
        raise ValueError("the corners of a convex quadrilateral, clockwise from the top left")
    return corners


Corners = Annotated[tuple[Point, Point, Point, Point], AfterValidator(_quadrilateral)]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Sample(_Part):
    """The foil that lies flat in the plane z = 0.

    Attributes:
        size_mm: Width and height.
        tile_mm: Width and height of the pattern that repeats; found from the photographs if left
            out.
        reference_tile_px: Corners of one tile in the first photograph, clockwise from the top left.
        stochastic: Whether gratings are scattered at random: then there is no tile, and what is
            sought is their distribution.
    """

    size_mm: tuple[Positive, Positive]
    tile_mm: tuple[Positive, Positive] | None = None
    reference_tile_px: Corners | None = None
    stochastic: bool = False


class Camera(_Part):
    """A pinhole camera with OpenCV's lens distortion, the same for all photographs.

    Attributes:
        position_mm: Of its centre of projection.
        rotation_deg: Turns about its own x, y and z axis, one after the other, from looking along
            −z with the sample's y up. Left out, it looks at the sample's centre.
        focal_px: Focal length.
        principal_point_px: Where the axis meets the picture; its middle if left out.
        distortion: k1, k2, p1, p2, k3 of OpenCV's model, no unit.
        channels: What a pixel holds.
        response: How its numbers grow with light.
        black: Number of no light.
        white: Number at which it clips; the largest that the file's type holds if left out.
        spectral_response_csv: Columns wavelength_um (or wavelength_nm) and r, g, b, or grey.
    """

    position_mm: Vector | None = None
    rotation_deg: Vector | None = None
    focal_px: Positive | None = None
    principal_point_px: Point | None = None
    distortion: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0)
    channels: Literal["rgb", "grey"] = "rgb"
    response: Literal["linear", "srgb"] = "linear"
    black: float = 0.0
    white: float | None = None
    spectral_response_csv: str | None = None

    @field_validator("position_mm")
    @classmethod
    def _in_front(cls, value: Vector | None) -> Vector | None:
        if value is not None and value[2] <= 0:
            raise ValueError("a position in front of the sample, its z above 0")
        return value

    @model_validator(mode="after")
    def _white_above_black(self) -> Camera:
        if self.white is not None and self.white <= self.black:
            raise ValueError(f"white, {self.white:g}, above black, {self.black:g}")
        return self


class FlashLight(_Part):
    """A small lamp.

    Attributes:
        position_mm: Of its middle.
        radius_deg: Standard deviation of the Gaussian source as seen from the sample.
        spectrum: Illuminant by name, or a CSV beside the capture.
    """

    position_mm: Vector
    radius_deg: Annotated[float, Field(gt=0, le=30)] = 0.7
    spectrum: Illuminant = "inverse-A"

    @field_validator("position_mm")
    @classmethod
    def _in_front(cls, value: Vector) -> Vector:
        if value[2] <= 0:
            raise ValueError("a position in front of the sample, its z above 0")
        return value


class Filter(_Part):
    """A spectral filter before the light, a Gaussian over wavelength.

    Attributes:
        peak_um: Wavelength of its largest transmittance, µm.
        fwhm_um: Full width at half of it, µm.
    """

    peak_um: Annotated[float, Field(ge=0.38, le=0.78)]
    fwhm_um: Annotated[float, Field(ge=0.001, le=0.4)]


class Bracket(_Part):
    """One exposure of several."""

    file: str
    exposure_s: Positive


class Photograph(_Part):
    """One photograph, or brackets that are merged into one.

    Attributes:
        file: Its file, beside the capture.
        exposure_s: Its exposure; read from the file, or 1, if left out.
        brackets: Several exposures in place of the two.
        corners_px: The sample's corners, clockwise from its top left; found if left out.
        light: The flash.
        filter: Before the flash.
        polariser_deg: Angle of the analyser from the x axis.
    """

    file: str | None = None
    exposure_s: Positive | None = None
    brackets: Annotated[tuple[Bracket, ...], Field(min_length=1)] | None = None
    corners_px: Corners | None = None
    light: FlashLight | None = None
    filter: Filter | None = None
    polariser_deg: float | None = None

    @model_validator(mode="after")
    def _one_source(self) -> Photograph:
        if (self.file is None) == (self.brackets is None):
            raise ValueError("file or brackets, one of the two")
        if self.brackets is not None and self.exposure_s is not None:
            raise ValueError("the exposure of each bracket, none of the photograph")
        return self

    @property
    def name(self) -> str:
        """What messages call it: its file, or that of its first bracket."""
        if self.brackets is not None:
            return self.brackets[0].file
        assert self.file is not None
        return self.file


class Capture(_Part):
    """What a capture file says.

    Attributes:
        method: How it was photographed.
        sample: What was.
        camera: By what.
        photographs: In which order they were taken does not matter; the first is the one in which
            the reference tile is marked.
    """

    format: Literal["capture"] = "capture"
    version: Literal[1] = 1
    method: Literal["flash", "polarization"]
    sample: Sample
    camera: Camera = Camera()
    photographs: Annotated[tuple[Photograph, ...], Field(min_length=1)]

    @model_validator(mode="after")
    def _photographs_suit_the_method(self) -> Capture:
        needed, other = "light", "polariser_deg"
        if self.method == "polarization":
            needed, other = other, needed
        for index, photograph in enumerate(self.photographs):
            if getattr(photograph, needed) is None:
                raise ValueError(f"photographs.{index}.{needed}, which {self.method} needs")
            if getattr(photograph, other) is not None:
                raise ValueError(f"no photographs.{index}.{other}: the method is {self.method}")
        return self

    def write(self, file: Path) -> None:
        """Write the capture file; what is unknown is left out of it."""
        text = json.dumps(self.model_dump(mode="json", exclude_none=True), indent=1)
        with written_aside(file) as aside:
            aside.write_text(text + "\n", "utf-8")


_CAPTURE: TypeAdapter[Capture] = TypeAdapter(Capture)


def read_capture(file: Path, method: Literal["flash", "polarization"]) -> Capture:
    """Read a capture file.

    Args:
        file: The file.
        method: What it has to be for.

    Raises:
        InputError: It is missing, no JSON, for another method, or a field is unknown, missing or
            out of range.
    """
    capture: Any = validated(file, _CAPTURE)
    if capture.method != method:
        raise InputError(file, "method", capture.method, method)
    return capture
