"""How maps acquired in polarised light are held against what was photographed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from precompute.acquisition.capture import Camera
from precompute.acquisition.orientation_filter import FilterOptions
from precompute.foils.foil_map import foil_map
from precompute.maps import Map
from precompute.report.filtered_foils import step_wear
from precompute.report.map_errors import MapErrors
from precompute.report.polarized_foils import crossing
from precompute.report.polarized_photographs import PolarizedPhotographs

RECIPE = {"kind": "foil", "profile": "sinusoidal"}


def foil(orientation: np.ndarray, period: float, strength: np.ndarray) -> Map:
    return foil_map(orientation, 1 / period, strength, height=0.15, tile_mm=10.0, recipe=RECIPE)


def test_planted_errors_are_found() -> None:
    """Two texels of the map to one of the truth, whose right half is bare."""
    rng = np.random.default_rng(1)
    θ = rng.uniform(0, np.pi, (6, 8))
    diffracts = np.repeat([[1.0, 0.0]], 4, axis=1) * np.ones((6, 1))
    twice = np.repeat(np.repeat(θ, 2, axis=0), 2, axis=1)
    found = foil(twice + np.radians(179), 1.02, np.ones(twice.shape))  # 1° back, modulo 180°
    errors = MapErrors.of(found, foil(θ, 1.0, diffracts))
    assert errors.diffracts.reshape(12, 16).tolist() == [[True] * 8 + [False] * 8] * 12
    np.testing.assert_allclose(errors.orientation, 1, atol=0.4)  # 8 bits a channel
    np.testing.assert_allclose(errors.period, 0.02, atol=1e-3)
    np.testing.assert_allclose(errors.periods, 1.02, atol=1e-3)
    mirrored = foil(twice[:, ::-1], 1.0, np.ones(twice.shape))
    assert MapErrors.of(mirrored, foil(θ, 1.0, diffracts)).orientation.mean() > 20


@pytest.mark.parametrize("level, place", [(2, 2.0), (1, None), (33, None)])
def test_where_errors_reach_a_level(level: float, place: float | None) -> None:
    assert crossing([2, 4], [2, 32], level) == place


def test_a_filter_that_wears_steps_is_caught() -> None:
    ours = step_wear(FilterOptions())
    worn = step_wear(FilterOptions(range=0.35, deviations=0))
    assert list(ours) == [1, 3, 10, 50]
    assert max(ours.values()) <= 2
    # The constant width mixes what lies within the window, 6 px, and passes add up.
    assert 2 < worn[3] < worn[10] < worn[50]


def test_a_capture_with_other_noise_and_angles(tmp_path: Path) -> None:
    camera = Camera(position_mm=(-30, 0, 500), focal_px=3200, channels="grey", black=256)
    taken = PolarizedPhotographs.of(
        "polygons",
        tmp_path,
        noise=0.02,
        polariser_deg=(0.0, 45.0, 90.0, 135.0),
        camera=camera,
        size_px=(192, 192),
    )
    assert taken.photographs == 4
    assert taken.noise_db == pytest.approx(33.98, abs=0.01)
    assert taken.periods == pytest.approx((1.66, 1.66), rel=0.005)
    right, wrong = (
        taken.off(taken.acquired(offset=taken.offset + np.radians(turn))).mean() for turn in (0, 20)
    )
    assert right < 5
    assert wrong == pytest.approx(20, abs=5)
