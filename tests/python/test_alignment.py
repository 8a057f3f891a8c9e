"""Tiles that are off their places, put back by what they show."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from precompute.acquisition.alignment import aligned
from precompute.acquisition.calibration import Calibration
from precompute.acquisition.capture import Camera
from precompute.acquisition.lobe_fit import Model
from precompute.acquisition.lobes import LobeTable, at_radius, lobe_deviation
from precompute.acquisition.observations import Shot, half_vectors
from precompute.acquisition.rectification import Rectification
from precompute.acquisition.tiling import Tiling
from precompute.acquisition.view import View
from precompute.spectra import WAVELENGTHS

SIZE = (40, 40)
TILE = np.array([12.0, 12.0])
SAMPLE = np.array([72.0, 60.0])
EYE = (0.0, 0.0, 300.0)
SIZE_PX = (300, 250)
LIGHTS = ((-40.0, 20.0, 150.0), (40.0, 30.0, 150.0), (5.0, -40.0, 150.0))
REFERENCE = (2, 2)
ALPHA = float(np.radians(0.9))
WEIGHTS = np.exp(-((WAVELENGTHS[:, None] - np.array([0.46, 0.54, 0.61])) ** 2) / (2 * 0.04**2))
TABLE = LobeTable.of(WEIGHTS, lobe_deviation(ALPHA, 0.0), np.array([1 / 1.66]), 0.15)
HIGHLIGHT = 0.08


def orientation(place: np.ndarray) -> np.ndarray:
    """Of seven cells of a tile that repeats, at places right of and below its top left corner."""
    points = np.random.default_rng(4).uniform(0, 1, (7, 2))
    apart = np.mod(place[:, None] - points + 0.5, 1) - 0.5
    cell = np.argmin(np.sum(apart**2, axis=2), axis=1)
    return (cell * 3 % 7) * np.pi / 7


def shot(light: np.ndarray, tiling: Tiling) -> Shot:
    """A photograph without noise of the pattern, each tile where `tiling` has it."""
    camera = Camera(position_mm=EYE, focal_px=1200)
    rectification = Rectification.of_view(View.of(camera, SIZE_PX))
    fine = 4  # values of a pixel are means over 4 × 4 places in it
    x, y = (((np.arange(fine * n) + 0.5) / fine - 0.5) for n in SIZE_PX)
    pixels = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    points = rectification.on_sample(pixels)
    tile = np.floor((points - tiling.corner) / TILE * [1, -1]).astype(int)
    column, row = (np.clip(tile, 0, np.array(tiling.shifts.shape[1::-1]) - 1)).T
    place = (points - tiling.shifts[row, column] - tiling.corner) / TILE * [1, -1]
    θ = orientation(place)
    h, irradiance = half_vectors(points, np.array(EYE), light)
    along = np.abs(h[:, 0] * np.cos(θ) + h[:, 1] * np.sin(θ))
    across = h[:, 1] * np.cos(θ) - h[:, 0] * np.sin(θ)
    lobe = irradiance * np.exp(-(across**2) / (2 * TABLE.deviation**2))
    shown = at_radius(TABLE.values[0], along.astype(np.float32)) * lobe[:, None]
    width, height = SIZE_PX
    values = shown.reshape(height, fine, width, fine, 3).mean(axis=(1, 3)).astype(np.float32)
    usable = np.ones(values.shape[:2], bool)
    dark = np.zeros(3, np.float32)
    return Shot("a.tif", values, usable, rectification, light, ALPHA, WEIGHTS, dark)


def calibration(tiling: Tiling) -> Calibration:
    shots = [shot(np.array(light), tiling) for light in LIGHTS]
    peak = TABLE.values.max()
    weights = np.full((len(shots), 3), 10 / peak, np.float32)
    model = Model([TABLE] * len(shots), np.ones(1), 1.0, weights)
    return Calibration(shots, model, HIGHLIGHT, 0.0, True, np.ones(len(shots)), 0.0)


def planted(shift_mm: float) -> Tiling:
    """Every tile so far off, in a direction of its own, but the reference."""
    tiling = Tiling.covering(SAMPLE, TILE, SAMPLE / 2 * [-1, 1])
    turn = np.random.default_rng(5).uniform(0, 2 * np.pi, tiling.shifts.shape[:2])
    shifts = shift_mm * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    shifts[REFERENCE] = 0
    return replace(tiling, shifts=shifts)


def left_over(truth: Tiling) -> np.ndarray:
    """What of the shifts is not found, in texels, right and up, shape (rows, columns, 2)."""
    straight = replace(truth, shifts=np.zeros_like(truth.shifts))
    found = aligned(calibration(truth), straight, SIZE, REFERENCE)
    assert found.shifts[REFERENCE].tolist() == [0, 0]
    return (found.shifts - truth.shifts) / (TILE / SIZE)


def test_tiles_come_back_to_their_places() -> None:
    """Shifts of 2.5 texels to all sides; tiles with hardly anything lit, a few, are not found."""
    off = np.linalg.norm(left_over(planted(0.75)), axis=2)
    assert np.median(off) < 0.9
    assert np.mean(off < 1.5) > 0.8


def test_tiles_in_their_places_stay_near_them() -> None:
    off = np.linalg.norm(left_over(planted(0.0)), axis=2)
    assert np.median(off) < 0.9


# ---- Lattices ------------------------------------------------------------------------------------


def test_tiles_cover_the_sample_whichever_is_marked() -> None:
    """30 × 20 mm of tiles of 10 × 8: three, and two and a half, from the marked one on."""
    size, sample = np.array([10.0, 8.0]), np.array([30.0, 20.0])
    tiling = Tiling.covering(sample, size, np.array([-5.0, 2.0]))
    assert tiling.corner == pytest.approx([-15, 10])
    assert tiling.shifts.shape == (3, 3, 2)
    assert tiling.tiles()[:4] == [(0, 0), (0, 1), (0, 2), (1, 0)]
    between = Tiling.covering(sample, size, np.array([-2.0, 1.0]))
    assert between.corner == pytest.approx([-22, 17])
    assert between.shifts.shape == (4, 4, 2)


def test_places_are_right_of_and_below_a_tiles_corner() -> None:
    tiling = Tiling.covering(np.array([30.0, 24.0]), np.array([10.0, 8.0]), np.array([-15.0, 12.0]))
    tiling.shifts[1, 2] = [0.5, -0.25]
    place = np.array([[0, 0], [1, 1], [0.25, 0.5]])
    assert tiling.points(0, 0, place) == pytest.approx(np.array([[-15, 12], [-5, 4], [-12.5, 8]]))
    assert tiling.points(1, 2, place) == pytest.approx(
        np.array([[5.5, 3.75], [15.5, -4.25], [8, -0.25]])
    )
    inside = tiling.on_sample(np.array([[15, 12], [15.1, 0], [0, -12.1]]))
    assert inside.tolist() == [True, False, False]
