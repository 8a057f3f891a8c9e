"""The power spectrum of a relief, and the period that dominates it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from precompute.height_fields.field import HeightField

Array = NDArray[np.float64]


def power_spectrum(field: HeightField, windowed: bool = False) -> Array:
    """|H_jl|², of which each line (j/Tx, l/Ty) has its place [l, j] as in `numpy.fft.fft2`.

    Args:
        field: The patch.
        windowed: Weight it by a Hann window, for a patch that is cut out of a larger surface and
            does not repeat: its edges, which do not meet, would else lie over everything.

    Returns:
        The shape of the heights, µm², without the mean's. Unwindowed, the sum is the variance.

    >>> wave = np.cos(2 * np.pi * np.arange(8) / 8)
    >>> power_spectrum(HeightField(np.tile(wave, (4, 1)), (0.1, 0.1)))[0, [1, 7]].round(9).tolist()
    [0.25, 0.25]
    """
    rows, columns = field.heights.shape
    weights = np.outer(_hann(rows), _hann(columns)) if windowed else np.ones((rows, columns))
    weights /= weights.sum()
    centred = field.heights - (weights * field.heights).sum()
    return np.abs(np.fft.fft2(weights * centred)) ** 2


def dominant_frequency(field: HeightField, windowed: bool = False) -> tuple[float, float]:
    """The strongest spatial frequency (f_x, f_y), 1/µm, the one of ±f that points to +x, or +y.

    Its period is 1/|f|, its direction that in which the height changes. Windowed, it is found
    between the lines, at the top of a parabola through the logarithms about the largest.
    """
    power = power_spectrum(field, windowed)
    rows, columns = power.shape
    row, column = np.unravel_index(np.argmax(power), power.shape)
    j = (column + columns // 2) % columns - columns // 2
    l = (row + rows // 2) % rows - rows // 2  # noqa: E741
    if windowed:
        with np.errstate(divide="ignore"):
            around = np.log(power)
        j = j + _top(around[row, (column + np.arange(-1, 2)) % columns])
        l = l + _top(around[(row + np.arange(-1, 2)) % rows, column])  # noqa: E741
    x, y = float(j / field.period[0]), float(l / field.period[1])
    return (-x, -y) if (x, y) < (0, 0) else (x, y)


def periods_held(field: HeightField) -> float:
    """How many periods of its strongest frequency a patch that does not repeat is long.

    Along x or along y, whichever is more.
    """
    x, y = dominant_frequency(field, windowed=True)
    return max(abs(x) * field.period[0], abs(y) * field.period[1])


def _hann(size: int) -> Array:
    return np.sin(np.pi * (np.arange(size) + 0.5) / size) ** 2


def _top(values: Array) -> float:
    """Where a parabola through values at −1, 0 and 1 is highest; 0 where there is none."""
    before, middle, after = values
    curvature = before - 2 * middle + after
    if not np.isfinite(curvature) or curvature >= 0:
        return 0.0
    return float(np.clip((before - after) / (2 * curvature), -0.5, 0.5))
