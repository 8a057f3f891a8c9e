"""Gratings fitted to observations that were made from the model's closed form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from precompute.acquisition.completion import completed
from precompute.acquisition.lobe_fit import Fit, Model, fit_strip, predicted
from precompute.acquisition.lobes import RADIUS_STEP, LobeTable, lobe_deviation
from precompute.acquisition.observations import Strip
from precompute.acquisition.thresholds import brightest
from precompute.spectra import WAVELENGTHS

C = lobe_deviation(float(np.radians(0.7)), float(np.radians(0.2)))
PEAKS = (0.46, 0.54, 0.61)
STRENGTH = 2.0
ONE = np.array([1 / 1.66])
MANY = np.geomspace(1 / 2.0, 1 / 1.3, 22)


def model(frequencies: np.ndarray = ONE) -> Model:
    weights = np.exp(-((WAVELENGTHS[:, None] - np.array(PEAKS)) ** 2) / (2 * 0.03**2))
    table = LobeTable.of(weights, C, frequencies, 0.15)
    table = table.scaled(1 / table.values.max())  # a lobe's peak is 1, so weights of 10 are 0.1
    count = len(frequencies)
    return Model([table], np.full(count, 1 / count), STRENGTH, np.full((1, 3), 10, np.float32))


def shown(
    made: Model, u: np.ndarray, v: np.ndarray, θ: np.ndarray, place: np.ndarray, s: np.ndarray
) -> np.ndarray:
    """s exp(−y²/2c²) P(|x|), x along the grating's vector and y across, shape (n, J, 3).

    So lobes are round in (u, v); P is linear between the numbers of the table.
    """
    table = made.tables[0].values
    along, across = (
        u * np.cos(θ)[:, None] + v * np.sin(θ)[:, None],
        v * np.cos(θ)[:, None] - u * np.sin(θ)[:, None],
    )
    lobe = np.exp(-(across**2) / (2 * C**2))
    radii = np.arange(table.shape[1]) * RADIUS_STEP
    result = np.zeros((*u.shape, 3))
    for row, (where, strength) in enumerate(zip(place, s, strict=True)):
        below = min(int(where), len(table) - 2) if len(table) > 1 else 0
        share = where - below
        profile = table[below] * (1 - share) + (table[below + 1] * share if share > 0 else 0)
        for channel in range(3):
            seen = np.interp(np.abs(along[row]), radii, profile[:, channel])
            result[row, :, channel] = STRENGTH * strength * lobe[row] * seen
    return result


def strip(u: np.ndarray, v: np.ndarray, intensity: np.ndarray) -> Strip:
    return Strip(
        intensity.astype(np.float32),
        u.astype(np.float32),
        v.astype(np.float32),
        np.ones(u.shape, bool),
        np.zeros(u.shape[1], np.intp),
    )


def scattered(n: int, count: int, seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Half vectors of so many observations, as tiles about a highlight have them."""
    rng = np.random.default_rng(seed)
    ρ, φ = rng.uniform(0.1, 0.65, (n, count)), rng.uniform(-np.pi, np.pi, (n, count))
    return ρ * np.cos(φ), ρ * np.sin(φ)


def at_angles(*degrees: float, ρ: float = 0.54 / 1.66) -> tuple[np.ndarray, np.ndarray]:
    φ = np.radians(np.array([degrees], dtype=np.float64))
    return ρ * np.cos(φ), ρ * np.sin(φ)


def turn_deg(found: np.ndarray, true: np.ndarray) -> np.ndarray:
    return np.degrees(np.abs(np.mod(found - true + np.pi / 2, np.pi) - np.pi / 2))


# ---- Orientations --------------------------------------------------------------------------------


def test_one_period_at_random_orientations() -> None:
    n, rng = 200, np.random.default_rng(2)
    made, θ, s = model(), rng.uniform(0, np.pi, n), rng.uniform(0.3, 1, n)
    u, v = scattered(n, 300)
    fit = fit_strip(strip(u, v, shown(made, u, v, θ, np.zeros(n), s)), made)
    off = turn_deg(fit.orientation, θ)
    assert np.median(off) < 0.01 and np.percentile(off, 95) < 0.1 and off.max() < 1
    error = np.abs(fit.strength / s - 1)
    assert np.median(error) < 0.01 and error.max() < 0.2
    assert fit.frequency == pytest.approx(np.full(n, 1 / 1.66))
    assert np.all((fit.orientation >= 0) & (fit.orientation < np.pi))


def test_orientation_and_period_at_random() -> None:
    n, rng = 150, np.random.default_rng(3)
    made, θ = model(MANY), rng.uniform(0, np.pi, n)
    place = rng.uniform(1, len(MANY) - 2, n)
    u, v = scattered(n, 300)
    fit = fit_strip(strip(u, v, shown(made, u, v, θ, place, np.ones(n))), made)
    off = turn_deg(fit.orientation, θ)
    assert np.median(off) < 0.02 and np.percentile(off, 95) < 0.2
    planted = np.exp(np.interp(place, np.arange(len(MANY)), np.log(MANY)))
    error = np.abs(fit.frequency / planted - 1)
    assert np.median(error) < 2e-3 and np.percentile(error, 95) < 0.01


def test_two_observations_either_side_of_a_lobe_tell_its_middle() -> None:
    """At −1 and +2 degrees of 41°; at ρ = 0.33 a lobe's deviation is 2.5 degrees."""
    made, θ = model(), np.radians([41.0])
    u, v = at_angles(40, 43)
    fit = fit_strip(strip(u, v, shown(made, u, v, θ, np.zeros(1), np.ones(1))), made)
    assert turn_deg(fit.orientation, θ) < 0.05


def test_one_bright_observation_has_two_sides_and_a_dark_one_decides() -> None:
    """Seen 3° off the middle the lobe may lie on either side.

    A weaker one nearer by shows the same, down to half the strength in the middle itself, so that
    no more is told than the side, and how far off it is at the most.
    """
    made, θ = model(), np.radians([60.0])
    bright = (57.0,)
    u, v = at_angles(*bright)
    alone = shown(made, u, v, θ, np.zeros(1), np.ones(1))
    for dark, answer in ((50.0, 60.0), (64.0, 54.0)):
        u, v = at_angles(*bright, dark)
        intensity = np.concatenate([alone, np.zeros_like(alone)], axis=1)
        fit = fit_strip(strip(u, v, intensity), made)
        towards = np.degrees(fit.orientation[0]) - bright[0]
        assert 0 < towards * np.sign(answer - bright[0]) < 4.5
        level = np.exp(-((towards / 2.5) ** 2) / 2) * fit.strength[0]
        assert level == pytest.approx(np.exp(-((3 / 2.5) ** 2) / 2), rel=0.15)
    # Without the dark one both are as good: what is shown of either is the same.
    u, v = at_angles(*bright)
    both = [shown(made, u, v, np.radians([a]), np.zeros(1), np.ones(1)) for a in (60.0, 54.0)]
    assert both[0] == pytest.approx(both[1])


def test_darkness_has_no_gain_and_hides_what_would_have_shown_least() -> None:
    made = model()
    u, v = at_angles(*np.arange(0, 150, 3.0).tolist())  # nothing was seen from 147 to 180 degrees
    fit = fit_strip(strip(u, v, np.zeros((1, u.shape[1], 3))), made)
    assert fit.gain == pytest.approx([0]) and fit.shown == pytest.approx([0])
    # A lobe reaches 3.5 deviations of 2.5°: between 156 and 171 degrees it shows nothing at all.
    assert turn_deg(fit.least_seen, np.radians([163.5])) < 8.5
    assert fit.least < 1e-3


def test_noise_turns_orientations_little() -> None:
    """At 2 % of a lobe's peak in each of some 10 lit observations: a hundredth of 2.5°."""
    n, rng = 300, np.random.default_rng(4)
    made, θ = model(), rng.uniform(0, np.pi, n)
    u, v = scattered(n, 300)
    clean = shown(made, u, v, θ, np.zeros(n), np.ones(n))
    noisy = clean + rng.normal(0, 0.02 * STRENGTH, clean.shape)
    fit = fit_strip(strip(u, v, noisy), made)
    off = turn_deg(fit.orientation, θ)
    assert np.median(off) < 0.1 and np.percentile(off, 99) < 0.5
    assert np.median(np.abs(fit.strength - 1)) < 0.03


def test_unusable_observations_count_for_nothing() -> None:
    made, θ = model(), np.radians([30.0])
    u, v = scattered(1, 80)
    good = strip(u, v, shown(made, u, v, θ, np.zeros(1), np.ones(1)))
    u2, v2 = (np.concatenate([part, part], axis=1) for part in (u, v))
    nonsense = np.concatenate([good.intensity, np.zeros_like(good.intensity)], axis=1)
    usable = np.arange(160)[None] < 80
    more = replace(strip(u2, v2, nonsense), usable=usable)
    one, other = fit_strip(good, made), fit_strip(more, made)
    for name in vars(one):
        assert getattr(other, name) == pytest.approx(getattr(one, name), rel=1e-5), name


def test_what_is_predicted_is_the_closed_form() -> None:
    n, rng = 20, np.random.default_rng(5)
    made, θ = model(MANY), rng.uniform(0, np.pi, n)
    place, s = rng.uniform(0, len(MANY) - 1, n), rng.uniform(0, 1, n)
    u, v = scattered(n, 60)
    expected = shown(made, u, v, θ, place, s)
    frequency = np.exp(np.interp(place, np.arange(len(MANY)), np.log(MANY)))
    none = np.zeros(n)
    fit = Fit(θ, frequency, s, none, none, none, none, none)
    found = predicted(strip(u, v, np.zeros_like(expected)), made, fit)
    # Beyond 3.5 standard deviations, at 0.2 % of the peak of 2, a lobe is taken to end.
    assert found == pytest.approx(expected, abs=0.006)


# ---- Thresholds ----------------------------------------------------------------------------------


def test_the_brightest_observation_decides() -> None:
    u, v = at_angles(20, 80, 200)  # 200° is the same orientation as 20°
    intensity = np.array([1.0, 0.1, 0.9])[None, :, None] * np.ones(3)
    θ, period, threshold = brightest(strip(u, v, intensity), 0.54)
    assert turn_deg(θ, np.radians([20.0])) < 1e-4
    assert period == pytest.approx([1.66])  # λ/ρ, the first order's
    assert threshold == pytest.approx([1])


def test_observations_of_one_threshold_share() -> None:
    """Both pass 0.8 of the brightest texel: double angles are weighed by brightness."""
    u, v = (np.tile(part, (2, 1)) for part in at_angles(170, 20))
    intensity = np.array([[1.0, 0.0], [0.95, 0.85]])[..., None] * np.ones(3)
    θ, _, threshold = brightest(strip(u, v, intensity), 0.54)
    vector = 0.95 * np.exp(2j * np.radians(170)) + 0.85 * np.exp(2j * np.radians(20))
    assert turn_deg(θ, np.array([np.radians(170), np.angle(vector) / 2])).max() < 1e-4
    assert threshold == pytest.approx([1, 0.8])


def test_dim_texels_pass_lower_thresholds_and_dark_ones_none() -> None:
    u, v = (np.tile(part, (3, 1)) for part in at_angles(20, 80))
    intensity = np.zeros((3, 2, 3))
    intensity[0, 0], intensity[1, 1] = 1.0, 0.05
    θ, _, threshold = brightest(strip(u, v, intensity), 0.54)
    assert np.degrees(θ[:2]) == pytest.approx([20, 80], abs=1e-3)
    assert threshold[0] == pytest.approx(1) and threshold[2] == 0
    assert 0.05 * 0.8 <= threshold[1] <= 0.05


# ---- What to believe -----------------------------------------------------------------------------


def test_what_is_seen_unsure_dark_and_hidden() -> None:
    """One texel of each in the upper row, the same dimmer in the lower."""
    gain = np.array([0.5, 0.5, 0.0, 0.0, 0.01, 0.01, 0.0, 0.0])
    fit = Fit(
        orientation=np.linspace(0.1, 0.8, 8),
        frequency=np.array([0.6, 0.6, 9.0, 9.0, 0.6, 0.6, 9.0, 9.0]),
        strength=np.array([0.3, 1.7, 0.0, 0.0, 0.7, 0.1, 0.0, 0.0]),
        gain=gain,
        margin=np.array([0.9, 0.1, 0, 0, 0.9, 0.1, 0, 0]),
        least_seen=np.full(8, 2.0),
        least=np.array([0, 0, 0.3, 0, 0, 0, 0.3, 1e-5]),
        shown=gain,
    )
    whole = completed(fit, (4, 2), lit_gain=3e-4)
    for row in range(2):
        kinds = [
            [name for name in ("seen", "unsure", "dark", "hidden") if getattr(whole, name)[row, i]]
            for i in range(4)
        ]
        assert kinds == [["seen"], ["unsure"], ["dark"], ["hidden"]]
    # A texel dimmed to 0.7 diffracts as a whole, one at half of 0.6 by half, none by more.
    assert whole.gratings.strength[0] == pytest.approx([0.5, 1, 0, 1])
    assert whole.gratings.strength[1, 0] == 1
    assert whole.gratings.orientation[0, 3] == 2.0 and whole.gratings.frequency[0, 3] == 0.6
    assert whole.confidence[:, 2:].tolist() == [[0, 0], [0, 0]]
    assert whole.confidence[0, 0] > whole.confidence[1, 0] > whole.confidence[1, 1] > 0
    assert whole.confidence[0, 0] < 1
    # Where noise gains as much, the lower row's light may be but that: then it is not seen.
    noisy = completed(fit, (4, 2), lit_gain=0.04)
    assert noisy.seen.tolist() == [[True, False, False, False], [False] * 4]
