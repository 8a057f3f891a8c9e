"""Files of photographs, as linear light: EXR, TIFF, PNG, JPEG and camera raw.

Pixels are where the file has them: what a file notes of how the camera was held is not applied.
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import Any

import colour
import cv2
import numpy as np
import tifffile
from cv2.utils import logging
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError
from tifffile import PHOTOMETRIC, PLANARCONFIG, TiffPage

from precompute.acquisition.camera_raw import FULL, read_raw
from precompute.acquisition.capture import Camera
from precompute.acquisition.exif import (
    EXIF_IFD,
    EXPOSURE_TIME,
    TIFF_FAILURES,
    Notes,
    notes_of_exif,
    notes_of_raw,
    notes_of_tiff,
)
from precompute.errors import InputError, unreadable
from precompute.files import written_aside
from precompute.images import read_exr, write_exr

COUNTS = {"rgb": 3, "grey": 1}
INTEGERS = (np.uint8, np.uint16)
WRITTEN = (".tif", ".tiff", ".png", ".exr")


@dataclass(frozen=True)
class ImageFile:
    """An image as its file holds it, and how its numbers become light.

    Attributes:
        file: Where it was read.
        kind: Its format and type, for reports.
        numbers: Shape (height, width, channels), channels 1 or R, G, B; uint8, uint16 or float32.
        black: Number of no light, for each channel, shape (channels,).
        white: Number of full scale; None where there is none, and numbers are light as they are.
        srgb: Whether numbers follow the sRGB curve.
        step: Smallest step of light that the numbers tell from none, of full scale; 0 for floats.
        exposure_s: As the file notes it.
        focal_px: Focal length that follows from what the file notes.
    """

    file: Path
    kind: str
    numbers: NDArray[Any]
    black: NDArray[np.float64]
    white: float | None
    srgb: bool
    step: float
    exposure_s: float | None
    focal_px: float | None

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        return self.numbers.shape[1], self.numbers.shape[0]

    def linear(self, rows: slice = slice(None)) -> NDArray[np.float32]:
        """Light of some rows, shares of full scale: 0 at black, 1 at white.

        What noise puts below black stays below 0. Where there is no white, nothing is scaled or cut
        off.

        Returns:
            Shape (rows, width, channels).
        """
        numbers = self.numbers[rows]
        if self.srgb:
            return self._srgb[numbers]
        light = numbers.astype(np.float32)
        if self.black.any():
            light -= self.black.astype(np.float32)
        if self.white is not None:
            light *= (1 / (self.white - self.black)).astype(np.float32)
            np.minimum(light, 1, out=light)
        return light

    @cached_property
    def _srgb(self) -> NDArray[np.float32]:
        """Light of every number of the integer type, by the sRGB curve (IEC 61966-2-1)."""
        assert self.white is not None
        numbers = np.arange(np.iinfo(self.numbers.dtype).max + 1)
        coded = np.minimum((numbers - self.black[0]) / (self.white - self.black[0]), 1)
        return colour.models.eotf_sRGB(coded).astype(np.float32)


def _read_exr(file: Path) -> tuple[str, NDArray[Any], Notes]:
    return "EXR", read_exr(file), Notes()


def _read_jpeg(file: Path) -> tuple[str, NDArray[Any], Notes]:
    try:
        with Image.open(file, formats=["JPEG"]) as image:
            numbers, mode, exif = np.asarray(image), image.mode, image.getexif()
    except (UnidentifiedImageError, Image.DecompressionBombError, OSError) as failure:
        raise unreadable(file, failure) from failure
    if mode not in ("L", "RGB"):
        raise InputError(file, "colours", mode, "RGB or grey")
    return "8-bit JPEG", numbers, notes_of_exif(exif)


def _read_png(file: Path) -> tuple[str, NDArray[Any], Notes]:
    try:
        with Image.open(file, formats=["PNG"]) as image:
            mode = image.mode
    except (UnidentifiedImageError, Image.DecompressionBombError, OSError) as failure:
        raise unreadable(file, failure) from failure
    if mode not in ("1", "L", "I;16", "RGB"):
        raise InputError(file, "colours", mode, "RGB or grey, no palette, no alpha")
    numbers, exif = _decoded(file)
    return f"{8 * numbers.itemsize}-bit PNG", numbers, notes_of_exif(exif)


def _read_tiff(file: Path) -> tuple[str, NDArray[Any], Notes]:
    try:
        with tifffile.TiffFile(file) as tiff:
            page = tiff.pages.first
            # Small copies of the picture are marked as such.
            pictures = [p for p in tiff.pages if isinstance(p, TiffPage) and not p.is_reduced]
            notes = notes_of_tiff(page)
    except TIFF_FAILURES as failure:
        raise unreadable(file, failure) from failure
    if len(pictures) != 1:
        raise InputError(file, "pages", len(pictures), "one picture")
    if page.dtype not in (np.uint8, np.uint16, np.float32) or page.bitspersample % 8:
        found = f"{page.bitspersample} bits, {page.dtype}"
        raise InputError(file, "type", found, "8 or 16 bits, unsigned, or 32 bits, float")
    if page.photometric not in (PHOTOMETRIC.RGB, PHOTOMETRIC.MINISBLACK):
        found = int(page.photometric)
        expected = f"{PHOTOMETRIC.RGB:d} (RGB) or {PHOTOMETRIC.MINISBLACK:d} (grey, 0 is black)"
        raise InputError(file, "PhotometricInterpretation", found, expected)
    if page.samplesperpixel > 1 and page.planarconfig != PLANARCONFIG.CONTIG:
        found = int(page.planarconfig)
        expected = f"{PLANARCONFIG.CONTIG:d} (channels beside each other)"
        raise InputError(file, "PlanarConfiguration", found, expected)
    numbers, _ = _decoded(file)
    kind = "float" if numbers.dtype == np.float32 else f"{8 * numbers.itemsize}-bit"
    return f"{kind} TIFF", numbers, notes


def _decoded(file: Path) -> tuple[NDArray[Any], Image.Exif]:
    """Numbers by OpenCV, R first, and the Exif block that it finds in a PNG."""
    # It tells of every tag that it does not know; failures come as None or as an error.
    level = logging.setLogLevel(logging.LOG_LEVEL_SILENT)
    try:
        numbers, kinds, blocks = cv2.imreadWithMetadata(str(file), cv2.IMREAD_UNCHANGED)
    except cv2.error as failure:
        raise unreadable(file, failure) from failure
    finally:
        logging.setLogLevel(level)
    if numbers is None:
        raise unreadable(file, "cannot be decoded")
    exif = Image.Exif()
    for kind, block in zip(kinds, blocks, strict=True):
        if kind == cv2.IMAGE_METADATA_EXIF:
            exif.load(np.asarray(block).tobytes())
    # OpenCV has B first; a view with the order turned costs nothing.
    return numbers[..., ::-1] if numbers.ndim == 3 and numbers.shape[-1] == 3 else numbers, exif


READERS = {
    ".exr": _read_exr,
    ".tif": _read_tiff,
    ".tiff": _read_tiff,
    ".png": _read_png,
    ".jpg": _read_jpeg,
    ".jpeg": _read_jpeg,
}


def read_image(file: Path, camera: Camera) -> ImageFile:
    """Read one file of a photograph.

    Args:
        file: EXR, TIFF, PNG or JPEG by its extension; any other is taken for camera raw.
        camera: Channels, response, black and white. Floats have no white unless it is given. Camera
            raw brings its own levels.

    Raises:
        InputError: The file is missing, damaged, of another kind or smaller than 16 × 16 pixels;
            its channels are not those of the camera; the camera's response or levels make no sense
            for its kind; it holds numbers that are not finite; nine tenths of it are below black;
            or floats are as far below black as half of the brightest above.
    """
    if not file.is_file():
        raise unreadable(file, "no such file")
    reader = READERS.get(file.suffix.lower())
    if reader is None:
        raw = read_raw(file)
        kind, numbers, notes = "camera raw", raw.numbers, notes_of_raw(file)
        # LibRaw knows where more cameras note it.
        notes = Notes(raw.exposure_s or notes.exposure_s, notes.focal_35mm)
        for field, value in (("black", camera.black or None), ("white", camera.white)):
            if value is not None:
                expected = "none: camera raw has its own black and white"
                raise InputError(file, f"camera.{field}", value, expected)
        if camera.response == "srgb":
            raise InputError(file, "camera.response", "srgb", "linear: camera raw")
        black, white, step = raw.black, float(FULL), raw.step
    else:
        kind, numbers, notes = reader(file)
        if numbers.ndim == 2:
            numbers = numbers[..., None]
        _check_levels(file, kind, numbers.dtype, camera)
        black, white, step = np.full(numbers.shape[-1], camera.black), camera.white, 0.0
        if numbers.dtype in INTEGERS:
            white = float(np.iinfo(numbers.dtype).max) if white is None else white
            step = 1 / (white - camera.black)
    height, width, channels = numbers.shape
    if channels != COUNTS[camera.channels]:
        expected = f"{COUNTS[camera.channels]}: camera.channels is {camera.channels}"
        raise InputError(file, "channels", channels, expected)
    if min(width, height) < 16:
        raise InputError(file, "size", f"{width} × {height}", "16 × 16 pixels or more")
    odd = numbers.size - np.count_nonzero(np.isfinite(numbers))
    if odd:
        raise InputError(file, "numbers", f"{odd} not finite", "all finite")
    image = ImageFile(
        file,
        kind,
        numbers,
        black,
        white,
        srgb=camera.response == "srgb",
        # The sRGB curve starts with a slope of 1 / 12.92.
        step=step / 12.92 if camera.response == "srgb" else step,
        exposure_s=notes.exposure_s,
        focal_px=notes.focal_px(width, height),
    )
    below = np.count_nonzero(numbers[::4, ::4] < black) / numbers[::4, ::4].size
    if below > 0.9:
        found = f"{float(black.max()):g}, above {100 * below:.0f} % of the numbers"
        raise InputError(file, "camera.black", found, "the number of no light")
    if numbers.dtype not in INTEGERS:
        lowest, highest = float(numbers.min()) - camera.black, float(numbers.max()) - camera.black
        if lowest < -0.5 * highest:
            found = f"{lowest:.3g} to {highest:.3g} over black"
            raise InputError(file, "numbers", found, "light of 0 and more, but for noise")
    return image


def _check_levels(file: Path, kind: str, dtype: np.dtype[Any], camera: Camera) -> None:
    """Refuse a response and levels that the kind of file cannot have."""
    if camera.response == "srgb" and dtype not in INTEGERS:
        raise InputError(file, "camera.response", "srgb", f"linear: {kind}")
    if "JPEG" in kind and "response" not in camera.model_fields_set:
        raise InputError(file, "camera.response", None, "srgb or linear, said so, for a JPEG")
    if dtype in INTEGERS:
        largest = np.iinfo(dtype).max
        for field, value in (("camera.black", camera.black), ("camera.white", camera.white)):
            if value is not None and not 0 <= value <= largest:
                raise InputError(file, field, value, f"0 to {largest}: {kind}")
        if camera.black == largest:
            raise InputError(file, "camera.black", camera.black, f"below {largest}: {kind}")


def write_image(file: Path, numbers: NDArray[Any], exposure_s: float | None = None) -> None:
    """Write an image without loss.

    Args:
        file: TIFF, PNG or EXR, by its extension.
        numbers: Shape (height, width, 1 or 3); uint8 or uint16, for EXR float32.
        exposure_s: Noted in the file, to a millionth; EXR has no place for it.

    Raises:
        InputError: The extension is none of these.
    """
    suffix = file.suffix.lower()
    if suffix not in WRITTEN:
        raise InputError(file, "extension", suffix, "one of " + ", ".join(WRITTEN))
    if suffix == ".exr":
        write_exr(file, numbers)
        return
    exposure = None
    if exposure_s is not None:
        exposure = Fraction(exposure_s).limit_denominator(1_000_000)
    data = _png(numbers, exposure) if suffix == ".png" else _tiff(numbers, exposure)
    with written_aside(file) as aside:
        aside.write_bytes(data)


def _png(numbers: NDArray[Any], exposure: Fraction | None) -> bytes:
    ordered = np.ascontiguousarray(numbers[..., ::-1])
    if exposure is None:
        _, data = cv2.imencode(".png", ordered)
    else:
        exif = Image.Exif()
        exif.get_ifd(EXIF_IFD)[EXPOSURE_TIME] = (exposure.numerator, exposure.denominator)
        # Without the "Exif\0\0" that only JPEG has before it.
        block = np.frombuffer(exif.tobytes()[6:], np.uint8)
        _, data = cv2.imencodeWithMetadata(".png", ordered, [cv2.IMAGE_METADATA_EXIF], [block])
    return data.tobytes()


def _tiff(numbers: NDArray[Any], exposure: Fraction | None) -> bytes:
    tags = []
    if exposure is not None:
        tags = [(EXPOSURE_TIME, "2I", 1, (exposure.numerator, exposure.denominator), True)]
    buffer = io.BytesIO()
    colours = "rgb" if numbers.shape[-1] == 3 else "minisblack"
    pixels = numbers if numbers.shape[-1] == 3 else numbers[..., 0]
    tifffile.imwrite(buffer, pixels, photometric=colours, extratags=tags, metadata=None)
    return buffer.getvalue()
