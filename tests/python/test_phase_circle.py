"""The circle of modulations: found whatever orientations there are, or said to be unknown."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import ArrayLike

from precompute.acquisition.jones import Plastic, global_offset, intensity, reflected
from precompute.acquisition.phase_circle import PhaseCircle, centred, modulations, phase_circle
from precompute.acquisition.polarization_fit import (
    HarmonicFit,
    Harmonics,
    fitted,
    photograph_means,
)

CENTRE, RADIUS = 0.03 - 0.05j, 0.2


def on_circle(degrees: ArrayLike) -> np.ndarray:
    return CENTRE + RADIUS * np.exp(1j * np.deg2rad(degrees))


def found(circle: PhaseCircle, error: float) -> None:
    assert circle.known
    assert abs(circle.centre - CENTRE) < error
    assert circle.radius == pytest.approx(RADIUS, abs=error)


@pytest.mark.parametrize(
    "degrees", [[0, 100, 220], np.arange(360), np.arange(150), [10, 20, 30, 90, 170]], ids=str
)
def test_points_on_a_circle_give_it(degrees: ArrayLike) -> None:
    circle = phase_circle(np.repeat(on_circle(degrees), 200))
    found(circle, 1e-12)
    assert circle.scatter < 1e-12


def test_noise_moves_the_centre_by_its_mean_only() -> None:
    """Two thirds of all points in a tenth of the turn: the circle stays, their mean does not."""
    rng = np.random.default_rng(8)
    degrees = np.concatenate([rng.uniform(0, 36, 40000), rng.uniform(0, 360, 20000)])
    noise = 0.02 * (rng.standard_normal(60000) + 1j * rng.standard_normal(60000))
    points = on_circle(degrees) + noise
    circle = phase_circle(points, 0.02)
    # Taubin's bias is of the order of σ²/r = 0.002; what the mean is off is 0.13.
    found(circle, 0.003)
    assert circle.scatter == pytest.approx(0.02, rel=0.05)
    assert abs(points.mean() - CENTRE) > 0.1


@pytest.mark.parametrize(
    ("arc", "bare", "strewn", "σ"),
    [(200, 0.3, 0, 0.01), (200, 0.7, 0, 0.01), (200, 0.7, 0.1, 0.01), (120, 0, 0.1, 0.004)],
)
def test_bare_pixels_in_the_middle_and_others_anywhere(
    arc: float, bare: float, strewn: float, σ: float
) -> None:
    rng = np.random.default_rng(9)
    counts = np.round(20000 * np.array([1 - bare - strewn, bare, strewn])).astype(int)
    points = np.concatenate(
        [
            on_circle(rng.uniform(0, arc, counts[0])),
            np.full(counts[1], CENTRE),
            0.6 * (rng.standard_normal(counts[2]) + 1j * rng.standard_normal(counts[2])),
        ]
    )
    noise = σ * (rng.standard_normal(points.size) + 1j * rng.standard_normal(points.size))
    found(phase_circle(points + noise, σ), 0.01)


def noisy(points: np.ndarray, σ: float) -> np.ndarray:
    rng = np.random.default_rng(11)
    return points + σ * (rng.standard_normal(points.size) + 1j * rng.standard_normal(points.size))


@pytest.mark.parametrize("ground", [CENTRE, CENTRE - 0.06])
@pytest.mark.parametrize("degrees", [np.arange(0, 360, 60), np.arange(360)], ids=len)
@pytest.mark.parametrize(("lit", "σ"), [(0.12, 0.002), (0.12, 0.02), (0.03, 0.02)])
def test_few_that_lie_on_it(ground: complex, degrees: ArrayLike, lit: float, σ: float) -> None:
    """Bare mirrors in the middle, or matt ground beside it, have most of all pixels."""
    on = np.resize(on_circle(degrees), round(20000 * lit))
    points = np.concatenate([on, np.full(20000 - on.size, ground)])
    circle = phase_circle(noisy(points, σ), σ)
    # Of 490 pixels σ·√(2/490) each way, 0.0013; three of that.
    found(circle, 0.004)


@pytest.mark.parametrize("worse", [1.0, 1.5, 4.0])
def test_a_cluster_alone_is_no_circle(worse: float) -> None:
    """Also where its noise is more than was said."""
    circle = phase_circle(noisy(np.full(20000, CENTRE), worse * 0.02), 0.02)
    assert not circle.known and circle.centre == 0


def test_two_orientations_about_bare_pixels() -> None:
    """Three clusters: the circle through them has another centre, but most are bare."""
    points = np.concatenate([np.repeat(on_circle([10, 130]), 1000), np.full(8000, CENTRE)])
    found(phase_circle(noisy(points, 0.01), 0.01), 0.002)


def test_two_orientations_on_matt_ground_tell_nothing() -> None:
    """They may be three orientations as well."""
    points = np.concatenate([np.repeat(on_circle([10, 100]), 1000), np.full(8000, CENTRE - 0.06)])
    assert not phase_circle(noisy(points, 0.005), 0.005).known


@pytest.mark.parametrize("degrees", [[], [40], [40, 40, 40, 40], [0, 90, 0, 90], [50, 51, 52]])
def test_too_few_orientations_tell_no_circle(degrees: list[float]) -> None:
    """Then centre 0, as where nothing is known of the mirror's light."""
    circle = phase_circle(np.repeat(on_circle(degrees) + 0j, 200))
    assert not circle.known and circle.centre == 0
    if degrees:
        assert circle.radius == pytest.approx(np.abs(on_circle(degrees)).mean())


def test_unknown_pixels_and_dark_ones_are_left_out() -> None:
    one = np.array([0.5, 0.5, 0.5, np.nan], np.float32)
    fit = HarmonicFit(
        phase=np.array([0, np.pi / 2, 1, 2], np.float32),
        amplitude=one,
        mean=np.array([2, 1, 0, 1], np.float32),
        residual=one,
        correlation=one,
    )
    points = modulations(fit)
    assert points[:2] == pytest.approx(np.array([0.25, 0.5j]), abs=1e-7)
    assert np.isnan(points[2:]).all()
    moved = centred(fit, PhaseCircle(0.25 + 0.25j, 1.0, 0.0, True))
    assert moved.phase[:2] == pytest.approx(np.array([-np.pi / 2, np.deg2rad(135)]), abs=1e-6)
    assert moved.amplitude[:2] == pytest.approx(
        np.array([0.25 * 2, np.hypot(0.25, 0.25)]), abs=1e-6
    )
    many = np.concatenate([on_circle(np.arange(360)), [np.nan + 0j] * 100])
    found(phase_circle(many), 1e-12)


def test_uneven_orientations_under_retarding_plastic() -> None:
    """Photographs over their means, of gratings of six orientations of which one covers half."""
    ratio = 1.05 * np.exp(1j * np.deg2rad(168))
    plastic = Plastic(np.deg2rad(3), np.deg2rad(25), -0.19)
    ψ = np.arange(9) * np.deg2rad(19)
    θ = np.deg2rad(np.repeat([0.0, 20, 50, 90, 130, 150], [50, 10, 10, 10, 10, 10]))[None]
    bright = np.linspace(0.3, 1, 100)
    x, y = reflected(θ, ratio, plastic)
    photographs = np.stack([bright * intensity((x, y), a) for a in ψ]).astype(np.float32)
    means = photograph_means(photographs, np.ones((1, 100), bool))
    fit = fitted(photographs, Harmonics.of(ψ, means))

    def worst(of: HarmonicFit) -> float:
        turn = of.phase - 2 * (θ - global_offset(ratio, plastic))
        return float(np.rad2deg(np.abs(np.angle(np.exp(1j * turn))).max() / 2))

    circle = phase_circle(modulations(fit))
    assert circle.known
    assert worst(fit) > 10
    assert worst(centred(fit, circle)) < 1
