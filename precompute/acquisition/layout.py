"""Where a capture's tiles are: as it says, or as its photographs show."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from precompute.acquisition.agreement import Look, lit_points
from precompute.acquisition.calibration import HIGHLIGHT
from precompute.acquisition.capture import Capture
from precompute.acquisition.lobes import lobe_deviation
from precompute.acquisition.marked_tile import reference_tiling
from precompute.acquisition.observations import Shot, half_vectors, looked_up
from precompute.acquisition.repetition import find_tile
from precompute.acquisition.shots import ROUGHNESS, Taken
from precompute.acquisition.tiling import Tiling

Array = NDArray[np.float64]

GRID = 480
"""Points along the sample's longer side, at most, among which a repetition is looked for."""

PARTS = 4
"""Along each side of a grid's cell, most, at which a finer photograph is looked up."""


def tiling_of(
    capture: Capture, taken: Taken, name: str, say: Callable[[str], None]
) -> tuple[Tiling, tuple[int, int]]:
    """Where a capture's tiles are, and the row and column of the reference among them.

    Without a reference the pattern begins at the sample's top left corner, and the tile in the
    middle is the one that others are compared with.

    Args:
        capture: What is said of the sample.
        taken: Its photographs.
        name: The capture's file, for errors.
        say: Takes remarks on what was found.

    Raises:
        InputError: The reference is no upright rectangle; or no size is given and nothing repeats.
    """
    sample = np.array(capture.sample.size_mm)
    corner, size = sample / 2 * [-1, 1], capture.sample.tile_mm
    marked = capture.sample.reference_tile_px
    if marked is not None:
        marked_size, top_left = reference_tiling(marked, taken.rectifications[0], name)
        corner, size = np.array(top_left), size or marked_size
    if size is None:
        size = _found(taken.shots, sample)
        say(f"sample.tile_mm found: {size[0]:.2f} × {size[1]:.2f}")
    tiling = Tiling.covering(sample, np.array(size), corner)
    rows, columns = tiling.shifts.shape[:2]
    if marked is None:
        return tiling, ((rows - 1) // 2, (columns - 1) // 2)
    column, row = np.round((corner - tiling.corner) / tiling.size * [1, -1]).astype(int)
    return tiling, (int(row), int(column))


def _found(shots: list[Shot], sample: Array) -> tuple[float, float]:
    """The tile that repeats, from the photographs on one grid, no finer than they are."""
    pixel = 1 / shots[0].rectification.pixels_per_mm()
    pitch = max(float(sample.max()) / GRID, pixel)
    parts = min(int(np.ceil(pitch / pixel)), PARTS)
    columns, rows = (int(n) for n in np.floor(sample / pitch))
    x = (np.arange(columns) + 0.5) * pitch - sample[0] / 2
    y = sample[1] / 2 - (np.arange(rows) + 0.5) * pitch
    points = np.stack(np.meshgrid(x, y), axis=-1)
    return find_tile([_look(shot, points, pitch, parts) for shot in shots], pitch)


def _look(shot: Shot, points: Array, pitch: float, parts: int) -> Look:
    """A photograph on a grid.

    Args:
        shot: The photograph.
        points: The grid's, mm, shape (rows, columns, 2).
        pitch: Of the grid, mm.
        parts: Along each side of a grid's cell at which the photograph is looked up.
    """
    shape, flat = points.shape[:2], points.reshape(-1, 2)
    picture, usable = np.zeros(shape), np.ones(shape, bool)
    steps = ((np.arange(parts) + 0.5) / parts - 0.5) * pitch
    for step in np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2):
        seen, good = looked_up(shot, flat + step)
        picture += seen.sum(axis=1).reshape(shape) / parts**2
        usable &= good.reshape(shape)
    h, _ = half_vectors(flat, shot.rectification.eye, shot.light)
    u, v = h[:, :2].T.reshape(2, *shape)
    highlight = HIGHLIGHT * lobe_deviation(shot.radius, ROUGHNESS)
    return Look(lit_points(picture), usable & (np.hypot(u, v) > highlight), u, v)
