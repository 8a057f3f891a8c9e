"""Gratings between circularly polarised light and a polariser, against closed forms.

Derived by hand. With d₀ = (R − 1)/2, d₁ = −(1 + R)/2 and Q = [[c, s], [s, −c]], c = cos 2θ and
s = sin 2θ, R_dᵀ D R_d is d₀ + d₁ Q, and

    B (d₀ + d₁ Q) B e_i = d₀ (1, −i e^{2iΔ}) + d₁ (c − i e^{iΔ} s, e^{iΔ}(s + i e^{iΔ} c))

whose Stokes parameters, with κ = conj(d₀) d₁, are

    S₀ = 2|d₀|² + 2|d₁|² + 4 sin Δ · s · Re κ
    S₁ = 2|d₁|² sin Δ sin 4θ + 4 Re(κ (c − i cos Δ · s))
    S₂ = 2 sin 2Δ (|d₀|² − |d₁|² c²) + 4 Re(κ (cos Δ · s + i cos 2Δ · c))

and I = (S₀ + S₁ cos 2ψ + S₂ sin 2ψ)/2: one harmonic of ψ, with retardation and without.
"""

from __future__ import annotations

import numpy as np
import pytest

from precompute.acquisition import jones
from precompute.acquisition.jones import (
    Obliquity,
    Plastic,
    fresnel_ratio,
    global_offset,
    intensity,
    reflected,
)
from precompute.spectra import INDEXED_METALS, IndexedMetal, refractive_index

CELLOPHANE = 1.468
TURNS = np.arange(16) * np.pi / 16
"""Polarisers at equal steps over a half turn: sums over them pick out 1, cos 2ψ and sin 2ψ."""


def draws(count: int = 200) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """θ, R and ψ at random: |R| from 0.01 to 100, any phase."""
    rng = np.random.default_rng(5)
    ratio = 10 ** rng.uniform(-2, 2, count) * np.exp(2j * np.pi * rng.random(count))
    return rng.uniform(-7, 7, count), ratio, rng.uniform(-7, 7, count)


def harmonics(θ: object, ratio: object, plastic: Plastic) -> tuple[np.ndarray, np.ndarray]:
    """The mean of I over ψ, and A e^{iη} of A cos(2ψ − η)."""
    x, y = reflected(np.asarray(θ), np.asarray(ratio), plastic)
    seen = intensity((x[..., None], y[..., None]), TURNS)
    return seen.mean(axis=-1), 2 * np.mean(seen * np.exp(2j * TURNS), axis=-1)


def turned(angle: float) -> np.ndarray:
    return np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


# ---- Closed forms --------------------------------------------------------------------------------


def test_without_birefringence_a_constant_and_a_cosine() -> None:
    """(1 + r²)/2 + (1 − r²)/2 · cos 2(ψ − θ) − r sin ζ sin 2(ψ − θ), the paper's Eq. 9."""
    θ, ratio, ψ = draws()
    r, ζ = np.abs(ratio), np.angle(ratio)
    expected = (1 + r**2) / 2 + (1 - r**2) / 2 * np.cos(2 * (ψ - θ))
    expected -= r * np.sin(ζ) * np.sin(2 * (ψ - θ))
    found = intensity(reflected(θ, ratio, Plastic()), ψ)
    assert np.all(np.abs(found - expected) < 1e-12 * (1 + r**2))


def test_the_paper_s_product_of_matrices() -> None:
    """Eq. 4 to 6 multiplied out, one matrix after the other."""
    rng = np.random.default_rng(6)
    for θ, ratio, ψ in zip(*draws(50), strict=True):
        Δ, α, δ, r, φ = rng.uniform(-1, 1, 5) * [0.3, 3, 0.3, 0.5, 3]
        filter_ = np.diag([1, 0]) @ turned(ψ)
        delay = turned(α).T @ np.diag([1, np.exp(1j * Δ)]) @ turned(α)
        first = turned(α).T @ np.diag([1, np.exp(1j * δ)]) @ turned(α)
        grating = turned(θ).T @ np.diag([-1, ratio]) @ turned(θ)
        system = r * np.exp(1j * φ) * first + (1 - r**2) * delay @ grating @ delay
        expected = np.linalg.norm(filter_ @ system @ [1, -1j]) ** 2
        found = intensity(reflected(θ, ratio, Plastic(Δ, α, r, φ, δ)), ψ)
        assert found == pytest.approx(expected, rel=1e-12, abs=1e-12)


def test_with_birefringence_still_a_constant_and_a_cosine() -> None:
    θ, ratio, ψ = draws()
    Δ = np.random.default_rng(7).uniform(-1.5, 1.5, θ.shape)
    c, s = np.cos(2 * θ), np.sin(2 * θ)
    mirror, grating = np.abs(ratio - 1) ** 2 / 4, np.abs(ratio + 1) ** 2 / 4
    κ = -np.conj(ratio - 1) * (1 + ratio) / 4
    s0 = 2 * mirror + 2 * grating + 4 * np.sin(Δ) * s * κ.real
    s1 = 2 * grating * np.sin(Δ) * np.sin(4 * θ) + 4 * np.real(κ * (c - 1j * np.cos(Δ) * s))
    s2 = 2 * np.sin(2 * Δ) * (mirror - grating * c**2)
    s2 += 4 * np.real(κ * (np.cos(Δ) * s + 1j * np.cos(2 * Δ) * c))
    expected = (s0 + s1 * np.cos(2 * ψ) + s2 * np.sin(2 * ψ)) / 2
    for one in range(len(θ)):
        found = intensity(reflected(θ[one], ratio[one], Plastic(Δ[one])), ψ[one])
        assert found == pytest.approx(expected[one], abs=1e-12 * (1 + abs(ratio[one]) ** 2))


def test_orientation_is_half_the_phase_up_to_one_offset() -> None:
    """I = c + A cos(2ψ − η), A² = ((1 − r²)/2)² + (r sin ζ)², with the first surface or not."""
    θ, ratio, _ = draws()
    mean, swing = harmonics(θ, ratio, Plastic())
    r, ζ = np.abs(ratio), np.angle(ratio)
    assert mean == pytest.approx((1 + r**2) / 2, rel=1e-12)
    amplitude = np.hypot((1 - r**2) / 2, r * np.sin(ζ))
    assert np.abs(swing) == pytest.approx(amplitude, abs=1e-12 * (1 + r.max() ** 2))
    for plastic in (Plastic(), Plastic(first_surface=-0.19, first_phase=1.1)):
        for one in range(0, len(θ), 7):
            _, swing = harmonics(θ[one], ratio[one], plastic)
            off = np.angle(swing) / 2 + global_offset(ratio[one], plastic) - θ[one]
            assert np.sin(off) == pytest.approx(0, abs=1e-9)  # modulo π


@pytest.mark.parametrize("ratio", [-1, 1])
def test_a_ratio_of_one_gives_no_modulation(ratio: int) -> None:
    """A mirror (−1) and a half-wave plate (1) leave circular light circular."""
    θ, _, ψ = draws()
    assert intensity(reflected(θ, ratio, Plastic()), ψ) == pytest.approx(np.ones_like(θ), abs=1e-13)


def test_turning_the_foil_turns_the_phase_twice_as_far() -> None:
    """With its plastic by α, everything by α; the gratings alone without retardation too."""
    θ, ratio, ψ = draws()
    α = 0.7
    for plastic, moved in (
        (Plastic(0.15, 0.3, -0.19, 0.4, 0.05), Plastic(0.15, 0.3 + α, -0.19, 0.4, 0.05)),
        (Plastic(), Plastic()),
    ):
        still = intensity(reflected(θ, ratio, plastic), ψ)
        foil = intensity(reflected(θ + α, ratio, moved), ψ + α)
        assert foil == pytest.approx(still, rel=1e-11, abs=1e-11)
        _, before = harmonics(θ, ratio, plastic)
        _, after = harmonics(θ + α, ratio, moved)
        assert after == pytest.approx(before * np.exp(2j * α), rel=1e-9, abs=1e-11)


def test_no_energy_is_made() -> None:
    """Both of two crossed polarisers together pass |wave|² ≤ 2 (|r_p| + t_p max(1, r))²."""
    θ, ratio, ψ = draws()
    ratio = ratio / np.maximum(np.abs(ratio), 1)
    for plastic in (Plastic(0.17, 0.3), Plastic(0.17, 0.3, -0.19, 0.4, 0.05)):
        wave = reflected(θ, ratio, plastic)
        both = intensity(wave, ψ) + intensity(wave, ψ + np.pi / 2)
        r = abs(plastic.first_surface)
        assert np.all(both <= 2 * (r + 1 - r**2) ** 2 * (1 + 1e-12))
        assert both.min() >= 0
    # Retarders keep what a mirror returns.
    wave = reflected(θ, -1, Plastic(0.17, 0.3))
    assert intensity(wave, ψ) + intensity(wave, ψ + np.pi / 2) == pytest.approx(
        np.full_like(θ, 2), rel=1e-12
    )


# ---- Metals --------------------------------------------------------------------------------------


@pytest.mark.parametrize("metal", INDEXED_METALS)
def test_metals_near_normal_incidence(metal: IndexedMetal) -> None:
    """−(1 + 2 sin²φ/(nN)) to the next order in sin²φ; −1 at normal incidence."""
    index = refractive_index(metal, 0.55)
    assert fresnel_ratio(index, CELLOPHANE, 0.0) == pytest.approx(-1, abs=1e-14)
    for φ in (0.02, 0.1):
        expected = -(1 + 2 * np.sin(φ) ** 2 / (CELLOPHANE * index))
        assert fresnel_ratio(index, CELLOPHANE, φ) == pytest.approx(expected, abs=3 * φ**4)


def test_fresnel_where_nothing_is_reflected() -> None:
    """Brewster's angle between plain media: all of what is left is s-polarised."""
    # From air (plastic of index 1) onto glass, tan φ = 1.5.
    assert abs(fresnel_ratio(1.5, 1.0, np.arctan(1.5))) > 1e12


def test_fresnel_s_amplitudes_give_the_reflectance_of_unpolarised_light() -> None:
    """Through energies: |r_s/r_p|² from reflectances at 60° on glass, known from textbooks."""
    i, t = np.deg2rad(60), np.arcsin(np.sin(np.deg2rad(60)) / 1.5)
    s, p = np.sin(i - t) / np.sin(i + t), np.tan(i - t) / np.tan(i + t)
    assert fresnel_ratio(1.5, 1.0, i) == pytest.approx(-s / p, rel=1e-12)


def test_oblique_mirrors_are_what_a_grating_of_the_same_ratio_is() -> None:
    """O with D = R = −1 is diag(−1, R_F) along the plane of incidence: Eq. 5 with θ there."""
    θ, ratio, ψ = draws()
    seen = intensity(reflected(ψ, -1, Plastic(), Obliquity(θ, ratio)), ψ)
    assert seen == pytest.approx(intensity(reflected(θ, ratio, Plastic()), ψ), rel=1e-11, abs=1e-11)


# ---- Birefringence -------------------------------------------------------------------------------


def phase_errors(ratio: complex, degrees: float, prenormalised: bool) -> np.ndarray:
    """θ from phases less θ, rad, modulo π, for θ evenly over the half turn."""
    θ = np.arange(180) * np.pi / 180
    _, swing = harmonics(θ, ratio, Plastic(np.deg2rad(degrees)))
    if prenormalised:
        swing = swing - swing.mean()  # an even share of all orientations: its mean is S₁, S₂'s
    off = np.angle(swing * np.exp(-2j * (θ - global_offset(ratio)))) / 2
    return np.abs(off)


@pytest.mark.parametrize("metal", INDEXED_METALS)
def test_taking_the_mean_away_straightens_birefringence(metal: IndexedMetal) -> None:
    """S₂'s constant, 2|d₀|² sin 2Δ, goes. Of what stays the ideal is 4|κ|e^{i(2θ − χ)}.

    From it κ's terms differ by (1 − cos Δ)|s| + (1 − cos 2Δ)|c| at most, in 4|κ|, those of |d₁|²
    by |d₁| sin Δ/(2|d₀|). θ is off by half the angle.
    """
    index = refractive_index(metal, 0.55)
    ratio = complex(fresnel_ratio(index, CELLOPHANE, np.deg2rad(10)))
    assert phase_errors(ratio, 0, False).max() < 1e-6
    assert phase_errors(ratio, 10, False).max() > np.deg2rad(40)  # of at most 90
    Δ = np.deg2rad(10)
    bound = np.hypot(1 - np.cos(Δ), 1 - np.cos(2 * Δ))
    bound += abs(1 + ratio) * np.sin(Δ) / (2 * abs(ratio - 1))
    assert phase_errors(ratio, 10, True).max() < np.arcsin(bound) / 2 < np.deg2rad(2)


@pytest.mark.parametrize(("ζ", "wraps"), [(164, False), (172, False), (176, True)])
def test_the_paper_s_three_ratios(ζ: float, wraps: bool) -> None:
    """R = 1.001 e^{iζ} at Δ = 3°: unusable once sin 2Δ = 0.105 exceeds A ≈ sin ζ, and else not."""
    ratio = 1.001 * np.exp(1j * np.deg2rad(ζ))
    assert (phase_errors(ratio, 3, False).max() > np.pi / 4) == wraps
    assert phase_errors(ratio, 3, True).max() < np.deg2rad(0.6)


# ---- Planted errors ------------------------------------------------------------------------------


def test_wrong_signs_are_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    """Either way round of the turn fails what says where phases go."""
    right = jones._scaled
    monkeypatch.setattr(jones, "_scaled", lambda w, α, a, b: right(w, -np.asarray(α), a, b))
    for test in (
        test_without_birefringence_a_constant_and_a_cosine,
        test_orientation_is_half_the_phase_up_to_one_offset,
        test_turning_the_foil_turns_the_phase_twice_as_far,
    ):
        with pytest.raises(AssertionError):
            test()
