"""Tiles moved to where the pattern really is, by comparing them with what the pattern should show.

Neighbouring tiles show different parts of the pattern lit, so that they cannot be laid on each
other. But once there is a map, each tile can be predicted, and moved until it looks as it should
(Lucas and Kanade 1981, with the shift and the stretch of a tile).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from precompute.acquisition.lobe_fit import Fit, Model, predicted
from precompute.acquisition.lobes import Array32
from precompute.acquisition.observations import Shot, observed, texel_places
from precompute.acquisition.tiling import Tiling
from precompute.progress import tracked

Array = NDArray[np.float64]

BLURS = (3.0, 1.5, 1.0)
"""Standard deviations, texels, with which a tile and its prediction are compared, one after the
other: the first sees shifts of several texels, the last the edges."""

LOOSE = 0.02
"""How much of what a well lit tile tells of its place counts against moving it."""

MOST_STRETCH = 0.02
"""Of a tile in one step."""

OUTLIER = 0.3
"""Difference, in the brightest of what is predicted, from which an observation counts half."""


def aligned(
    shots: list[Shot],
    tiling: Tiling,
    model: Model,
    fit: Fit,
    size: tuple[int, int],
    highlight: float,
    reference: tuple[int, int] | None,
) -> Tiling:
    """Move every tile to where it looks most like what the fitted pattern should show there.

    Args:
        shots: The photographs.
        tiling: Where the tiles were thought to be.
        model: What gratings show.
        fit: Of the texels of the pattern, row by row.
        size: Columns and rows of them.
        highlight: ρ below which observations are not used.
        reference: Row and column of the tile that stays where it is; the mean, if left out.

    Returns:
        The tiling, each tile with a shift and a stretch.
    """
    shifts, stretches = tiling.shifts.copy(), tiling.stretches.copy()
    for row, column in tracked(tiling.tiles(), "Aligning tiles"):
        moved = replace(tiling, shifts=shifts, stretches=stretches)
        for blur in BLURS:
            shift, stretch = _step(shots, moved, model, fit, size, highlight, (row, column), blur)
            shifts[row, column] += shift
            stretches[row, column] += stretch
    shifts -= shifts.mean(axis=(0, 1)) if reference is None else shifts[reference]
    return replace(tiling, shifts=shifts, stretches=stretches)


def _step(
    shots: list[Shot],
    tiling: Tiling,
    model: Model,
    fit: Fit,
    size: tuple[int, int],
    highlight: float,
    tile: tuple[int, int],
    blur: float,
) -> tuple[Array, Array]:
    """By how much more a tile is shifted, mm, shape (2,), and stretched, shape (2, 2)."""
    columns, rows = size
    place = texel_places(size)
    strip = observed(shots, tiling, place, highlight, [tile])
    shown = predicted(strip, model, fit)
    trust = strip.usable & ((fit.gain > 0) & (fit.strength > 0))[:, None]
    shown, seen = (
        _blurred(np.where(trust[..., None], values, 0), size, blur)
        for values in (shown, strip.intensity)
    )
    brightest = float(shown.max(initial=0))
    if brightest == 0:
        return np.zeros(2), np.zeros((2, 2))
    rest = (seen - shown) / brightest
    weight = 1 / (1 + (rest / OUTLIER) ** 2)
    # The pattern moved by d shows shown(x − d): rest = −∇shown · d, with d = shift + stretch · x.
    pitch = tiling.size / [columns, rows]
    down, right = np.gradient(shown / brightest, axis=(0, 1))
    gradient = np.stack([right / pitch[0], -down / pitch[1]], axis=-1)
    x, y = np.moveaxis(((place - 0.5) * tiling.size * [1, -1]).reshape(rows, columns, 2), -1, 0)
    x, y = x[..., None, None], y[..., None, None]
    columns_of = [gradient[..., i] for i in range(2)]
    columns_of += [gradient[..., i] * along for i in range(2) for along in (x, y)]
    left = -np.stack([part.ravel() for part in columns_of], axis=1)
    weighted = left * weight.ravel()[:, None]
    normal = weighted.T @ left
    # Where a tile shows too little to tell, it stays as it is.
    scale = np.trace(normal[:2, :2]) / 2 + 1e-30
    held = scale * np.array([LOOSE, LOOSE, *[50 * np.mean(tiling.size) ** 2 / 4] * 4])
    step = np.linalg.solve(normal + np.diag(held), weighted.T @ rest.ravel())
    limit = 2 * blur * pitch
    return np.clip(step[:2], -limit, limit), np.clip(
        step[2:].reshape(2, 2), -MOST_STRETCH, MOST_STRETCH
    )


def _blurred(values: Array32, size: tuple[int, int], blur: float) -> Array:
    columns, rows = size
    image = values.reshape(rows, columns, *values.shape[1:]).astype(np.float64)
    return gaussian_filter(image, (blur, blur, 0, 0))
