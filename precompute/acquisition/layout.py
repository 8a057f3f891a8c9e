"""Where a capture's tiles are: as it says, or as its photographs show."""

from __future__ import annotations

import numpy as np

from precompute.acquisition.capture import Capture
from precompute.acquisition.observations import Shot
from precompute.acquisition.tiling import Tiling
from precompute.errors import InputError


def tiling_of(capture: Capture, shots: list[Shot]) -> tuple[Tiling, tuple[int, int]]:
    """Where a capture's tiles are, and the row and column of the reference among them.

    Without a reference the pattern begins at the sample's top left corner, and the tile in the
    middle is the one that others are compared with.

    Args:
        capture: What is said of the sample.
        shots: Its photographs.

    Raises:
        InputError: The tile is not given and nothing repeats.
    """
    sample = np.array(capture.sample.size_mm)
    corner = sample / 2 * [-1, 1]
    if capture.sample.tile_mm is None:
        raise InputError("capture", "sample.tile_mm", None, "the size of the tile")
    size = np.array(capture.sample.tile_mm)
    reference = None
    if capture.sample.reference_tile_px is not None:
        marked = np.array(capture.sample.reference_tile_px)
        corner = shots[0].rectification.on_sample(marked)[0]
        reference = corner
    tiling = Tiling.covering(sample, size, corner)
    rows, columns = tiling.shifts.shape[:2]
    if reference is None:
        return tiling, ((rows - 1) // 2, (columns - 1) // 2)
    column, row = np.round((reference - tiling.corner) / size * [1, -1]).astype(int)
    return tiling, (int(row), int(column))
