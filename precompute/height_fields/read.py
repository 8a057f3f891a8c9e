"""Height fields from files: pictures, numbers, and what instruments write.

Whatever the format, the file's first row is the top of the picture, so that rows are turned over.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from PIL.TiffImagePlugin import BITSPERSAMPLE, PHOTOMETRIC_INTERPRETATION, TiffImageFile

from precompute.errors import InputError, unreadable
from precompute.height_fields.field import HeightField
from precompute.images import PNG_BIT_DEPTH, read_exr

Array = NDArray[np.float64]

PICTURES = (".png", ".bmp", ".tif", ".tiff")
NUMBERS = (".exr", ".npy", ".csv")
INSTRUMENTS = {
    ".nid": "ezd",
    ".gwy": "gwy",
    ".ibw": "ibw",
    ".spm": "di",
    ".001": "di",
    ".002": "di",
    ".003": "di",
    ".jpk": "jpk",
    ".mi": "mi",
    ".mdt": "mdt",
    ".stp": "wsxm",
    ".top": "wsxm",
    ".sur": "sur",
    ".x3p": "x3p",
    ".opd": "opd",
    ".plu": "plu",
    ".sdf": "sdf",
}
"""Suffixes of instruments' files and the names that SurfaceTopography has for the formats. A format
is never guessed from the contents: a damaged file could pass for another."""


def read_height_field(
    file: Path,
    pitch_um: tuple[float, float] | None = None,
    height_um: float | None = None,
    channel: str | None = None,
) -> HeightField:
    """Read a patch; the suffix decides on the format.

    Args:
        file: A PNG, BMP or TIFF of grey (8 or 16 bit, palettes and colours of equal channels
            included), an EXR, NPY or CSV of numbers, or an instrument's file (`INSTRUMENTS`).
        pitch_um: Distance between samples along x and y, µm.
        height_um: Height of full white over black, or of the number 1 where the file holds
            numbers, µm. Both are needed unless the file has a scale of its own, as instruments'
            files do; then neither is taken.
        channel: Which channel of an instrument's file; by default the first that holds heights.

    Returns:
        The field, in µm, as the file has it: neither levelled nor checked for its pitch.

    Raises:
        InputError: The file is missing, damaged, of another format, of colours or with bits that
            would be lost; its scale is missing or given twice; there is no such channel; or its
            heights are constant, NaN or infinite.
    """
    suffix = file.suffix.lower()
    known = (*PICTURES, *NUMBERS, *INSTRUMENTS)
    if suffix not in known:
        raise InputError(file, "suffix", file.suffix, f"one of {', '.join(known)}")
    if not file.is_file():
        raise unreadable(file, "no such file")
    scale = {"pitch_um": pitch_um, "height_um": height_um}
    if suffix in INSTRUMENTS:
        given = [name for name, value in scale.items() if value is not None]
        if given:
            expected = "none: the file has a scale of its own"
            raise InputError(file, ", ".join(given), [scale[name] for name in given], expected)
        heights, pitch = _instrument(file, INSTRUMENTS[suffix], channel)
        return _checked(file, HeightField(heights[::-1], pitch))
    if channel is not None:
        raise InputError(file, "channel", channel, "none: only instruments' files have channels")
    if pitch_um is None or height_um is None:
        missing = ", ".join(name for name, value in scale.items() if value is None)
        expected = (
            "a number, since the file has no scale: pitch_um, the distance between samples, and "
            "height_um, the height of white over black or of the number 1, both in um"
        )
        raise InputError(file, missing, None, expected)
    with _failures_as_unreadable(file):
        numbers = _picture(file) if suffix in PICTURES else _numbers(file, suffix)
    return _checked(file, HeightField(numbers[::-1] * height_um, pitch_um))


@contextmanager
def _failures_as_unreadable(file: Path) -> Iterator[None]:
    # A parser raises whatever a damaged file leads it to: KeyError, struct.error, MemoryError, …
    # What it only warns of is either refused here later or does no harm.
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    except InputError:
        raise
    except Exception as failure:
        raise unreadable(file, f"{type(failure).__name__}: {failure}") from failure


def _checked(file: Path, field: HeightField) -> HeightField:
    heights = field.heights
    if heights.ndim != 2 or min(heights.shape) < 2:
        raise InputError(file, "shape", heights.shape, "two or more rows and columns")
    bad = int(np.count_nonzero(~np.isfinite(heights)))
    if bad:
        raise InputError(file, "heights", f"{bad} NaN or infinite", "finite numbers")
    if heights.min() == heights.max():
        raise InputError(file, "heights", f"all {heights[0, 0]:g} um", "heights that differ")
    return field


def _picture(file: Path) -> Array:
    """Grey as a share of white; a TIFF of floating-point numbers as they are."""
    with Image.open(file, formats=["PNG", "BMP", "TIFF"]) as image:
        image.load()
        frames = getattr(image, "n_frames", 1)
        if frames > 1:
            raise InputError(file, "frames", frames, "one picture")
        bits, white_is_zero = 8, False
        if isinstance(image, TiffImageFile):
            bits = max(image.tag_v2.get(BITSPERSAMPLE, (1,)))
            white_is_zero = image.tag_v2.get(PHOTOMETRIC_INTERPRETATION) == 0
        elif image.format == "PNG":
            bits = file.read_bytes()[PNG_BIT_DEPTH]
        if image.mode == "F":
            return np.asarray(image, dtype=np.float64)
        if image.mode.startswith("I;16"):
            share = np.asarray(image, dtype=np.float64) / (2**bits - 1)
            return 1 - share if white_is_zero else share  # of 8 bits Pillow turns it over itself
        if bits > 8:
            # Pillow reads 16 bits of colour or of grey with alpha as 8.
            expected = "8 bits a channel, or 16 bits of grey alone"
            raise InputError(file, "bits", bits, expected)
        if image.mode not in ("1", "L", "LA", "P", "PA", "RGB", "RGBA"):
            raise InputError(file, "mode", image.mode, "grey, a palette, RGB or RGBA")
        rgba = np.asarray(image.convert("RGBA"))
    if np.any(rgba[..., 3] < 255):
        see_through = f"{np.count_nonzero(rgba[..., 3] < 255)} see-through pixels"
        raise InputError(file, "alpha", see_through, "opaque pixels")
    return _grey(file, rgba[..., :3]) / 255


def _grey(file: Path, colours: NDArray[np.uint8 | np.float32]) -> Array:
    """The one channel of colours whose channels are equal, shape (rows, columns)."""
    first = colours[..., :1]
    different = int(np.count_nonzero(np.any((colours != first) & ~np.isnan(colours), axis=-1)))
    if different:
        raise InputError(file, "colour", f"{different} coloured pixels", "equal channels: grey")
    return colours[..., 0].astype(np.float64)


def _numbers(file: Path, suffix: str) -> Array:
    if suffix == ".exr":
        pixels = read_exr(file)
        if pixels.shape[-1] not in (1, 3, 4):
            raise InputError(file, "channels", pixels.shape[-1], "one, RGB or RGBA")
        return _grey(file, pixels[..., :3])
    if suffix == ".csv":
        return np.loadtxt(file, delimiter=",", ndmin=2, encoding="utf-8-sig")
    numbers = np.load(file, allow_pickle=False)
    if numbers.dtype.kind not in "iuf":
        raise InputError(file, "dtype", str(numbers.dtype), "real numbers")
    return numbers.astype(np.float64)


def _instrument(file: Path, format: str, channel: str | None) -> tuple[Array, tuple[float, float]]:
    """Heights, the first row the top, and pitch, µm."""
    # Slow to import, and only needed here.
    from SurfaceTopography.IO import open_topography

    with _failures_as_unreadable(file), open_topography(str(file), format=format) as reader:
        channels = {c.channel_id: c for c in reader.height_channels if c.dim == 2}
        if not channels:
            raise InputError(file, "channels", [c.name for c in reader.channels], "one of heights")
        name = next(iter(channels)) if channel is None else channel
        if name not in channels:
            raise InputError(file, "channel", name, f"one of {', '.join(channels)}")
        if channels[name].physical_sizes is None or channels[name].unit is None:
            raise unreadable(file, f"channel {name!r} has no physical scale")
        # Indices are (x, y) there, y downwards; masked where nothing was measured.
        topography = channels[name].topography().to_unit("µm")
        heights = np.ma.filled(np.ma.asarray(topography.heights(), dtype=np.float64), np.nan).T
        x, y = topography.pixel_size
        return heights, (float(x), float(y))
