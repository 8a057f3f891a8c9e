"""The filter of orientations: noise goes, steps and what turns stay, masks do not bleed."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from refusals import refused

from precompute.acquisition import orientation_filter
from precompute.acquisition.orientation_filter import FilterOptions, filtered_orientation

SIZE = 72
HALF = SIZE // 2
WHOLE = np.ones((SIZE, SIZE), bool)
NOISE = np.random.default_rng(4).standard_normal((SIZE, SIZE))
STEP = np.where(np.arange(SIZE) < HALF, 0.0, 30.0) + np.zeros((SIZE, 1))


def off(found: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """Differences of orientations in degrees, modulo 180°: `found` in rad, `truth` in degrees."""
    return np.abs((np.rad2deg(found) - truth + 90) % 180 - 90)


def rms(errors: np.ndarray) -> float:
    return float(np.sqrt(np.nanmean(errors**2)))


def filtered(truth: np.ndarray, noise: float, options: FilterOptions | None = None) -> np.ndarray:
    """Errors in degrees of a map, degrees, to which noise was added, degrees."""
    σ = np.radians(noise)
    found = filtered_orientation(np.radians(truth) + σ * NOISE, σ, WHOLE, options)
    return off(found.orientation, truth)


@pytest.mark.parametrize("middle", [0.0, 45.0, 90.0, 179.5])
def test_a_step_of_30_degrees_stays_within_2_pixels(middle: float) -> None:
    """Wherever it lies on the circle; also where orientations are 0 and 180 by turns of noise."""
    truth = STEP + middle - 15
    passes = []
    σ = np.radians(5.0)
    noisy = np.radians(truth) + σ * NOISE
    filtered_orientation(noisy, σ, WHOLE, passed=lambda _, θ: passes.append(off(θ, truth)))
    assert len(passes) == 10
    errors = [rms(error) for error in passes]
    assert errors[0] < 0.4 * 5  # a window of 3 pixels holds 113, less by the edge
    assert errors[-1] < 0.6 * errors[0]
    assert all(later < 1.02 * before for before, later in pairwise(errors))
    away = np.delete(passes[-1], slice(HALF - 2, HALF + 2), axis=1)
    # 30° in the middle of a ramp would be 15° off; noise alone is 5° / √113 in the first pass.
    assert away.max() < 2.5
    assert np.median(passes[-1][:, HALF - 1 : HALF + 1]) < 1


def test_steps_outlast_fifty_passes_as_they_do_not_under_a_constant_width() -> None:
    ours = filtered(STEP, 5.0, FilterOptions(iterations=50))
    constant = filtered(STEP, 5.0, FilterOptions(range=0.35, deviations=0, iterations=50))
    assert rms(ours) < 0.6
    assert rms(constant) > 4


def test_spokes_and_strokes_are_no_worse_than_they_were() -> None:
    """Ten half turns around a point, finer than pixels in the middle; strokes of two pixels."""
    row, column = np.mgrid[:SIZE, :SIZE] - HALF + 0.5
    spokes = 5 * np.rad2deg(np.arctan2(-row, column))
    strokes = np.where(np.mod(np.arange(SIZE), 8) < 2, 30.0, 80.0) + np.zeros((SIZE, 1))
    for truth in (spokes, strokes):
        errors = filtered(truth, 1.0, FilterOptions(iterations=3))
        assert errors.mean() < 0.6 * np.abs(NOISE).mean()
        assert errors.max() < 10


def test_corners_stay() -> None:
    """A square of 10 × 10 pixels: at a pixel a pass from each corner nothing would be left."""
    truth = np.zeros((SIZE, SIZE))
    truth[20:30, 20:30] = 60
    wrong = filtered(truth, 5.0) > 10
    assert np.count_nonzero(wrong) <= 8


@pytest.mark.parametrize("slope", [0.5, 2.0, 4.0])
@pytest.mark.parametrize("direction", [0, 1, -1])
def test_what_turns_steadily_gets_no_stairs(slope: float, direction: int) -> None:
    """Degrees per pixel, along rows or aslant."""
    row, column = np.mgrid[:SIZE, :SIZE]
    errors = filtered(slope * (column + direction * row), 5.0)
    inner = errors[8:-8, 8:-8]
    assert rms(inner) < 0.6  # stairs of a width w have slope · w/√12: 3.5° for 2° over 6 pixels
    assert rms(errors) < 1.2  # by the edge windows are one-sided, in the first pass by slope · 3


def test_nothing_is_added_to_a_map_without_errors() -> None:
    row, column = np.mgrid[:SIZE, :SIZE]
    assert off(filtered_orientation(np.radians(STEP), 1e-3, WHOLE).orientation, STEP).max() < 0.01
    turning = 1.5 * column - 0.5 * row
    found = filtered_orientation(np.radians(turning), 1e-3, WHOLE).orientation
    assert off(found, turning)[24:-24, 24:-24].max() < 0.01


def test_masked_pixels_never_bleed() -> None:
    """Whatever they hold: the others come out the same to the bit, and they stay unknown."""
    rng = np.random.default_rng(6)
    mask = rng.random((SIZE, SIZE)) < 0.7
    mask[30:40] = False
    θ, σ = np.radians(STEP + 5 * NOISE), np.full((SIZE, SIZE), np.radians(5))
    found = []
    for value, known in ((0.0, 1e-3), (1.3, 1e3), (np.nan, np.nan)):
        orientation, uncertainty = np.where(mask, θ, value), np.where(mask, σ, known)
        found.append(filtered_orientation(orientation, uncertainty, mask, FilterOptions(range=0.3)))
    for other in found[1:]:
        np.testing.assert_array_equal(other.orientation, found[0].orientation)
        np.testing.assert_array_equal(other.uncertainty, found[0].uncertainty)
    np.testing.assert_array_equal(np.isnan(found[0].orientation), ~mask)
    np.testing.assert_array_equal(np.isnan(found[0].uncertainty), ~mask)


def test_pixels_that_are_not_a_number_are_as_good_as_masked() -> None:
    θ = np.radians(5 * NOISE)
    hole = np.zeros((SIZE, SIZE), bool)
    hole[10:14, 20:50] = True
    masked = filtered_orientation(θ, 0.1, ~hole)
    unknown = filtered_orientation(np.where(hole, np.nan, θ), 0.1, WHOLE)
    np.testing.assert_array_equal(unknown.orientation, masked.orientation)


def test_a_pixel_alone_stays_as_it_is() -> None:
    mask = np.zeros((9, 9), bool)
    mask[4, 4] = True
    found = filtered_orientation(np.full((9, 9), 3.0), 0.2, mask, FilterOptions(iterations=1))
    assert found.orientation[4, 4] == pytest.approx(3.0, abs=1e-6)
    assert found.uncertainty[4, 4] == pytest.approx(0.2, rel=1e-5)


def test_orientations_are_0_to_pi_and_wrap() -> None:
    """A foil at 0° whose noise goes both ways: its mean is not 90°, and turns by π say nothing."""
    noisy = np.radians(4 * NOISE)
    found = filtered_orientation(noisy, np.radians(4), WHOLE)
    assert np.all((found.orientation >= 0) & (found.orientation < np.pi))
    assert off(found.orientation, np.zeros(())).max() < 1.5
    turns = np.pi * np.random.default_rng(7).integers(-2, 3, (SIZE, SIZE))
    turned = filtered_orientation(noisy + turns, np.radians(4), WHOLE)
    assert off(turned.orientation, np.rad2deg(found.orientation)).max() < 0.01


def test_one_wrong_pixel_takes_its_neighbours_orientation() -> None:
    """The median stands for it, though it says of itself to be as good as any."""
    truth = np.full((SIZE, SIZE), 20.0)
    wrong = truth.copy()
    wrong[::9, ::9] = 75.0
    found = filtered_orientation(np.radians(wrong + 2 * NOISE), np.radians(2), WHOLE)
    assert off(found.orientation, truth).max() < 3


def test_what_is_known_better_weighs_more() -> None:
    """Half of all pixels are known ten times as well: the mean's error is then theirs alone."""
    good = np.random.default_rng(8).random((SIZE, SIZE)) < 0.5
    σ = np.radians(np.where(good, 1.0, 10.0))
    once = FilterOptions(iterations=1, range=1.0)
    found = filtered_orientation(σ * NOISE, σ, WHOLE, once)
    error = rms(off(found.orientation, np.zeros(()))[8:-8, 8:-8])
    # √(4π) · 3 = 10.6 of all pixels, 7.5 of the half; by equal weights it would be 7.1°/10.6.
    assert error == pytest.approx(1 / 7.5, rel=0.3)
    inner = rms(np.rad2deg(found.uncertainty[8:-8, 8:-8]))
    assert inner == pytest.approx(error, rel=0.2)


@pytest.mark.parametrize(("iterations", "least"), [(1, 0.55), (3, 0.7), (10, 0.75)])
def test_uncertainty_is_about_what_noise_leaves(iterations: int, least: float) -> None:
    """On a foil of one grating, away from its edges.

    Which values are averaged depends on the noise of the middle one, which is not counted: most
    after one pass.
    """
    σ, size = np.radians(5), 160
    errors, stated = [], []
    for seed in range(3):
        noise = np.random.default_rng(seed).standard_normal((size, size))
        options = FilterOptions(iterations=iterations)
        found = filtered_orientation(σ * noise, σ, np.ones((size, size), bool), options)
        errors.append(rms(off(found.orientation, np.zeros(()))[50:-50, 50:-50]))
        stated.append(rms(np.rad2deg(found.uncertainty[50:-50, 50:-50])))
    assert least < rms(np.array(stated)) / rms(np.array(errors)) < 1.1


def test_blocks_do_not_show(monkeypatch: pytest.MonkeyPatch) -> None:
    θ = np.radians(STEP + 5 * NOISE)
    options = FilterOptions(iterations=3)
    whole = filtered_orientation(θ, 0.09, WHOLE, options)
    monkeypatch.setattr(orientation_filter, "BLOCK", 7 * SIZE)
    monkeypatch.setattr(orientation_filter, "BLOCK_ROWS", 1)
    monkeypatch.setattr(orientation_filter, "STRIP", 3 * SIZE)
    parted = filtered_orientation(θ, 0.09, WHOLE, options)
    np.testing.assert_allclose(parted.orientation, whole.orientation, atol=2e-5)
    np.testing.assert_allclose(parted.uncertainty, whole.uncertainty, rtol=1e-3)


def test_a_map_turned_by_a_quarter_is_filtered_alike() -> None:
    θ = np.radians(STEP + 5 * NOISE)
    upright = filtered_orientation(θ, 0.09, WHOLE).orientation
    turned = filtered_orientation(np.rot90(θ), 0.09, WHOLE).orientation
    assert off(np.rot90(turned, -1), np.rad2deg(upright)).max() < 0.05


def test_bad_input_is_refused() -> None:
    θ = np.zeros((4, 5))
    on = np.ones((4, 5), bool)
    name = "orientation filter"
    with refused(name, "mask", (5, 4), "as the others"):
        filtered_orientation(θ, 0.1, on.T)
    with refused(name, "uncertainty", (5,), "(4, 5)"):
        filtered_orientation(θ, np.ones(5), on)
    with refused(name, "uncertainty", 0.0, "above 0"):
        filtered_orientation(θ, 0.0, on)
    with refused(name, "spatial", 0.0, "a number from 0.3"):
        FilterOptions(spatial=0.0)
    with refused(name, "range", np.nan, "a number from 0.001"):
        FilterOptions(range=np.nan)
    with refused(name, "deviations", -1.0, "a number from 0"):
        FilterOptions(deviations=-1.0)
    with refused(name, "iterations", -1, "a number from 0"):
        FilterOptions(iterations=-1)
