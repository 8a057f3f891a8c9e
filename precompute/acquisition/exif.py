"""What cameras note in their files: exposure and focal length.

Tags and units: Exif 2.32 (CIPA DC-008-2019), 4.6.5.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import tifffile
from PIL import Image

EXIF_IFD = 0x8769
EXPOSURE_TIME = 0x829A
FOCAL_LENGTH_35MM = 0xA405

# What tifffile raises where a file is no TIFF or a damaged one.
TIFF_FAILURES = (tifffile.TiffFileError, OSError, ValueError, KeyError, IndexError, struct.error)

# Of the 36 mm × 24 mm frame. The equivalent focal length has the same diagonal angle of view.
DIAGONAL_MM = float(np.hypot(36, 24))


@dataclass(frozen=True)
class Notes:
    """What a file says of how it was taken, None where it does not.

    Attributes:
        exposure_s: Exposure time, s.
        focal_35mm: Focal length of a lens with the same diagonal angle of view on 36 mm × 24 mm.
    """

    exposure_s: float | None = None
    focal_35mm: float | None = None

    def focal_px(self, width: int, height: int) -> float | None:
        """Focal length in pixels of a picture that was not cropped, `width` × `height` pixels."""
        if self.focal_35mm is None:
            return None
        return self.focal_35mm / DIAGONAL_MM * float(np.hypot(width, height))


def _number(value: Any) -> float | None:
    """A tag's value, a number or a pair numerator, denominator; None where it says "unknown", 0."""
    try:
        number = value[0] / value[1] if isinstance(value, tuple) else float(value)
    except (TypeError, ValueError, ZeroDivisionError, IndexError):
        return None
    return number if np.isfinite(number) and number > 0 else None


def _notes(tags: Mapping[int, Any]) -> Notes:
    return Notes(_number(tags.get(EXPOSURE_TIME)), _number(tags.get(FOCAL_LENGTH_35MM)))


def notes_of_exif(exif: Image.Exif) -> Notes:
    """Notes of an Exif block."""
    return _notes({**exif, **exif.get_ifd(EXIF_IFD)})


def notes_of_tiff(page: tifffile.TiffPage) -> Notes:
    """Notes of a TIFF's page, in its own tags (TIFF/EP) or in its Exif directory."""
    tags = {tag.code: tag.value for tag in page.tags}
    directory = tags.get(EXIF_IFD)
    if isinstance(directory, dict):
        # tifffile names the tags of this directory.
        named = {"ExposureTime": EXPOSURE_TIME, "FocalLengthIn35mmFilm": FOCAL_LENGTH_35MM}
        tags |= {named[name]: value for name, value in directory.items() if name in named}
    return _notes(tags)


def notes_of_raw(file: Path) -> Notes:
    """Notes of a camera raw file where its format is built on TIFF (DNG, NEF, CR2, ARW …)."""
    try:
        with tifffile.TiffFile(file) as tiff:
            return notes_of_tiff(tiff.pages.first)
    except TIFF_FAILURES:
        return Notes()
