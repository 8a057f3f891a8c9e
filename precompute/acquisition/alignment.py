"""Tiles moved to where the pattern really is, by comparing them with what the pattern should show.

Neighbouring tiles show different parts of the pattern lit, so that they cannot be laid on each
other. But once there is a map, each tile can be predicted, and moved until it looks as it should
(Lucas and Kanade 1981).
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from os import cpu_count

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from precompute.acquisition.calibration import Calibration
from precompute.acquisition.lobe_fit import Fit, predicted
from precompute.acquisition.lobes import Array32
from precompute.acquisition.observations import observed, texel_places
from precompute.acquisition.tiling import Tiling

Array = NDArray[np.float64]

ROUNDS = 5
"""Of fitting the pattern and moving the tiles."""

LONGER = 1.6
"""Times a shift as it comes out: 1 takes twice as many rounds, from 2.5 on tiles run away."""

STILL = 0.05
"""Median change, texels, from which another round would not be worth its time."""

BLURS = (3.0, 1.5, 1.0)
"""Standard deviations, texels, with which a tile and its prediction are compared, one after the
other: the first sees shifts of several texels, the last the edges."""

LOOSE = 0.15
"""How much of what a well lit tile tells of its place counts against moving it."""

HALF = 0.05
"""Brightness, in the brightest of what is predicted, that counts as half lit."""

FAINT = 0.2
"""Of a lobe's peak, for which a tile's brightest counts at least: one in which all is dim does not
tell its place by what noise and haze leave in it."""

OUTLIER = 0.3
"""Difference between lit and dark from which an observation counts half."""


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
        reference: Indices, row and column, of the tile that stays where it is.

    Returns:
        The tiling, each tile with its shift.
    """
    places = texel_places(size)
    for round_ in range(ROUNDS):
        fit = calibration.fit(tiling, places, f"Alignment {round_}")
        shifts = tiling.shifts + LONGER * (_moved(calibration, tiling, fit, size) - tiling.shifts)
        shifts -= shifts[reference]
        change = np.abs(shifts - tiling.shifts) / (tiling.size / size)
        tiling = replace(tiling, shifts=shifts)
        if np.median(change) < STILL:
            break
    return tiling


def _moved(calibration: Calibration, tiling: Tiling, fit: Fit, size: tuple[int, int]) -> Array:
    """The shifts of all tiles after a step with each blur."""
    shifts = tiling.shifts.copy()
    tiles = tiling.tiles()
    pitch = tiling.size / size
    for blur in BLURS:
        told = partial(_told, calibration, replace(tiling, shifts=shifts), fit, size, blur)
        with ThreadPoolExecutor(cpu_count()) as pool:
            normal, right = (np.array(part) for part in zip(*pool.map(told, tiles), strict=True))
        # Where a tile shows too little to tell, it stays as it is.
        held = LOOSE * np.median(np.trace(normal, axis1=1, axis2=2)) / 2 + 1e-30
        steps = np.linalg.solve(normal + held * np.eye(2), right[..., None])[..., 0]
        limit = 2 * blur * pitch
        for tile, step in zip(tiles, steps, strict=True):
            shifts[tile] += step.clip(-limit, limit)
    return shifts


def _told(
    calibration: Calibration,
    tiling: Tiling,
    fit: Fit,
    size: tuple[int, int],
    blur: float,
    tile: tuple[int, int],
) -> tuple[Array, Array]:
    """What a tile tells of its shift d, mm, in normal equations: (2, 2) times d is (2,)."""
    columns, rows = size
    place = texel_places(size)
    strip = observed(calibration.shots, tiling, place, calibration.highlight, [tile])
    shown = predicted(strip, calibration.model, fit)
    trust = strip.usable & ((fit.gain > 0) & (fit.strength > 0))[:, None]
    brightest = shown.max(axis=(0, 1), initial=0)
    if not brightest.any():
        return np.zeros((2, 2)), np.zeros(2)
    # Lobes that bumps move do not move edges: what counts is whether a texel is lit.
    model = calibration.model
    brightest_lobes = [table.values.max(axis=(0, 1)) for table in model.tables]
    peak = model.strength * np.max(brightest_lobes, axis=0)
    half = np.float32(HALF) * np.maximum(brightest, np.float32(FAINT) * peak)
    shown, seen = (
        _blurred(np.where(trust[..., None], lit / (lit + half), 0), size, blur)
        for lit in (np.maximum(shown, 0), np.maximum(strip.intensity, 0))
    )
    rest = seen - shown
    weight = 1 / (1 + (rest / OUTLIER) ** 2)
    # The pattern moved by d shows shown(x − d): rest = −∇shown · d.
    pitch = tiling.size / [columns, rows]
    down, right = np.gradient(shown, axis=(0, 1))
    left = np.stack([-right.ravel() / pitch[0], down.ravel() / pitch[1]], axis=1)
    weighted = left * weight.ravel()[:, None]
    return weighted.T @ left, weighted.T @ rest.ravel()


def _blurred(values: Array32, size: tuple[int, int], blur: float) -> Array32:
    columns, rows = size
    image = values.reshape(rows, columns, *values.shape[1:])
    blurred = np.empty_like(image)
    gaussian_filter(image, (blur, blur, 0, 0), output=blurred)
    return blurred
