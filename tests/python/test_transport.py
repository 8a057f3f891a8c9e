"""Earth mover's distances against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from precompute.acquisition.transport import (
    LOG_STEP,
    ORIENTATIONS,
    distribution_distance,
    earth_movers_distance,
    picture_distance,
)
from precompute.foils.distribution import GratingDistribution

TURNS = np.linspace(0, np.pi, ORIENTATIONS + 1)
FREQUENCIES = np.exp(LOG_STEP * np.arange(-20, 1))


def single(row: int, column: int) -> GratingDistribution:
    """All gratings in one cell of those in which distributions are compared."""
    weights = np.zeros((ORIENTATIONS, len(FREQUENCIES) - 1))
    weights[row, column] = 1
    return GratingDistribution(TURNS, FREQUENCIES, weights)


def test_on_a_line_it_is_the_area_between_the_cumulative_shares() -> None:
    rng = np.random.default_rng(1)
    first, second = rng.random((2, 40))
    first, second = first / first.sum(), second / second.sum()
    line = np.abs(np.subtract.outer(np.arange(40.0), np.arange(40.0)))
    expected = np.abs(np.cumsum(first - second)).sum()
    assert earth_movers_distance(first, second, line) == pytest.approx(expected, rel=1e-6)
    assert earth_movers_distance(second, first, line) == pytest.approx(expected, rel=1e-6)
    assert earth_movers_distance(first, first, line) == 0


def test_the_shorter_way_around_half_a_turn() -> None:
    step = np.pi / ORIENTATIONS
    assert distribution_distance(single(1, 5), single(ORIENTATIONS - 1, 5)) == pytest.approx(
        2 * step
    )
    half = ORIENTATIONS // 2
    assert distribution_distance(single(0, 5), single(half, 5)) == pytest.approx(half * step)


def test_period_and_angle_add_as_sides_of_a_right_triangle() -> None:
    expected = np.hypot(3 * np.pi / ORIENTATIONS, 4 * LOG_STEP)
    assert distribution_distance(single(2, 3), single(5, 7)) == pytest.approx(expected)


def test_edges_elsewhere_are_the_same_distribution() -> None:
    one = single(0, 5)
    turned = GratingDistribution(TURNS - np.pi / 2, FREQUENCIES, np.roll(one.weights, 18, axis=0))
    assert distribution_distance(one, turned) == pytest.approx(0, abs=1e-9)
    # Twice as fine a histogram of the same.
    finer = GratingDistribution(
        np.linspace(0, np.pi, 2 * ORIENTATIONS + 1),
        FREQUENCIES,
        np.repeat(one.weights, 2, axis=0),
    )
    assert distribution_distance(one, finer) == pytest.approx(0, abs=1e-9)


def test_light_that_moves_together_moves_by_its_shift() -> None:
    rng = np.random.default_rng(2)
    picture = np.zeros((8, 12))
    picture[1:4, 1:5] = rng.random((3, 4))
    moved = np.roll(picture, (3, 4), axis=(0, 1))
    assert picture_distance(picture, 7 * moved, 2.0) == pytest.approx(2 * 5, rel=1e-6)
