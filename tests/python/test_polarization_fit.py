"""The fit of one harmonic to each pixel, against what photographs were made of."""

from __future__ import annotations

import numpy as np
import pytest

from precompute.acquisition import polarization_fit
from precompute.acquisition.jones import Plastic, fresnel_ratio, global_offset, intensity, reflected
from precompute.acquisition.polarization_fit import (
    HarmonicFit,
    Harmonics,
    distinct_angles,
    fit_block,
    fitted,
    photograph_means,
)
from precompute.errors import InputError
from precompute.spectra import INDEXED_METALS, IndexedMetal, refractive_index

SETS = ([0, 60, 120], [3, 50, 71], [0, 45, 90, 135], np.arange(13) * 15, np.arange(17) * 13)


def made(
    degrees: object, phase: np.ndarray, amplitude: object, mean: object = 1.0
) -> tuple[np.ndarray, np.ndarray]:
    """ψ, and c + A cos(2ψ − η) of pixels, shape (photographs, pixels), float32."""
    ψ = np.deg2rad(np.asarray(degrees, float))
    values = mean + amplitude * np.cos(2 * ψ[:, None] - phase)
    return ψ, values.astype(np.float32)


def phases(count: int = 360) -> np.ndarray:
    """Evenly over the turn, in an order of their own."""
    return np.random.default_rng(3).permutation(count) * 2 * np.pi / count


def off(found: np.ndarray, expected: np.ndarray) -> np.ndarray:
    """By how much phases differ, rad, 0 to π."""
    return np.abs(np.angle(np.exp(1j * (found.astype(float) - expected))))


# ---- Pixels --------------------------------------------------------------------------------------


@pytest.mark.parametrize("degrees", SETS, ids=str)
def test_any_three_angles_or_more_give_phase_amplitude_and_mean(degrees: object) -> None:
    η = phases()
    A, c = np.linspace(0.05, 0.9, 360), np.linspace(3, 1, 360)
    ψ, values = made(degrees, η, A, c)
    fit = fit_block(values, Harmonics.of(ψ))
    # Numbers of some 3 are rounded to 2e-7 of themselves; three near angles multiply that by 5.
    assert off(fit.phase, η).max() < 2e-5
    assert fit.amplitude == pytest.approx(A, abs=4e-6)
    assert fit.mean == pytest.approx(c, abs=4e-6)
    assert fit.correlation == pytest.approx(1, abs=1e-5)
    if len(ψ) > 3:
        assert np.all(fit.residual < 1e-3 * A.max())
    else:
        assert np.all(np.isnan(fit.residual))


def test_faint_modulations_of_bright_light_keep_their_digits() -> None:
    """A thousandth of the light: what single precision rounds away is 6e-8/1e-3 of it."""
    η = phases()
    ψ, values = made(np.arange(12) * 15, η, 1e-3)
    fit = fit_block(values, Harmonics.of(ψ))
    assert off(fit.phase, η).max() < 2e-4
    assert fit.amplitude == pytest.approx(1e-3, rel=2e-4)


def test_noise_comes_out_as_least_squares_has_it() -> None:
    """Residual σ, phases off by σ √(2/K)/A for angles spread evenly, correlation by energies."""
    rng = np.random.default_rng(4)
    K, σ, A = 12, 0.02, 0.2
    η = phases(20000)
    ψ, values = made(np.arange(K) * 15, η, A)
    values += (σ * rng.standard_normal(values.shape)).astype(np.float32)
    fit = fit_block(values, Harmonics.of(ψ))
    assert np.sqrt(np.mean(fit.residual**2)) == pytest.approx(σ, rel=0.01)
    assert np.sqrt(np.mean(off(fit.phase, η) ** 2)) == pytest.approx(
        σ * np.sqrt(2 / K) / A, rel=0.02
    )
    signal, noise = K * A**2 / 2, σ**2
    expected = np.sqrt((signal + 2 * noise) / (signal + (K - 1) * noise))
    assert fit.correlation.mean() == pytest.approx(expected, abs=1e-3)


def test_a_second_harmonic_is_residual() -> None:
    ψ, values = made(np.arange(8) * 22.5, phases(), 0.2)
    values += (0.1 * np.cos(4 * ψ))[:, None].astype(np.float32)
    fit = fit_block(values, Harmonics.of(ψ))
    # Its squares sum to 8 · 0.01/2 over the five degrees of freedom that are left.
    assert fit.residual == pytest.approx(np.sqrt(8 * 0.005 / 5), rel=1e-4)
    assert fit.correlation == pytest.approx(np.sqrt(0.02 / (0.02 + 0.005)), rel=1e-4)


def test_pixels_that_some_photograph_does_not_show_stay_unknown() -> None:
    ψ, values = made([0, 45, 90, 135], phases(4), 0.2)
    values[2, 1] = np.nan
    values[:, 3] = 1
    fit = fit_block(values, Harmonics.of(ψ))
    assert np.isnan(fit.phase).tolist() == [False, True, False, False]
    assert np.isnan(fit.mean).tolist() == [False, True, False, False]
    assert np.isnan(fit.correlation).tolist() == [False, True, False, True]  # flat: none
    assert fit.amplitude[3] == 0 and fit.mean[3] == 1


# ---- Photographs ---------------------------------------------------------------------------------


def test_blocks_of_any_size_give_the_same_bytes(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(5)
    photographs = rng.random((5, 37, 23), dtype=np.float32)
    harmonics = Harmonics.of(np.deg2rad([0, 30, 70, 110, 150]))
    whole = fitted(photographs, harmonics)
    for block in (1, 100, 37 * 23):
        monkeypatch.setattr(polarization_fit, "BLOCK", block)
        parts = fitted(photographs, harmonics)
        for name in vars(whole):
            assert getattr(parts, name).tobytes() == getattr(whole, name).tobytes()
    one = fit_block(photographs[:, 20, 7:9], harmonics)
    assert one.phase.tolist() == whole.phase[20, 7:9].tolist()
    assert whole.phase.shape == (37, 23) and whole.phase.dtype == np.float32


def shown_by(
    ratio: complex, plastic: Plastic, ψ: np.ndarray, brightness: np.ndarray, drift: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """θ evenly spread, each at all brightnesses, and photographs of them."""
    θ = np.tile(np.arange(180) * np.pi / 180, (len(brightness), 1))
    x, y = reflected(θ, ratio, plastic)
    values = [
        light * brightness[:, None] * intensity((x, y), angle)
        for angle, light in zip(ψ, drift, strict=True)
    ]
    return θ, np.stack(values).astype(np.float32)


def orientation_errors(fit: HarmonicFit, θ: np.ndarray, offset: float) -> np.ndarray:
    """Degrees, 0 to 90."""
    return np.rad2deg(off(fit.phase, 2 * (θ - offset))) / 2


@pytest.mark.parametrize("metal", INDEXED_METALS)
def test_metals_under_retarding_plastic_are_solved_over_the_photographs_means(
    metal: IndexedMetal,
) -> None:
    """Brightness from 0.2 to 1 and light that drifts by 1 %, at a modulation of 1 %.

    Drift that passes for a harmonic of the means, √2 %/√12 or so, changes the columns by as much.
    """
    index = refractive_index(metal, 0.55)
    ratio = complex(fresnel_ratio(index, 1.468, np.deg2rad(10)))
    rng = np.random.default_rng(6)
    ψ = np.arange(12) * np.pi / 12
    drift = np.exp(0.01 * rng.standard_normal(12))
    bright = np.linspace(0.2, 1, 9)
    everywhere = np.ones((9, 180), bool)
    for degrees, bound in ((0, 0.6), (3, 0.6), (10, 1.6)):
        plastic = Plastic(np.deg2rad(degrees))
        θ, photographs = shown_by(ratio, plastic, ψ, bright, drift)
        means = photograph_means(photographs, everywhere)
        fit = fitted(photographs, Harmonics.of(ψ, means))
        errors = orientation_errors(fit, θ, global_offset(ratio))
        assert errors.max() < bound
        assert fit.mean == pytest.approx(np.tile(bright[:, None] / 0.6, (1, 180)), rel=0.01)
        raw = orientation_errors(fitted(photographs, Harmonics.of(ψ)), θ, global_offset(ratio))
        assert raw.max() > 5  # for drift alone


def test_columns_undo_what_the_means_do_to_the_harmonic() -> None:
    """Where a mirror's light is modulated by a third: without m, twice the ellipse b²/4 in η."""
    ψ = np.arange(12) * np.pi / 12
    b, A = 0.34, 0.02
    η = phases()
    light = 7 * (1 + b * np.sin(2 * ψ))
    swing = 7 * A * np.cos(2 * ψ[:, None] - η)
    photographs = (light[:, None] + swing).astype(np.float32)[:, None]
    means = photograph_means(photographs, np.ones((1, 360), bool))
    assert means == pytest.approx(light, rel=1e-5)
    harmonics = Harmonics.of(ψ, means)
    assert off(fitted(photographs, harmonics).phase[0], η).max() < 1e-3
    plain = Harmonics.of(ψ)
    without = Harmonics(plain.columns, plain.middles, means)
    assert off(fitted(photographs, without).phase[0], η).max() > 0.02


def test_bare_pixels_serve_as_well() -> None:
    """Orientations that do not cancel, over the means of mirrors beside them."""
    ratio = 1.05 * np.exp(1j * np.deg2rad(172))
    plastic = Plastic(np.deg2rad(4))
    ψ = np.deg2rad([0, 30, 70, 110, 150])
    θ = np.deg2rad([[10.0, 25.0, 40.0, 0.0]])
    x, y = reflected(θ, np.array([[ratio, ratio, ratio, -1]]), plastic)
    photographs = np.stack([intensity((x, y), angle) for angle in ψ]).astype(np.float32)
    bare = np.array([[False, False, False, True]])
    fit = fitted(photographs, Harmonics.of(ψ, photograph_means(photographs, bare)))
    errors = orientation_errors(fit, θ, global_offset(ratio))[~bare]
    assert errors.max() < 0.5
    mixed = fitted(photographs, Harmonics.of(ψ, photograph_means(photographs, ~bare)))
    assert orientation_errors(mixed, θ, global_offset(ratio))[~bare].max() > 10


# ---- Bad input -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("degrees", "apart"),
    [
        ([10], 1),
        ([0, 90], 2),
        ([0, 90, 180, 270], 2),
        ([5, 5, 185, -175], 1),
        ([0, 0.5, 90], 2),
        ([0.2, 90, 179.9], 2),
    ],
)
def test_angles_that_are_too_few_or_repeat(degrees: list[float], apart: int) -> None:
    assert distinct_angles(np.deg2rad(degrees)) == apart
    with pytest.raises(InputError, match=f"three angles that differ modulo 180°, not {apart}"):
        Harmonics.of(np.deg2rad(degrees))


def test_photographs_without_light_or_without_pixels() -> None:
    with pytest.raises(InputError, match="above 0"):
        Harmonics.of(np.deg2rad([0, 60, 120]), np.array([1, 0, 1]))
    photographs = np.ones((3, 2, 2), np.float32)
    with pytest.raises(InputError, match="no pixel"):
        photograph_means(photographs, np.zeros((2, 2), bool))
    photographs[1] = np.nan
    with pytest.raises(InputError, match="1 = 'no pixel'"):
        photograph_means(photographs, np.ones((2, 2), bool))


def test_a_planted_sign_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    right = np.arctan2
    monkeypatch.setattr(polarization_fit.np, "arctan2", lambda b, a: right(-b, a))
    with pytest.raises(AssertionError):
        test_any_three_angles_or_more_give_phase_amplitude_and_mean([0, 60, 120])
