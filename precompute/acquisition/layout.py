"""Where a capture's tiles are: as it says, or as its photographs show."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from precompute.acquisition.capture import Capture
from precompute.acquisition.observations import Shot, looked_up
from precompute.acquisition.repetition import find_tile, reference_tiling
from precompute.acquisition.tiling import Tiling

Array = NDArray[np.float64]


def tiling_of(
    capture: Capture, shots: list[Shot], name: str, say: Callable[[str], None]
) -> tuple[Tiling, tuple[int, int]]:
    """Where a capture's tiles are, and the row and column of the reference among them.

    Without a reference the pattern begins at the sample's top left corner, and the tile in the
    middle is the one that others are compared with.

    Args:
        capture: What is said of the sample.
        shots: Its photographs, the first being that in which the reference is marked.
        name: The capture's file, for errors.
        say: Takes remarks on what was found.

    Raises:
        InputError: The reference is no upright rectangle; or no size is given and nothing repeats.
    """
    sample = np.array(capture.sample.size_mm)
    corner, size = sample / 2 * [-1, 1], capture.sample.tile_mm
    marked = capture.sample.reference_tile_px
    if marked is not None:
        marked_size, top_left = reference_tiling(marked, shots[0].rectification, name)
        corner, size = np.array(top_left), size or marked_size
    if size is None:
        size = _found(shots, sample)
        say(f"sample.tile_mm found: {size[0]:.2f} × {size[1]:.2f}")
    tiling = Tiling.covering(sample, np.array(size), corner)
    rows, columns = tiling.shifts.shape[:2]
    if marked is None:
        return tiling, ((rows - 1) // 2, (columns - 1) // 2)
    column, row = np.round((corner - tiling.corner) / tiling.size * [1, -1]).astype(int)
    return tiling, (int(row), int(column))


def _found(shots: list[Shot], sample: Array) -> tuple[float, float]:
    """The tile that repeats, from the photographs as they lie on the sample, at their own pitch."""
    pitch = 1 / shots[0].rectification.pixels_per_mm()
    columns, rows = (int(n) for n in np.floor(sample / pitch))
    x = (np.arange(columns) + 0.5) * pitch - sample[0] / 2
    y = sample[1] / 2 - (np.arange(rows) + 0.5) * pitch
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    pictures = [
        looked_up(shot, points)[0].sum(axis=1).reshape(rows, columns).astype(np.float64)
        for shot in shots
    ]
    return find_tile(pictures, pitch)
