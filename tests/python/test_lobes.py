"""Tables of lobes, and the periods that a sample shows on average."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import jv

from precompute.acquisition.lobes import (
    MEAN_W,
    RADIUS_STEP,
    LobeTable,
    at_radius,
    lobe_deviation,
)
from precompute.acquisition.observations import Strip
from precompute.acquisition.periods import (
    MeanProfile,
    brightness,
    frequency_shares,
)
from precompute.gratings import Grating
from precompute.reference import weighted_brdf
from precompute.spectra import WAVELENGTHS

HEIGHT = 0.15
ALPHA = np.radians(0.7)
PEAKS = (0.46, 0.54, 0.61)
"""Of three channels, each a Gaussian of 0.03 µm."""


def channels(*peaks: float, width: float = 0.03) -> np.ndarray:
    return np.exp(-((WAVELENGTHS[:, None] - np.array(peaks)) ** 2) / (2 * width**2))


# ---- Lobes ---------------------------------------------------------------------------------------


def test_a_lobes_width_is_of_light_surface_and_window() -> None:
    window = 0.55 / (np.sqrt(8) * np.pi * 16.25)
    assert lobe_deviation(0.0, 0.0) == pytest.approx(window)
    assert lobe_deviation(ALPHA, 0.0) == pytest.approx(np.hypot(ALPHA, window))
    tilt = np.radians(0.3)
    assert lobe_deviation(0.0, tilt, 1e9) == pytest.approx(MEAN_W * tilt)


def test_a_narrow_channel_has_its_orders_at_mλ_over_a() -> None:
    """Each order's integral along ρ, times √2π c across, is J_m²(πwh/λ) ∫ W dλ."""
    frequency, λ = np.array([0.5, 1 / 1.66]), 0.55
    weights = channels(λ, width=0.001)
    c = 0.012
    table = LobeTable.of(weights, c, frequency, HEIGHT)
    ρ = np.arange(table.values.shape[1]) * RADIUS_STEP
    light = 0.001 * weights.sum()
    for f, profile in zip(frequency, table.values[..., 0], strict=True):
        for m in (1, 2, 3):
            near = np.abs(ρ - m * λ * f) < 6 * c
            power = RADIUS_STEP * profile[near].sum() * np.sqrt(2 * np.pi) * c
            η = jv(m, np.pi * MEAN_W * HEIGHT / λ) ** 2
            assert power == pytest.approx(light * η, rel=1e-3)
            middle = profile[near] @ ρ[near] / profile[near].sum()
            assert middle == pytest.approx(m * λ * f, abs=2e-5)
            spread = np.sqrt(profile[near] @ (ρ[near] - middle) ** 2 / profile[near].sum())
            assert spread == pytest.approx(c, rel=0.02)


@pytest.mark.parametrize("period", [1.2, 1.66, 2.4])
def test_a_table_is_what_the_reference_shows(period: float) -> None:
    """Along the grating's vector, in Kirchhoff's energy with its factor taken off, at w = 1.9.

    What is left is that the table's lobes are round, where a source seen at up to 27° is narrower
    by a tenth, of one width for all wavelengths, and do not interfere.
    """
    weights = channels(*PEAKS)
    grating = Grating(period=period, height=HEIGHT, energy="kirchhoff")
    c = lobe_deviation(ALPHA, 0.0)
    table = LobeTable.of(weights, c, np.array([1 / period]), HEIGHT)
    ρ = np.arange(0.12, 0.62, RADIUS_STEP)
    z = np.full_like(ρ, MEAN_W / 2)
    y = np.sqrt(1 - z**2 - (ρ / 2) ** 2)
    wi, wo = np.stack([ρ / 2, y, z], axis=1), np.stack([ρ / 2, -y, z], axis=1)
    shown = weighted_brdf(grating, wi, wo, weights, ALPHA)
    factor = (1 + np.sum(wi * wo, axis=1)) ** 2 / MEAN_W**2 / z**2
    found = at_radius(table.values[0], ρ.astype(np.float32))
    off = np.abs(found - shown / factor[:, None])
    assert off.max() < 0.08 * shown.max()
    assert np.sqrt(np.mean(off**2)) < 0.025 * shown.max()


def test_across_the_vector_it_falls_as_the_reference_does() -> None:
    grating = Grating(period=1.66, height=HEIGHT, energy="kirchhoff")
    weights, c = channels(0.54), lobe_deviation(ALPHA, 0.0)
    u, v = 0.54 / 1.66, np.array([0, c, 2 * c])
    wo = np.tile([0.0, 0.0, 1.0], (3, 1))
    wi = np.stack([np.full(3, u), v, np.sqrt(1 - u**2 - v**2)], axis=1)
    shown = weighted_brdf(grating, wi, wo, weights, ALPHA)[:, 0]
    assert shown / shown[0] == pytest.approx(np.exp([0, -1 / 2, -2]), rel=0.04)


def test_between_radii_a_profile_is_linear() -> None:
    profile = np.array([[0.0], [1.0], [4.0], [4.0]], np.float32)
    radius = np.array([[0.0, 0.5, 1.0], [1.25, 2.0, 50.0]], np.float32) * np.float32(RADIUS_STEP)
    expected = [[0, 0.5, 1], [1.75, 4, 4]]
    assert at_radius(profile, radius)[..., 0] == pytest.approx(np.array(expected), abs=1e-2)
    scaled = LobeTable(np.ones(1), profile[None], 0.01).scaled(2.5)
    assert scaled.values[0] == pytest.approx(2.5 * profile)


# ---- Periods -------------------------------------------------------------------------------------

FREQUENCIES = np.geomspace(0.3, 2.2, 101)
C = lobe_deviation(ALPHA, np.radians(0.2))


def mean_of(
    shares: dict[int, float],
    factors: tuple[float, ...] = (1.0, 1.0),
    furthest: float = 1.2,
    frequencies: tuple[np.ndarray, ...] | None = None,
) -> tuple[MeanProfile, list[LobeTable], np.ndarray]:
    """What photographs show on average of gratings whose vectors point everywhere.

    At ρ a lobe exp(−(ρ sin φ)²/2c²) is on average √2π c/(πρ) as bright as at its middle.
    """
    tables = [LobeTable.of(channels(*PEAKS), C, FREQUENCIES, HEIGHT) for _ in factors]
    planted = np.zeros(len(FREQUENCIES))
    planted[list(shares)] = list(shares.values())
    ρ = np.arange(tables[0].values.shape[1]) * RADIUS_STEP
    count = np.where((ρ > 0.06) & (ρ < furthest), 1000.0, 0.0)
    means = []
    for number, factor in enumerate(factors):
        shown = tables[number]
        if frequencies is not None:
            shown = LobeTable.of(channels(*PEAKS), C, frequencies[number], HEIGHT)
        profile = np.tensordot(planted, shown.values, 1)
        across = np.sqrt(2 * np.pi) * C / (np.pi * np.maximum(ρ, 0.01))
        means.append(factor * across[:, None] * profile)
    counts = np.tile(count, (len(factors), 1))
    return MeanProfile(np.array(means), counts), tables, np.ones((len(factors), 3), np.float32)


def test_planted_mixtures_come_back() -> None:
    planted = {20: 3.0, 34: 1.0, 52: 2.0}
    shares = frequency_shares(*mean_of(planted))
    assert {i: float(s) for i, s in enumerate(shares) if s > 0.01} == pytest.approx(
        planted, rel=0.01
    )


def test_periods_beyond_the_sample_get_no_share() -> None:
    """Up to ρ = 0.55 the first order of 0.52 µm is seen but for the tail of its lobe."""
    profile, tables, weights = mean_of({34: 1.0}, furthest=0.55)
    noise = np.random.default_rng(1).normal(0, 0.01 * profile.mean.max(), profile.mean.shape)
    noisy = MeanProfile(profile.mean + noise, profile.count)
    shares = frequency_shares(noisy, tables, weights)
    assert shares[30:39].sum() == pytest.approx(1, rel=0.1)
    assert shares[1 / FREQUENCIES < 0.62].sum() == 0


def test_darkness_has_no_periods() -> None:
    profile, tables, weights = mean_of({})
    assert not frequency_shares(profile, tables, weights).any()


def test_each_photographs_brightness() -> None:
    profile, tables, weights = mean_of({34: 1.0, 50: 0.5}, factors=(1.0, 0.4, 2.5))
    shares = np.zeros(len(FREQUENCIES))
    shares[34], shares[50] = 1.0, 0.5
    assert brightness(profile, tables, weights, shares) == pytest.approx([1, 0.4, 2.5], rel=1e-5)


def test_means_are_of_usable_observations_of_each_photograph() -> None:
    u = np.array([[0.3, 0.0, 0.301, 0.3]], np.float32)
    v = np.array([[0.0, 0.3, 0.0, 0.0]], np.float32)
    intensity = np.array([[[1.0], [3.0], [100.0], [7.0]]], np.float32)
    usable = np.array([[True, True, False, True]])
    strip = Strip(intensity, u, v, usable, np.array([0, 0, 0, 1]))
    profile = MeanProfile.of([strip, strip], 2)
    at = round(0.3 / RADIUS_STEP)
    assert profile.count[:, at].tolist() == [4, 2] and profile.count.sum() == 6
    assert profile.mean[:, at, 0].tolist() == [2, 7]
