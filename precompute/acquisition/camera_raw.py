"""Camera raw: the sensor's numbers by LibRaw, demosaiced, otherwise left alone."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import rawpy
from numpy.typing import NDArray

from precompute.errors import InputError, unreadable

FULL = 65535


@dataclass(frozen=True)
class RawImage:
    """What the sensor saw.

    Attributes:
        numbers: With the black level in them, 65535 at the camera's own white level; camera's own
            colours, no white balance, not turned; shape (height, width, 3), or 1 where the sensor
            has no colour filters.
        black: Of each channel, on that scale, shape (channels,).
        step: Between neighbouring numbers of the sensor, as a share of white over black.
        exposure_s: As the camera noted it; None where it did not.
    """

    numbers: NDArray[np.uint16]
    black: NDArray[np.float64]
    step: float
    exposure_s: float | None


def read_raw(file: Path) -> RawImage:
    """Read a camera's raw file.

    The black level stays in the numbers, for LibRaw would cut off at 0 what noise puts below it.
    Demosaicing is bilinear: linear in light, so that exposures merged after it are as if merged
    before, and the same with and without noise.

    Args:
        file: Any format that LibRaw reads.

    Raises:
        InputError: It is not, or its sensor has other colours than red, green and blue.
    """
    try:
        with rawpy.imread(str(file)) as raw:
            colours = raw.num_colors
            if colours not in (1, 3):
                raise InputError(file, "colours", colours, "3 (red, green, blue) or 1")
            levels = np.array(raw.black_level_per_channel, float)
            white = float(raw.white_level)
            shutter = float(raw.other.shutter_speed)
            pattern, names = raw.raw_pattern, raw.color_desc.decode()
            numbers = raw.postprocess(
                demosaic_algorithm=rawpy.DemosaicAlgorithm.LINEAR,
                user_wb=[1.0, 1.0, 1.0, 1.0],
                output_color=rawpy.ColorSpace.raw,
                output_bps=16,
                user_flip=0,
                user_black=0,
                user_cblack=[0, 0, 0, 0],
                no_auto_bright=True,
                # Else LibRaw takes the picture's brightest number for white.
                adjust_maximum_thr=0.0,
                gamma=(1, 1),
            )
    except (rawpy.LibRawError, rawpy.NotSupportedError) as failure:
        reason = failure.args[0] if failure.args else failure
        raise unreadable(file, reason.decode() if isinstance(reason, bytes) else reason) from None
    if colours == 1:
        numbers, black = numbers[..., :1], levels[:1]
    else:
        # Two greens may differ by a little; each green pixel was one of them. Without a pattern
        # each pixel had all three colours.
        used = np.arange(3) if pattern is None else pattern.ravel()
        black = np.array([levels[[i for i in used if names[i] == c]].mean() for c in "RGB"])
    return RawImage(
        numbers.astype(np.uint16, copy=False),
        black / white * FULL,
        1 / (white - black.max()),
        shutter or None,
    )
