"""Distributions of gratings: drawn from, measured, stored; and the one that draws a spiral."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from refusals import refused
from scipy.stats import chi2

from precompute.foils.distribution import GratingDistribution
from precompute.foils.recipe import SpiralDistribution
from precompute.foils.spiral import spiral

SAMPLES = 20000


def example() -> GratingDistribution:
    """Cells of unequal size, one of them empty, from −20° to 150°."""
    orientation_edges = np.deg2rad([-20, 10, 40, 90, 150])
    frequency_edges = np.array([0.4, 0.5, 0.55, 0.8])
    weights = np.array([[1, 2, 3], [4, 0, 2], [5, 1, 1], [2, 6, 3]])
    return GratingDistribution(orientation_edges, frequency_edges, weights)


def chi_square(counts: np.ndarray, expected: np.ndarray) -> tuple[float, float]:
    """χ² of counts, and what it stays below 999 times of 1000 where they are as expected."""
    some = expected > 0
    assert not counts[~some].any()
    statistic = np.sum((counts[some] - expected[some]) ** 2 / expected[some])
    return float(statistic), float(chi2.ppf(0.999, np.count_nonzero(some) - 1))


def test_weights_are_shares() -> None:
    made = example()
    assert made.weights == pytest.approx(
        np.array([[1, 2, 3], [4, 0, 2], [5, 1, 1], [2, 6, 3]]) / 30
    )
    assert np.rad2deg(made.orientations) == pytest.approx([-5, 25, 65, 120])
    assert made.frequencies == pytest.approx([0.45, 0.525, 0.675])


def test_samples_follow_the_distribution() -> None:
    made = example()
    θ, f = made.sample(np.random.default_rng(5), SAMPLES)
    counts = made.histogram_of(θ, f) * SAMPLES
    statistic, limit = chi_square(counts, made.weights * SAMPLES)
    assert statistic < limit
    # A distribution that is wrong by one cell in twelve, a share of 0.03 moved.
    wrong = made.weights.copy()
    wrong[0, 0] -= 0.03
    wrong[3, 2] += 0.03
    assert chi_square(counts, wrong * SAMPLES)[0] > 3 * limit


def test_samples_fill_their_cells_evenly() -> None:
    made = example()
    θ, f = made.sample(np.random.default_rng(6), SAMPLES)
    for values, edges in ((θ, made.orientation_edges), (f, made.frequency_edges)):
        cell = np.searchsorted(edges, values) - 1
        within = (values - edges[cell]) / np.diff(edges)[cell]
        counts, _ = np.histogram(within, 10, (0, 1))
        statistic, limit = chi_square(counts, np.full(10, SAMPLES / 10))
        assert statistic < limit


def test_a_histogram_counts_modulo_π_and_by_weight() -> None:
    made = example()
    θ = np.deg2rad([-20 + 180, 30 - 360, 100, 155, 100])  # the fourth is outside
    f = np.array([0.45, 0.6, 0.52, 0.52, 0.9])  # and so is the fifth
    found = made.histogram_of(θ, f, [1, 2, 4, 8, 1])
    expected = np.zeros((4, 3))
    expected[0, 0], expected[1, 2], expected[3, 1] = 1 / 16, 2 / 16, 4 / 16
    assert found == pytest.approx(expected)


def test_it_comes_back_from_its_file(tmp_path: Path) -> None:
    made = example()
    made.write(tmp_path / "new" / "d.json")
    read = GratingDistribution.read(tmp_path / "new" / "d.json")
    assert np.array_equal(read.orientation_edges, made.orientation_edges)
    assert np.array_equal(read.frequency_edges, made.frequency_edges)
    assert read.weights == pytest.approx(made.weights, rel=1e-15)


@pytest.mark.parametrize(
    ("change", "field", "value", "expected"),
    [
        ({"weights": [[1, -2], [0, 1]]}, "weights", -2.0, "from 0"),
        ({"weights": [[0, 0], [0, 0]]}, "weights", 0.0, "above 0"),
        ({"weights": [[1, 2]]}, "weights", (1, 2), "the shape (2, 2)"),
        ({"weights": [[1, 2], [3]]}, "weights", [1, 2], "rows of one length"),
        ({"weights": [[1, 2, 3], [4, 5, 6]]}, "weights", (2, 3), "the shape (2, 2)"),
        ({"weights": [[1, "x"], [3, 4]]}, "weights.0.1", "x", "a valid number"),
        ({"weights": [[1, float("nan")], [3, 4]]}, "weights.0.1", float("nan"), "finite"),
        ({"weights": []}, "weights", (0,), "the shape (2, 2)"),
        ({"frequency_edges": [0, 0.5, 1]}, "frequency_edges", 0.0, "above 0"),
        ({"frequency_edges": [0.5]}, "frequency_edges", (1,), "two edges"),
        ({"frequency_edges": [0.5, 0.5, 1]}, "frequency_edges", [0.5, 0.5, 1.0], "rise"),
        ({"orientation_edges": [0, 2, 1]}, "orientation_edges", [0.0, 2.0, 1.0], "rise"),
        ({"orientation_edges": [0, 1, 4]}, "orientation_edges", 4.0, "a span of pi"),
        ({"version": 2}, "version", 2, "1"),
        ({"wieghts": []}, "wieghts", [], "no such field"),
    ],
)
def test_what_is_no_distribution_is_refused(
    tmp_path: Path, change: dict[str, Any], field: str, value: object, expected: str
) -> None:
    contents = {
        "format": "three-diffraction/grating-distribution",
        "version": 1,
        "orientation_edges": [0, 1, 3],
        "frequency_edges": [0.4, 0.5, 0.8],
        "weights": [[1, 2], [3, 4]],
    }
    file = tmp_path / "d.json"
    file.write_text(json.dumps(contents))
    assert GratingDistribution.read(file).weights.sum() == pytest.approx(1)
    file.write_text(json.dumps(contents | change))
    with refused(file, field, value, expected):
        GratingDistribution.read(file)


def test_files_that_hold_no_distribution_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "d.json"
    problem = f"[Errno 2] No such file or directory: '{file}'"
    with refused(file, "contents", problem, "a readable file"):
        GratingDistribution.read(file)
    file.write_text('{"version": 1}')
    with refused(file, "format", None, "a value; the field is missing"):
        GratingDistribution.read(file)


def test_periods_of_a_spiral_grow_over_the_half_turn() -> None:
    made = spiral(SpiralDistribution(kind="spiral", shortest=1.0, longest=2.0, spread=0.03))
    assert made.weights.sum(axis=1) == pytest.approx(np.full(90, 1 / 90), rel=1e-3)
    θ, f = made.sample(np.random.default_rng(8), 200_000)
    expected = 1 + θ / np.pi
    off = 1 / f / expected - 1
    # The spread, with the cells' own: 2° and 1/96 of the frequencies' range.
    assert off.mean() == pytest.approx(0, abs=5e-4)
    assert off.std() == pytest.approx(0.03, rel=0.03)
    counts, edges = np.histogram(off / 0.03, np.arange(-3, 3.1, 0.5))
    gauss = np.exp(-((edges[:-1] + 0.25) ** 2) / 2) * 0.5 / np.sqrt(2 * np.pi)
    assert counts / θ.size == pytest.approx(gauss, abs=0.012)
