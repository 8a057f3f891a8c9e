"""Image files: 8-bit PNG by Pillow, half and float EXR by OpenEXR.

Arrays are (height, width, channels).
"""

from __future__ import annotations

import io
import math
import struct
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
from numpy.typing import NDArray
from PIL import Image

from precompute.errors import InputError, unreadable
from precompute.files import written_aside

MODES = {1: "L", 2: "LA", 3: "RGB", 4: "RGBA"}
PNG_BIT_DEPTH = 24
"""Offset of the bit depth in a PNG: 8 bytes of signature, 8 of the header chunk's length and name,
8 of width and height."""
PNG_FAILURES = (OSError, ValueError, SyntaxError, struct.error, Image.DecompressionBombError)
MAX_DEFLATE_RATIO = 1032  # of bytes out to bytes in: 258 bytes for 2 bits
EXR_CHANNELS = {1: "Y", 3: "RGB", 4: "RGBA"}


def encode_png(texels: NDArray[np.uint8]) -> bytes:
    """PNG of 8-bit texels, shape (height, width, 1 to 4)."""
    buffer = io.BytesIO()
    channels = texels.shape[-1]
    image = Image.fromarray(texels[..., 0] if channels == 1 else texels, MODES[channels])
    image.save(buffer, "PNG", optimize=True)
    return buffer.getvalue()


def decode_png(file: Path, data: bytes, shape: tuple[int, ...]) -> NDArray[np.uint8]:
    """Texels of an 8-bit RGBA PNG.

    Args:
        file: The file's name, for errors.
        data: Its contents.
        shape: Rows, columns and channels that it must have: (height, width, 4).

    Returns:
        That shape.

    Raises:
        InputError: Not a PNG, of another size, or with other channels or bits than 8-bit RGBA.
    """
    try:
        image = Image.open(io.BytesIO(data), formats=["PNG"])
    except PNG_FAILURES as failure:
        raise unreadable(file, failure) from failure
    if image.mode != "RGBA":
        raise InputError(file, "channels", image.mode, "RGBA, 8 bit")
    if data[PNG_BIT_DEPTH] != 8:  # Pillow would cut 16 bits down to 8
        raise InputError(file, "bits", data[PNG_BIT_DEPTH], "RGBA, 8 bit")
    found = (image.height, image.width, 4)
    if found != shape:
        raise InputError(file, "shape", found, f"{shape}")
    if math.prod(shape) > MAX_DEFLATE_RATIO * len(data):
        raise InputError(file, "size", len(data), "bytes enough for its texels")
    try:
        image.load()
    except PNG_FAILURES as failure:
        raise unreadable(file, failure) from failure
    return np.asarray(image)


def read_exr(file: Path) -> NDArray[np.float32]:
    """A half or float EXR as float32, in the file's unit, shape (height, width, channels).

    Channels come in the order R, G, B, A where there are such, else by name.

    Raises:
        InputError: The file is missing or no EXR.

    >>> import tempfile
    >>> file = Path(tempfile.mkdtemp()) / "x.exr"
    >>> write_exr(file, np.full((2, 3, 3), 0.5, np.float16))
    >>> read_exr(file).shape
    (2, 3, 3)
    """
    if not file.is_file():
        raise unreadable(file, "no such file")
    try:
        with OpenEXR.File(str(file), separate_channels=True) as exr:
            channels = {name: np.array(c.pixels) for name, c in exr.channels().items()}
    except (RuntimeError, ValueError, OSError) as failure:
        raise unreadable(file, failure) from failure
    if not channels:
        raise unreadable(file, "no channels")
    order = sorted(channels, key=lambda name: ("RGBA".find(name) % 8, name))
    return np.stack([channels[name] for name in order], axis=-1).astype(np.float32)


def write_exr(file: Path, pixels: NDArray[Any]) -> None:
    """Write an EXR: half for float16 arrays, else float. Shape (height, width, 1, 3 or 4).

    Args:
        file: Where.
        pixels: Numbers of any unit.
    """
    stored = pixels if pixels.dtype == np.float16 else pixels.astype(np.float32)
    names = EXR_CHANNELS[pixels.shape[-1]]
    channels = {name: np.ascontiguousarray(stored[..., i]) for i, name in enumerate(names)}
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with written_aside(file) as aside, OpenEXR.File(header, channels) as exr:
        exr.write(str(aside))
