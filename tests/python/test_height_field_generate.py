"""Generated height fields: closed forms, exact periods, slopes that their pitch resolves."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from refusals import refused
from scipy.special import jv

from precompute.height_fields.field import HeightField
from precompute.height_fields.generate import generated
from precompute.height_fields.recipe import (
    Blazed,
    Bumps,
    Cosine,
    Fingers,
    Generated,
    Pits,
    Roughness,
)
from precompute.height_fields.sampling import QUARTER_WAVE, height_steps, refuse_undersampled
from precompute.height_fields.spectrum import power_spectrum
from precompute.profiles import Sinusoidal, Triangular

CD = Pits()
DVD = Pits(
    depth=0.105, track_pitch=0.74, width=0.32, channel_bit=0.1333, runs=(3, 14), tracks=16, bits=90
)
SOURCES = (Bumps(), Blazed(), Cosine(), CD, DVD, Fingers(), Roughness())
RANDOM = (CD, Fingers(), Roughness())


def kind(source: Generated) -> str:
    return source.kind


def line_amplitudes(field: HeightField, kw: float) -> np.ndarray:
    """Mean over the patch of exp(ikwh)·exp(2πi(jx/Tx + ly/Ty)), at [l, j]."""
    return np.fft.ifft2(np.exp(1j * kw * field.heights))


@pytest.mark.parametrize("source", SOURCES, ids=kind)
def test_every_field_is_fine_enough_for_visible_light(source: Generated) -> None:
    refuse_undersampled(source.kind, generated(source))


length = st.floats(0.3, 5)


@settings(max_examples=60, deadline=None)
@given(
    source=st.one_of(
        st.builds(
            Bumps, height=st.floats(0.01, 1), size=st.tuples(length, length), cell=st.just((6, 5))
        ),
        st.builds(
            Blazed, height=st.floats(0.01, 1), period=st.floats(1, 9), edge=st.floats(0.05, 0.9)
        ),
        st.builds(Cosine, height=st.floats(0.01, 1), period=st.floats(0.5, 9)),
        st.builds(Pits, depth=st.floats(0.01, 0.4), tracks=st.just(2), seed=st.integers(0, 9)),
        st.builds(
            Fingers,
            height=st.floats(0.01, 0.6),
            spacing=st.floats(0.5, 2),
            jitter=st.floats(0, 0.5),
            columns=st.just(3),
            rows=st.just(4),
        ),
        st.builds(Roughness, rms=st.floats(0.001, 0.2), period=st.just(8), seed=st.integers(0, 99)),
    )
)
def test_whatever_its_parameters_a_field_chooses_a_pitch_for_its_steepest_place(
    source: Generated,
) -> None:
    """The wrap-around seam is judged too, so that this also says that the field repeats."""
    field = generated(source)
    assert height_steps(field.heights).max() < QUARTER_WAVE
    assert max(field.pitch) <= 0.05


@pytest.mark.parametrize("source", SOURCES, ids=kind)
def test_a_field_is_the_same_at_every_other_sample(source: Generated) -> None:
    """Half the pitch adds samples between; it moves none, at the seam neither."""
    width, height = generated(source).period
    # Sizes that need no rounding, of a square patch or nearly.
    coarse, fine = (generated(source, max(width, height) / n) for n in (160, 320))
    assert fine.heights.shape == tuple(2 * n for n in coarse.heights.shape)
    assert np.abs(fine.heights[::2, ::2] - coarse.heights).max() < 1e-9


@pytest.mark.parametrize("source", RANDOM, ids=kind)
def test_a_seed_gives_one_field_and_another_seed_another(
    source: Pits | Fingers | Roughness,
) -> None:
    first = generated(source).heights
    assert np.array_equal(first, generated(source).heights)
    other = generated(source.model_copy(update={"seed": source.seed + 1})).heights
    assert np.abs(other - first).max() > 0.1 * np.ptp(first)


def test_one_bump_per_cell_has_its_height_foot_and_volume() -> None:
    """∫∫ h cos² cos² over the foot is a quarter of the box around the bump."""
    source = Bumps(height=0.2, size=(1.0, 0.5), cell=(2.0, 1.5))
    field = generated(source, 1 / 64)
    assert field.period == pytest.approx((2.0, 1.5))
    x, y = (np.arange(n) / 64 for n in (128, 96))
    assert field.heights[48, 64] == field.heights.max() == pytest.approx(0.2)
    outside = np.logical_or.outer(np.abs(y - 0.75) >= 0.25, np.abs(x - 1) >= 0.5)
    assert np.abs(field.heights[outside]).max() < 1e-12
    assert field.heights[~outside].min() > 0
    assert field.heights.sum() / 64**2 == pytest.approx(0.2 * 1.0 * 0.5 / 4)


@given(height=st.floats(0.02, 0.6), period=st.floats(1, 5), wavelength=st.floats(0.38, 0.78))
@settings(max_examples=20, deadline=None)
def test_a_cosines_lines_are_the_orders_of_the_sinusoidal_profile(
    height: float, period: float, wavelength: float
) -> None:
    """But for orders as many as the samples away, which samples cannot tell from them."""
    field = generated(Cosine(height=height, period=period))
    kw = 2 * np.pi * 1.9 / wavelength
    lines = line_amplitudes(field, kw)
    for order in range(-4, 5):
        expected = Sinusoidal().amplitude(order, kw * height)
        mistaken = 2 * abs(jv(lines.shape[1] - abs(order), kw * height / 2))
        assert lines[0, order] == pytest.approx(complex(expected), abs=mistaken + 1e-12)
    assert np.abs(lines[1:]).max() < 1e-12  # nothing changes along y


def test_a_sawtooths_lines_are_those_of_the_profile_with_its_edge() -> None:
    """Rising along +x: as the profiles', its light goes to negative orders."""
    source = Blazed(height=0.25, period=2.5, edge=0.125)
    field = generated(source, 2.5 / 320)
    profile = Triangular(apex=1 - 0.125 / 2.5)
    kw = 2 * np.pi * 2 / 0.5
    lines = line_amplitudes(field, kw)[0]
    expected = [complex(profile.amplitude(m, kw * 0.25)) for m in range(-6, 7)]
    assert lines[np.arange(-6, 7)] == pytest.approx(np.array(expected), abs=2e-3)
    assert np.argmax(np.abs(lines)) == len(lines) - 1  # φ = 2π: order −1


@pytest.mark.parametrize("source", [CD, DVD], ids=["cd", "dvd"])
def test_pits_lie_on_tracks_and_are_whole_bits_long(source: Pits) -> None:
    field = generated(source, 0.02)
    columns, rows = field.heights.shape[1], field.heights.shape[0]
    assert field.period == pytest.approx(
        (source.tracks * source.track_pitch, source.bits * source.channel_bit)
    )
    assert field.heights.max() == pytest.approx(0, abs=1e-12)
    assert field.heights.min() == pytest.approx(-source.depth)
    x = np.arange(columns) * field.pitch[0]
    from_track = np.abs(np.mod(x, source.track_pitch) - source.track_pitch / 2)
    between = from_track > (source.width + source.edge) / 2
    assert np.abs(field.heights[:, between]).max() < 1e-12
    runs = []
    for track in range(source.tracks):
        middle = round((track + 0.5) * source.track_pitch / field.pitch[0]) % columns
        depth = -field.heights[:, middle] / source.depth
        crossings = half_crossings(depth) * field.pitch[1]
        lengths = np.diff(np.append(crossings, crossings[0] + field.period[1]))
        runs.extend(lengths / source.channel_bit)
    # The flanks are straight to 3 % of their width between two samples.
    assert np.abs(runs - np.round(runs)).max() < 0.03
    assert (round(min(runs)), round(max(runs)) <= source.runs[1]) == (source.runs[0], True)
    # Shorter runs carry more: of the shortest there are the most, about a third.
    share = np.mean(np.round(runs) == source.runs[0])
    assert 0.2 < share < 0.5
    assert len(runs) * np.mean(runs) == pytest.approx(source.bits * source.tracks)
    assert rows % 4 == columns % 4 == 0


def half_crossings(values: np.ndarray) -> np.ndarray:
    """Where periodic values cross ½, in samples, by straight lines between them."""
    following = np.roll(values, -1)
    before = np.flatnonzero((values - 0.5) * (following - 0.5) < 0)
    return before + (0.5 - values[before]) / (following[before] - values[before])


def test_pits_are_as_wide_at_half_depth_as_the_recipe_says() -> None:
    source = CD.model_copy(update={"tracks": 1})
    field = generated(source, 0.02)
    deepest = field.heights.min(axis=0)
    left, right = half_crossings(deepest / -source.depth) * field.pitch[0]
    assert right - left == pytest.approx(source.width, abs=0.002)
    assert (left + right) / 2 == pytest.approx(source.track_pitch / 2, abs=0.002)


def test_fingers_stand_in_columns_and_rows() -> None:
    """Without jitter the strongest line is that of the rows, and every column is alike."""
    source = Fingers(jitter=0)
    power = power_spectrum(generated(source))
    row, column = np.unravel_index(np.argmax(power), power.shape)
    assert min(row, len(power) - row) == source.rows
    assert column == 0
    field = generated(source, source.length / 64)
    heights = field.heights[:, : 64 * source.columns].reshape(len(field.heights), -1, 64)
    # Tips lie on multiples of the length; ridges are not all equally long, tips are.
    assert heights[:, :, 0].max(axis=0) == pytest.approx(np.full(source.columns, source.height))


@given(jitter=st.floats(0, 0.5), seed=st.integers(0, 99))
@settings(max_examples=20, deadline=None)
def test_fingers_keep_to_the_heights_of_their_jitter(jitter: float, seed: int) -> None:
    source = Fingers(jitter=jitter, seed=seed, columns=3, rows=5)
    heights = generated(source).heights
    assert heights.min() >= 0
    assert (
        source.height * (1 - jitter) - 1e-12 < heights.max() <= source.height * (1 + jitter) + 1e-12
    )


def test_roughness_has_the_variance_slope_and_correlation_asked_for() -> None:
    """Over many patches: <h(0)h(r)> = rms²·exp(−r²/ℓ²), of which the slope's variance along an axis
    is 2·rms²/ℓ²; and heights are normal, of kurtosis 3."""
    source = Roughness(rms=0.05, correlation=0.8, period=12.8)
    correlation, slope, kurtosis = [], [], []
    for seed in range(40):
        field = generated(source.model_copy(update={"seed": seed}), 0.1)
        h = field.heights
        assert np.sqrt(np.mean(h**2)) == pytest.approx(0.05)
        assert np.mean(h) == pytest.approx(0, abs=1e-12)
        correlation.append([np.mean(h * np.roll(h, n, axis=1)) / 0.05**2 for n in (4, 8, 12)])
        # Central differences of a wave of correlation ℓ: sin(fp)/(fp) less, 1.5 % at this pitch.
        difference = (np.roll(h, -1, axis=0) - np.roll(h, 1, axis=0)) / (2 * field.pitch[1])
        slope.append(np.mean(difference**2))
        kurtosis.append(np.mean(h**4) / 0.05**4)
    r = np.array([0.4, 0.8, 1.2])
    assert np.mean(correlation, axis=0) == pytest.approx(np.exp(-((r / 0.8) ** 2)), abs=0.03)
    assert np.mean(slope) == pytest.approx(2 * (0.05 / 0.8) ** 2, rel=0.06)
    assert np.mean(kurtosis) == pytest.approx(3, abs=0.15)


def test_a_field_of_too_many_samples_is_refused_before_it_is_made() -> None:
    source = Bumps(cell=(1000.0, 1000.0))
    with refused("bumps", "samples", (20000, 20000), "at most 16777216"):
        generated(source)
    with refused("roughness", "samples", (386_428_203,) * 2, "at most 16777216"):
        generated(Roughness(period=1e4, correlation=1e-4))


@pytest.mark.parametrize(("pitch", "samples"), [(0.02, 100), (0.021, 96), (0.0201, 100)])
def test_a_fields_pitch_may_be_asked_for(pitch: float, samples: int) -> None:
    """It becomes finer if that makes the samples a multiple of four and quick to transform."""
    field = generated(Cosine(period=2.0), pitch)
    assert field.heights.shape == (samples, samples)
    assert field.pitch == pytest.approx((2 / samples, 2 / samples))
