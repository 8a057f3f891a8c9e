"""What an instrument adds to a relief, taken off again: tilt, bow, and scan lines gone astray."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from precompute.errors import InputError
from precompute.height_fields.recipe import Level

Array = NDArray[np.float64]

DEPARTURE = 6.0
"""Robust standard deviations from the other lines at which one counts as astray. Of normal
deviations one in 5e8 lies as far out, and a scan has a few thousand lines at most."""

NEGLIGIBLE = 1e-4
"""Share of the relief's range below which a line's departure is let be: noise-free heights differ
by rounding alone, and any of them would be many deviations astray."""


def levelled(heights: Array, level: Level) -> Array:
    """The heights without their mean, plane or polynomial of least squares.

    Args:
        heights: Any unit, shape (rows, columns).
        level: ``none``, ``mean``, ``plane`` or the total order of a polynomial in x and y.

    Returns:
        That shape and unit.

    >>> tilted = np.add.outer(np.arange(4.0), 2 * np.arange(5.0))
    >>> bool(np.allclose(levelled(tilted, "plane"), 0))
    True
    """
    if level == "none":
        return heights
    order = {"mean": 0, "plane": 1}[level] if isinstance(level, str) else level
    rows, columns = heights.shape
    # Legendre's polynomials are nearly orthogonal on the grid, which powers of x are not.
    along_y = np.polynomial.legendre.legvander(np.linspace(-1, 1, rows), order)
    along_x = np.polynomial.legendre.legvander(np.linspace(-1, 1, columns), order)
    terms = [
        np.outer(along_y[:, i], along_x[:, j]).ravel()
        for i in range(order + 1)
        for j in range(order + 1 - i)
    ]
    matrix = np.stack(terms, axis=-1)
    # The normal equations are small, and well conditioned since the columns are nearly orthogonal.
    fit = np.linalg.solve(matrix.T @ matrix, matrix.T @ heights.ravel())
    return heights - (matrix @ fit).reshape(heights.shape)


def with_rows_mended(file: str | Path, heights: Array) -> Array:
    """Scan lines that depart from their neighbours, replaced by an interpolation between those.

    A line departs if the median of its difference from that interpolation, or what is left of the
    difference besides, lies far outside of what the other lines show. The line that differs most is
    left out first, then all are judged again: a bad line makes its neighbours look bad too. Where
    bad lines outnumber the good ones among them, the good ones are what departs.

    Args:
        file: Named in errors.
        heights: Shape (rows, columns), a scan line a row.

    Returns:
        That shape and unit.

    Raises:
        InputError: More than a quarter of the lines would have to go, or there are fewer than four.
    """
    rows = len(heights)
    if rows < 4:
        raise InputError(file, "outlier_rows", f"{rows} scan lines", "four or more to judge by")
    floor = NEGLIGIBLE * float(np.ptp(heights))
    good = np.ones(rows, dtype=bool)
    mended = heights.copy()
    offset, spread = np.zeros(rows), np.zeros(rows)
    stale = set(range(rows))
    while True:
        for row in stale:
            before, after = _nearest(good, row)
            # The bend of a clean relief makes it grow with both distances, by ½h″ times each.
            difference = heights[row] - _interpolated(heights, before, after, row)
            difference /= abs((row - before) * (after - row))
            offset[row] = np.median(difference)
            spread[row] = np.sqrt(np.mean((difference - offset[row]) ** 2))
        astray = good & (_departures(offset, spread, good, floor) > DEPARTURE)
        if not astray.any():
            break
        worst = int(np.argmax(np.where(astray, np.hypot(offset, spread), 0)))
        good[worst] = False
        if np.count_nonzero(~good) > rows // 4:
            expected = f"at most {rows // 4} scan lines of {rows} that depart from their neighbours"
            raise InputError(file, "outlier_rows", "more than that", expected)
        # Lines that used it for their interpolation.
        kept = np.flatnonzero(good)
        place = int(np.searchsorted(kept, worst))
        stale = set(kept[max(place - 2, 0) : place + 2].tolist())
    for row in np.flatnonzero(~good).tolist():
        mended[row] = _interpolated(heights, *_nearest(good, row), row)
    return mended


def _departures(offset: Array, spread: Array, good: NDArray[np.bool_], floor: float) -> Array:
    """How many robust deviations each line is astray, by its offset or by its spread."""
    by_offset = np.abs(offset) / (1.4826 * np.median(np.abs(offset[good])) + floor / DEPARTURE)
    logarithm = np.log(spread + floor)
    typical = np.median(logarithm[good])
    deviation = 1.4826 * np.median(np.abs(logarithm[good] - typical))
    # 0.1: spreads of clean lines that agree to less than a tenth are as good as equal.
    by_spread = (logarithm - typical) / (deviation + 0.1)
    return np.maximum(by_offset, by_spread)


def _nearest(good: NDArray[np.bool_], row: int) -> tuple[int, int]:
    """The good lines before and after a line, or at an end of the scan the two nearest."""
    kept = np.flatnonzero(good & (np.arange(len(good)) != row))
    place = int(np.clip(np.searchsorted(kept, row), 1, len(kept) - 1))
    return int(kept[place - 1]), int(kept[place])


def _interpolated(heights: Array, before: int, after: int, row: int) -> Array:
    """What a line would be on a straight line through two others."""
    share = (row - before) / (after - before)
    return (1 - share) * heights[before] + share * heights[after]
