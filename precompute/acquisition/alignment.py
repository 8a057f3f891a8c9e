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

from precompute.acquisition.calibration import Calibration
from precompute.acquisition.lobe_fit import Fit, fit_texels, predicted
from precompute.acquisition.lobes import Array32
from precompute.acquisition.observations import observed, texel_places
from precompute.acquisition.tiling import Tiling

Array = NDArray[np.float64]

ROUNDS = 6
"""Of fitting the pattern and moving the tiles."""

LONGER = 1.6
"""Times a shift as it comes out: 1 takes twice as many rounds, from 2.5 on tiles run away."""

STILL = 0.03
"""Median change, texels, from which another round would not be worth its time."""

BLURS = (3.0, 1.5, 1.0)
"""Standard deviations, texels, with which a tile and its prediction are compared, one after the
other: the first sees shifts of several texels, the last the edges."""

LOOSE = 0.02
"""How much of what a well lit tile tells of its place counts against moving it."""

STIFF = 2.0
"""The same of stretching it: paper stretches far less than tiles are shifted."""

MOST_STRETCH = 0.02
"""Of a tile in one step."""

OUTLIER = 0.3
"""Difference, in the brightest of what is predicted, from which an observation counts half."""


def aligned(
    calibration: Calibration, tiling: Tiling, size: tuple[int, int], reference: tuple[int, int]
) -> Tiling:
    """Move every tile to where it looks most like what the pattern should show there.

    A tile has its own share in the pattern that it is compared with, which holds it back: steps
    are taken longer than they come out, and several times, each with the pattern fitted anew.

    Args:
        calibration: The photographs, and what gratings show in them.
        tiling: Where the tiles were thought to be.
        size: Columns and rows of texels to compare.
        reference: Row and column of the tile that stays where it is.

    Returns:
        Of all that was tried the tiling whose pattern explains the photographs best.
    """
    places = texel_places(size)
    best, most = tiling, -np.inf
    for round_ in range(ROUNDS):
        fit = fit_texels(
            calibration.shots,
            tiling,
            places,
            calibration.highlight,
            calibration.model,
            f"Alignment {round_}",
        )
        if fit.gain.sum() > most:
            best, most = tiling, fit.gain.sum()
        moved = _moved(calibration, tiling, fit, size)
        shifts = tiling.shifts + LONGER * (moved.shifts - tiling.shifts)
        shifts -= shifts[reference]
        change = np.abs(shifts - tiling.shifts) / (tiling.size / size)
        tiling = replace(moved, shifts=shifts)
        if np.median(change) < STILL:
            break
    return best


def _moved(calibration: Calibration, tiling: Tiling, fit: Fit, size: tuple[int, int]) -> Tiling:
    shifts, stretches = tiling.shifts.copy(), tiling.stretches.copy()
    for tile in tiling.tiles():
        for blur in BLURS:
            now = replace(tiling, shifts=shifts, stretches=stretches)
            shift, stretch = _step(calibration, now, fit, size, tile, blur)
            shifts[tile] += shift
            stretches[tile] += stretch
    return replace(tiling, shifts=shifts, stretches=stretches)


def _step(
    calibration: Calibration,
    tiling: Tiling,
    fit: Fit,
    size: tuple[int, int],
    tile: tuple[int, int],
    blur: float,
) -> tuple[Array, Array]:
    """By how much more a tile is shifted, mm, shape (2,), and stretched, shape (2, 2)."""
    columns, rows = size
    place = texel_places(size)
    strip = observed(calibration.shots, tiling, place, calibration.highlight, [tile])
    shown = predicted(strip, calibration.model, fit)
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
    held = scale * np.array([LOOSE, LOOSE, *[STIFF * np.mean(tiling.size) ** 2 / 4] * 4])
    step = np.linalg.solve(normal + np.diag(held), weighted.T @ rest.ravel())
    shift_limit = 2 * blur * pitch
    shift, stretch = step[:2], step[2:].reshape(2, 2)
    return (
        shift.clip(-shift_limit, shift_limit).astype(np.float64),
        stretch.clip(-MOST_STRETCH, MOST_STRETCH).astype(np.float64),
    )


def _blurred(values: Array32, size: tuple[int, int], blur: float) -> Array:
    columns, rows = size
    image = values.reshape(rows, columns, *values.shape[1:]).astype(np.float64)
    return gaussian_filter(image, (blur, blur, 0, 0))
