"""Distributions of gratings from photographs that are reckoned point by point."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.special import jv

from precompute.acquisition.capture import Camera, read_capture
from precompute.acquisition.densities import Lobes, MeanLight, log_likelihood
from precompute.acquisition.observations import Shot, half_vectors
from precompute.acquisition.pattern import Gratings
from precompute.acquisition.radiance import ALIKE, MANY, Lamp, Relief, foil_radiance
from precompute.acquisition.rectification import Rectification
from precompute.acquisition.shots import ROUGHNESS
from precompute.acquisition.simulate import simulate_flash
from precompute.acquisition.stochastic import SEEN, Estimated, estimate_distribution
from precompute.acquisition.stochastic_report import StochasticReport, acquire_stochastic
from precompute.acquisition.transport import distribution_distance
from precompute.acquisition.view import View
from precompute.errors import InputError
from precompute.foils.distribution import GratingDistribution
from precompute.foils.stochastic import design_from_file
from precompute.profiles import Sinusoidal
from precompute.spectra import WAVELENGTHS

Array = NDArray[np.float64]

SIZE_MM = (160.0, 130.0)
SIZE_PX = (320, 260)
LAMP = np.array([3.0, -4.0, 150.0])
RADIUS = np.radians(0.7)
GREEN = np.exp(-4 * np.log(2) * ((WAVELENGTHS - 0.53) / 0.03) ** 2)[:, None]


def clouds(*middles: tuple[float, float, float]) -> GratingDistribution:
    """Gaussian clouds of share, orientation in degrees and period in µm; 4° and 2 % wide."""
    θ_edges, f_edges = np.linspace(0, np.pi, 181), np.linspace(0.3, 1.0, 281)
    θ, f = ((edges[1:] + edges[:-1]) / 2 for edges in (θ_edges, f_edges))
    weights = np.zeros((180, 280))
    for share, degrees, period in middles:
        turn = np.mod(np.degrees(θ) - degrees + 90, 180) - 90
        cloud = np.exp(-(turn[:, None] ** 2) / (2 * 4**2))
        cloud = cloud * np.exp(-((f * period - 1) ** 2) / (2 * 0.02**2))
        weights += share * cloud / cloud.sum()
    return GratingDistribution(θ_edges, f_edges, weights)


def photograph(distribution: GratingDistribution, haze: float = 0.05) -> Shot:
    """Each pixel shows a grating of its own, its lobes as Gaussians in the plane of (u, v)."""
    rng = np.random.default_rng(5)
    camera = Camera(position_mm=(0, 0, 500), focal_px=960, channels="grey")
    rectification = Rectification.of_view(View.of(camera, SIZE_PX))
    x, y = np.meshgrid(np.arange(SIZE_PX[0]), np.arange(SIZE_PX[1]))
    points = rectification.on_sample(np.stack([x.ravel(), y.ravel()], axis=1).astype(np.float64))
    h, irradiance = half_vectors(points, rectification.eye, LAMP)
    θ, f = distribution.sample(rng, len(points))
    lit = np.flatnonzero(GREEN[:, 0] > 1e-3)[::3]
    radiance = np.full(len(points), haze)
    for index in lit:
        λ = WAVELENGTHS[index]
        variance = RADIUS**2 + (1.9 * ROUGHNESS) ** 2 + (λ / (np.sqrt(8) * np.pi * 16.25)) ** 2
        for m in (-3, -2, -1, 1, 2, 3):
            efficiency = jv(m, np.pi * 1.9 * 0.15 / λ) ** 2
            middle = m * λ * f[:, None] * np.stack([np.cos(θ), np.sin(θ)], axis=1)
            apart = np.sum((h[:, :2] - middle) ** 2, axis=1)
            lobe = np.exp(-apart / (2 * variance)) / (2 * np.pi * variance)
            radiance += 3e-3 * GREEN[index, 0] * efficiency * lobe
    values = radiance * irradiance + 0.002 * rng.standard_normal(len(points))
    shape = (SIZE_PX[1], SIZE_PX[0])
    return Shot(
        "made.tif",
        values.reshape(*shape, 1).astype(np.float32),
        np.ones(shape, bool),
        rectification,
        LAMP,
        RADIUS,
        GREEN,
        np.zeros(1, np.float32),
    )


def share_near(distribution: GratingDistribution, degrees: float, period: float) -> float:
    """Within 20° and 10 % of a grating."""
    turn = np.mod(np.degrees(distribution.orientations) - degrees + 90, 180) - 90
    near = np.abs(turn)[:, None] < 20
    return float(
        distribution.weights[near & (np.abs(distribution.frequencies * period - 1) < 0.1)].sum()
    )


@pytest.fixture(scope="module")
def coarse_and_fine() -> tuple[GratingDistribution, Shot]:
    # Order 2 of the first lies where a period of 1.2 would be.
    true = clouds((0.5, 20, 2.4), (0.5, 75, 1.35))
    return true, photograph(true)


@pytest.fixture(scope="module")
def whole(coarse_and_fine: tuple[GratingDistribution, Shot]) -> Estimated:
    return estimate_distribution([coarse_and_fine[1]], SIZE_MM)


def test_orientations_periods_and_shares_are_found(
    coarse_and_fine: tuple[GratingDistribution, Shot], whole: Estimated
) -> None:
    true, found = coarse_and_fine[0], whole.distribution
    assert distribution_distance(true, found) < 0.06
    mirrored = GratingDistribution(
        found.orientation_edges, found.frequency_edges, found.weights[::-1]
    )
    assert distribution_distance(true, mirrored) > 0.4
    # Equal areas, though the finer ones' ring is 1.8 times as long and fainter by as much.
    assert share_near(found, 20, 2.4) == pytest.approx(0.5, abs=0.05)
    assert share_near(found, 75, 1.35) == pytest.approx(0.5, abs=0.05)


def test_the_second_order_is_no_period_of_half_the_length(
    coarse_and_fine: tuple[GratingDistribution, Shot],
    whole: Estimated,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    _, shot = coarse_and_fine
    monkeypatch.setattr("precompute.acquisition.stochastic.LIT", 0.05)
    seed = estimate_distribution([shot], SIZE_MM, method="threshold").distribution
    assert share_near(whole.distribution, 20, 1.2) < 0.01
    assert share_near(seed, 20, 1.2) > 0.05


def test_lobes_are_narrower_than_what_they_light(
    coarse_and_fine: tuple[GratingDistribution, Shot], whole: Estimated
) -> None:
    true, shot = coarse_and_fine

    def turn_spread(one: GratingDistribution) -> float:
        turn = np.mod(np.degrees(one.orientations) - 20 + 90, 180) - 90
        near = (np.abs(turn) < 25)[:, None] & (np.abs(one.frequencies * 2.4 - 1) < 0.15)
        share = np.where(near, one.weights, 0).sum(axis=1)
        return float(np.sqrt(np.average(turn**2, weights=share)))

    seed = estimate_distribution([shot], SIZE_MM, method="threshold").distribution
    assert turn_spread(true) == pytest.approx(4, rel=0.05)
    assert turn_spread(whole.distribution) < 5.5  # with the blur of up to 2° after each step
    assert turn_spread(seed) > 5.5


def test_what_is_out_of_the_picture_is_not_said_to_be_absent(
    coarse_and_fine: tuple[GratingDistribution, Shot], whole: Estimated
) -> None:
    _, shot = coarse_and_fine
    right = np.indices(shot.usable.shape)[1] > SIZE_PX[0] * 0.75
    estimated = estimate_distribution([replace(shot, usable=shot.usable & ~right)], SIZE_MM)
    assert estimated.covered < whole.covered < 1
    assert not estimated.distribution.weights[estimated.seen < SEEN].any()
    # The other side of the highlight shows the same.
    row = np.searchsorted(estimated.distribution.orientation_edges, 0.02) - 1
    column = np.searchsorted(estimated.distribution.frequency_edges, 0.7) - 1
    assert estimated.seen[row, column] == pytest.approx(whole.seen[row, column], abs=0.1)


def test_other_points_are_foretold_best_by_the_shares_they_were_drawn_from() -> None:
    middles = np.arange(0.3, 1.0, 0.01)
    lobes = Lobes(GREEN[:, 0], 0.0135, middles, 0.15, 90)
    rng = np.random.default_rng(6)
    true = rng.random((90, len(middles))) * 1e-3
    shown = lobes.shown(true)
    light = MeanLight(shown * 10, np.full(shown.shape, 10.0))

    def foretold(shares: Array) -> float:
        return log_likelihood([lobes], [light], [0.01], shares)

    assert all(foretold(true) > foretold(wrong) for wrong in (true * 1.1, true * 0.9, true[::-1]))


def test_white_light_is_refused(coarse_and_fine: tuple[GratingDistribution, Shot]) -> None:
    shot = replace(coarse_and_fine[1], weights=np.ones((401, 1)))
    with pytest.raises(InputError, match=r"made\.tif: filter = 'light of 580 ± 116 nm'"):
        estimate_distribution([shot], SIZE_MM)


@pytest.mark.parametrize("light", [0.0, 0.3])
def test_paper_and_darkness_are_refused(
    light: float, coarse_and_fine: tuple[GratingDistribution, Shot]
) -> None:
    shot = coarse_and_fine[1]
    noise = 0.01 * np.random.default_rng(1).standard_normal(shot.values.shape)
    even = replace(shot, values=(light + noise).astype(np.float32))
    with pytest.raises(InputError, match="expected lit gratings that stand out"):
        estimate_distribution([even], SIZE_MM)


def test_many_frequencies_are_rounded_and_few_are_not() -> None:
    rng = np.random.default_rng(3)
    points = rng.uniform(-60, 60, (400, 2))
    relief = Relief(0.15, Sinusoidal(), 16.25, float(ROUGHNESS))
    lamp = Lamp(LAMP, float(RADIUS), np.where(GREEN > 0.01, GREEN, 0))
    eye = np.array([0.0, 0.0, 500.0])
    ones = np.ones(len(points))

    def shown(frequency: Array) -> Array:
        gratings = Gratings(0.7 * ones, frequency, ones)
        return foil_radiance(points, np.zeros_like(points), gratings, relief, eye, lamp, 5)

    many = 0.6 * np.exp(rng.uniform(-1, 1, len(points)) * ALIKE * MANY)
    rounded = np.exp(ALIKE * np.round(np.log(many) / ALIKE))
    assert len(np.unique(rounded)) > MANY
    # Forty at a time are few enough to be taken as they are.
    groups = range(0, len(points), 40)
    few = [shown(np.resize(rounded[i : i + 40], len(points)))[i : i + 40] for i in groups]
    assert shown(many) == pytest.approx(np.concatenate(few), rel=1e-9)
    single = np.full(len(points), 0.6025)
    assert not np.allclose(shown(single), shown(np.exp(ALIKE * np.round(np.log(single) / ALIKE))))


def test_from_a_capture_to_a_design(tmp_path: Path) -> None:
    root = Path(__file__).parents[2] / "maps" / "captures"
    recipe = json.loads((root / "flash-spiral.json").read_text("utf-8"))
    recipe["foil"] = str((root / recipe["foil"]).resolve())
    recipe["size_px"] = [200, 160]
    recipe["camera"]["focal_px"] = 600
    (tmp_path / "small.json").write_text(json.dumps(recipe), "utf-8")
    file = simulate_flash(tmp_path / "small.json", tmp_path)
    capture = read_capture(file, "flash")
    assert capture.sample.stochastic and capture.sample.tile_mm is None
    said: list[str] = []
    files = acquire_stochastic(capture, file.parent, tmp_path / "found", said.append)
    assert [one.name for one in files] == ["found.json", "found.report.json"]
    report = StochasticReport.model_validate_json(files[1].read_text("utf-8"))
    assert 0.5 < report.covered < 1
    assert report.periods_um[1] == pytest.approx(1.8, abs=0.15)  # of 1.2 to 2.4 evenly
    foil = design_from_file(files[0], {"shape": "squares", "size": 64, "tile_mm": 10.0})
    frequency = foil.tables["grating"].values[..., 2]
    assert np.median(1 / frequency) == pytest.approx(1.8, abs=0.15)
