"""From a file to a patch that repeats: levelled, mended, cropped, tiled, resampled, or refused."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from refusals import refused
from shared_data import SHARED, needs_shared_data

from precompute.errors import InputError
from precompute.height_fields.field import HeightField
from precompute.height_fields.levelling import levelled, with_rows_mended
from precompute.height_fields.prepare import cropped, mirrored, prepared
from precompute.height_fields.recipe import Crop, FileSource, HeightFieldRecipe, Level
from precompute.height_fields.sampling import (
    QUARTER_WAVE,
    grid_size,
    height_steps,
    refuse_undersampled,
    resampled,
)
from precompute.height_fields.spectrum import dominant_frequency, power_spectrum
from precompute.recipes import read_recipe

SIDE, PITCH = 96, 0.05


def wave(
    periods: tuple[float, float] = (6, 0),
    amplitude: float = 0.1,
    samples: int = SIDE,
    side: float = SIDE * PITCH,
    phase: float = 0.0,
) -> HeightField:
    """A cosine with so many periods along x and y of a square patch."""
    t = np.arange(samples) / samples
    angle = 2 * np.pi * (periods[0] * t + periods[1] * t[:, None]) + phase
    return HeightField(amplitude * np.cos(angle), (side / samples, side / samples))


def recipe(folder: Path, field: HeightField, **settings: Any) -> HeightFieldRecipe:
    """A recipe whose file holds the field, as numbers in µm from the top row down."""
    np.save(folder / "field.npy", field.heights[::-1])
    scale = {"pitch_um": field.pitch, "height_um": 1.0}
    source = {"kind": "file", "path": "field.npy", **scale, **settings.pop("source", {})}
    return HeightFieldRecipe.model_validate({"kind": "height-field", "source": source, **settings})


# Levelling


@pytest.mark.parametrize("level", ["none", "mean", "plane", 2, 3, 5])
def test_a_file_is_freed_of_what_its_level_says_and_of_no_more(level: Level) -> None:
    """Of waves that hold whole periods hardly anything is a low polynomial."""
    field = wave((9, 8), samples=64)
    x, y = np.meshgrid(np.linspace(-1, 1, 64), np.linspace(-1, 1, 64))
    orders = {"none": -1, "mean": 0, "plane": 1}
    order = orders[level] if isinstance(level, str) else level
    added = sum(0.3 * x**i * y ** (n - i) for n in range(order + 1) for i in range(n + 1))
    assert levelled(field.heights + added, level) == pytest.approx(
        levelled(field.heights, level), abs=1e-12
    )
    assert levelled(field.heights, level) == pytest.approx(field.heights, abs=0.01)
    # Of x^(n+1) at least 2^−n remains, Chebyshev's bound.
    assert np.abs(levelled(x ** (order + 1), level)).max() > 0.99 * 2.0 ** -max(order, 0)


def test_files_are_levelled_by_a_plane_unless_they_hold_whole_periods(tmp_path: Path) -> None:
    field = wave()
    tilt = 0.02 * np.add.outer(np.arange(SIDE), np.arange(SIDE)) / SIDE
    tilted = HeightField(field.heights + tilt, field.pitch)
    found = prepared(recipe(tmp_path, tilted), tmp_path)
    assert found.heights == pytest.approx(levelled(field.heights, "plane"), abs=1e-12)
    whole = recipe(tmp_path, tilted, source={"whole_periods": True})
    assert prepared(whole, tmp_path).heights == pytest.approx(tilted.heights)
    explicit = recipe(tmp_path, tilted, source={"whole_periods": True}, level="plane")
    assert prepared(explicit, tmp_path).heights == pytest.approx(found.heights)


# Outlier rows


@settings(max_examples=40, deadline=None)
@given(
    periods=st.tuples(st.integers(0, 8), st.integers(0, 8)).filter(any),
    noise=st.floats(0, 0.01),
    places=st.sets(st.integers(1, SIDE // 4 - 2), min_size=1, max_size=4),
    kind=st.sampled_from(["offset", "noise", "dead"]),
    seed=st.integers(0, 99),
)
def test_lines_that_went_astray_are_interpolated(
    periods: tuple[int, int], noise: float, places: set[int], kind: str, seed: int
) -> None:
    """Lines with three good ones or more between them."""
    rng = np.random.default_rng(seed)
    rows = [4 * place for place in places]
    clean = wave(periods).heights + noise * rng.standard_normal((SIDE, SIDE))
    spoilt = clean.copy()
    for row in rows:
        if kind == "offset":
            spoilt[row] += rng.choice([-1, 1]) * rng.uniform(0.2, 1)
        elif kind == "noise":
            spoilt[row] += 0.3 * rng.standard_normal(SIDE)
        else:
            spoilt[row] = 1.0
    mended = with_rows_mended("x", spoilt)
    astray = np.isin(np.arange(SIDE), rows)
    # A cosine's bend between its neighbours, ½h″.
    bend = 0.1 * (2 * np.pi * periods[1] / SIDE) ** 2 / 2
    assert np.abs(mended - clean)[astray].max() <= bend + 9 * noise + 1e-12


@settings(max_examples=40, deadline=None)
@given(
    periods=st.tuples(st.integers(0, 9), st.integers(0, 9)).filter(any),
    noise=st.floats(0, 0.02),
    seed=st.integers(0, 99),
)
def test_clean_lines_are_left_alone(periods: tuple[int, int], noise: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    clean = wave(periods).heights + noise * rng.standard_normal((SIDE, SIDE))
    assert np.array_equal(with_rows_mended("x", clean), clean)


def test_a_scan_with_too_many_lines_astray_is_refused(tmp_path: Path) -> None:
    field = wave()
    heights = field.heights.copy()
    heights[20:50] += np.random.default_rng(1).standard_normal((30, SIDE))
    asked = recipe(tmp_path, HeightField(heights, field.pitch), outlier_rows=True)
    with refused(tmp_path / "field.npy", "outlier_rows", "more than that", "at most 24 scan lines"):
        prepared(asked, tmp_path)

    few = recipe(tmp_path, HeightField(field.heights[:3], field.pitch), outlier_rows=True)
    with refused(tmp_path / "field.npy", "outlier_rows", "3 scan lines", "four or more"):
        prepared(few, tmp_path)


# Crop and tiling


def test_a_crop_counts_from_the_lower_left_corner(tmp_path: Path) -> None:
    heights = np.arange(40.0).reshape(5, 8)
    field = HeightField(heights, (0.1, 0.2))
    part = cropped("x", field, Crop(x=0.2, y=0.4, width=0.3, height=0.6))
    assert part.heights.tolist() == heights[2:5, 2:5].tolist()
    assert part.pitch == field.pitch
    assert cropped("x", field, Crop(x=0, y=0, width=0.8, height=1)).heights.shape == (5, 8)
    for outside in (
        Crop(x=0.6, y=0, width=0.3, height=0.4),
        Crop(x=0, y=0.8, width=0.3, height=0.4),
        Crop(x=0, y=0, width=0.1, height=0.4),
    ):
        with refused("x", "crop", outside.model_dump(), "the patch of 0.8 um by 1 um"):
            cropped("x", field, outside)
    # Through a recipe, of a file whose top row comes first.
    whole = wave((6, 6), amplitude=0.02)
    asked = recipe(tmp_path, whole, crop={"x": 1, "y": 2, "width": 2, "height": 2.4})
    found = prepared(asked, tmp_path).heights
    assert found == pytest.approx(levelled(whole.heights, "plane")[40:88, 20:60])


def test_a_crop_without_relief_is_refused(tmp_path: Path) -> None:
    field = wave()
    heights = field.heights.copy()
    heights[:40, :40] = 0.02
    crop = {"x": 0, "y": 0, "width": 1.5, "height": 1.5}
    asked = recipe(tmp_path, HeightField(heights, field.pitch), crop=crop, level="none")
    with refused(tmp_path / "field.npy", "heights", "all equal", "within the crop"):
        prepared(asked, tmp_path)


@given(rows=st.integers(2, 9), columns=st.integers(2, 9), seed=st.integers(0, 99))
def test_a_mirrored_patch_is_even_and_has_no_seam(rows: int, columns: int, seed: int) -> None:
    heights = np.random.default_rng(seed).standard_normal((rows, columns))
    field = mirrored("x", HeightField(heights, (0.1, 0.2)))
    assert field.period == pytest.approx((0.2 * columns, 0.4 * rows))
    assert np.array_equal(field.heights[:rows, :columns], heights)
    for axis in (0, 1):
        assert np.array_equal(field.heights, np.flip(field.heights, axis))
        # Where the patch meets its repeat, and itself reflected, the height does not change.
        change = np.diff(np.concatenate([field.heights] * 2, axis), axis=axis)
        size = (rows, columns)[axis]
        assert np.abs(np.take(change, [size - 1, 2 * size - 1], axis)).max() == 0


# Resampling


@pytest.mark.parametrize("pitch", [0.012, 0.03, 0.05, 0.07])
def test_resampling_keeps_waves_that_both_pitches_resolve(pitch: float) -> None:
    field = wave((5, 3), phase=0.4)
    found = resampled("x", field, pitch)
    size = grid_size(SIDE * PITCH, pitch)
    assert found.heights.shape == (size, size)
    assert found.heights == pytest.approx(wave((5, 3), phase=0.4, samples=size).heights, abs=1e-12)
    assert found.period == pytest.approx(field.period)


def test_resampling_to_a_coarser_pitch_drops_what_it_cannot_hold() -> None:
    coarse, fine = wave((5, 3)), wave((40, 0), amplitude=0.2)
    both = HeightField(coarse.heights + fine.heights, coarse.pitch)
    found = resampled("x", both, 0.1).heights
    assert found == pytest.approx(wave((5, 3), samples=48).heights, abs=1e-12)


@given(length=st.floats(0.5, 500), pitch=st.floats(0.001, 0.1))
def test_grids_are_no_coarser_than_asked_and_little_finer(length: float, pitch: float) -> None:
    size = grid_size(length, pitch)
    assert length / size <= pitch * (1 + 1e-8)
    assert size % 4 == 0
    rest = size
    for prime in (2, 3, 5):
        while rest % prime == 0:
            rest //= prime
    assert rest == 1
    assert size <= 2 * length / pitch + 4


def test_a_file_far_finer_than_theory_asks_is_coarsened_and_others_are_kept(tmp_path: Path) -> None:
    """0.095 µm is asked for where slopes are small; 0.025 is kept, 0.01 made half of what is."""
    for samples, expected in ((192, 192), (480, grid_size(4.8, QUARTER_WAVE / 2))):
        field = wave((5, 3), amplitude=0.05, samples=samples)
        found = prepared(recipe(tmp_path, field, level="none"), tmp_path)
        assert found.heights.shape == (expected, expected)
        again = wave((5, 3), amplitude=0.05, samples=expected)
        assert found.heights == pytest.approx(again.heights, abs=1e-12)
    asked = recipe(tmp_path, wave((5, 3), samples=480), level="none", pitch=0.01)
    assert prepared(asked, tmp_path).heights.shape == (480, 480)


def test_pixels_need_not_be_square(tmp_path: Path) -> None:
    heights = wave((6, 0), samples=80).heights[:60]
    found = prepared(recipe(tmp_path, HeightField(heights, (0.06, 0.04)), level="none"), tmp_path)
    assert found.pitch == (0.06, 0.04)
    assert found.period == pytest.approx((4.8, 2.4))
    assert dominant_frequency(found) == pytest.approx((6 / 4.8, 0))


# What is refused


def test_a_pitch_too_coarse_for_the_spectrum_is_refused_with_one_that_will_do(
    tmp_path: Path,
) -> None:
    """λ_min/4 = 0.095 µm, and it is what is named where slopes are small, less a tenth."""
    coarse = wave((5, 0), amplitude=0.01, samples=48)
    with refused(tmp_path / "field.npy", "pitch", 0.1, "at most 0.0807 um"):
        prepared(recipe(tmp_path, coarse, level="none"), tmp_path)
    asked = recipe(tmp_path, coarse, level="none", pitch=0.0807)
    assert prepared(asked, tmp_path).heights == pytest.approx(
        wave((5, 0), amplitude=0.01, samples=60).heights, abs=1e-12
    )
    refuse_undersampled("x", HeightField(coarse.heights, (0.095, 0.095)))
    with refused("x", "pitch", 0.0951, "at most"):
        refuse_undersampled("x", HeightField(coarse.heights, (0.05, 0.0951)))


@settings(max_examples=20, deadline=None)
@given(height=st.floats(0.1, 0.4), width=st.integers(3, 25), tiling=st.sampled_from(["p", "m"]))
def test_the_pitch_named_for_a_slope_will_do(height: float, width: int, tiling: str) -> None:
    """Even for a step from one sample to the next, whose interpolation is steeper than it shows."""
    heights = np.zeros((32, 32))
    heights[10 : 10 + width // 2, 5 : 5 + width] = height
    field = HeightField(heights, (0.05, 0.05))
    field = mirrored("x", field) if tiling == "m" else field
    with pytest.raises(InputError) as caught:
        refuse_undersampled("x", field)
    error = caught.value
    assert (error.file, error.field) == ("x", "slope")
    named = re.search(r"a pitch of at most ([0-9.]+) um", error.expected)
    assert named
    refuse_undersampled("x", resampled("x", field, float(named[1])))


def test_a_slope_is_too_steep_where_a_phase_turns_by_half_a_circle_between_samples() -> None:
    """k w Δh = π at w = 2 and 0.38 µm for Δh = 0.095 µm, along x and y together."""
    ramp = np.array([0.0, 1, 2, 3, 4, 3, 2, 1])
    for slopes, step in ((np.tile(ramp, (8, 1)), 1.0), (np.add.outer(ramp, ramp), np.sqrt(2))):
        assert height_steps(slopes).max() == pytest.approx(step)
        refuse_undersampled("x", HeightField(0.0949 / step * slopes, (0.05, 0.05)))
        with refused("x", "slope", 1.902, "less than 1.9 at this pitch"):
            refuse_undersampled("x", HeightField(0.0951 / step * slopes, (0.05, 0.05)))


def test_where_only_the_seam_is_too_steep_mirroring_is_named_and_mends_it(tmp_path: Path) -> None:
    field = wave((6.5, 3))
    with refused(tmp_path / "field.npy", "tiling", "periodic", "mirrored: where the patch meets"):
        prepared(recipe(tmp_path, field, level="none"), tmp_path)
    asked = recipe(tmp_path, field, level="none", tiling="mirrored")
    found = prepared(asked, tmp_path)
    assert found.heights.shape == (2 * SIDE, 2 * SIDE)


@pytest.mark.parametrize("phase", np.linspace(0, 2 * np.pi, 8, endpoint=False))
def test_a_patch_of_fewer_than_two_periods_is_refused(tmp_path: Path, phase: float) -> None:
    for held in (2, 3.5, 7):
        field = wave((held, 0), amplitude=0.03, phase=phase)
        prepared(recipe(tmp_path, field, tiling="mirrored"), tmp_path)
    field = wave((1, 0), amplitude=0.03, phase=phase)
    with pytest.raises(InputError) as caught:
        prepared(recipe(tmp_path, field), tmp_path)
    error = caught.value
    assert (error.file, error.field) == (str(tmp_path / "field.npy"), "periods")
    assert isinstance(error.value, float) and error.value < 1.6
    assert "two or more of the dominant period" in error.expected
    whole = recipe(tmp_path, field, source={"whole_periods": True})
    assert prepared(whole, tmp_path).heights == pytest.approx(field.heights)


def test_too_large_a_patch_is_refused() -> None:
    field = wave((6, 0))
    with refused("x", "samples", (24000, 24000), "at most 16777216"):
        resampled("x", field, 0.0002)
    wide = HeightField(np.broadcast_to(np.zeros(1), (4096, 2050)), (0.05, 0.05))
    with refused("x", "samples", (4100, 8192), "at most 16777216"):
        mirrored("x", wide)


# Power spectrum


def test_lines_of_a_power_spectrum_have_the_variance_of_their_waves() -> None:
    field = wave((5, 3), amplitude=0.1)
    power = power_spectrum(HeightField(field.heights + 7, field.pitch))
    assert power[3, 5] == power[-3, -5] == pytest.approx(0.1**2 / 4)
    assert power.sum() == pytest.approx(0.1**2 / 2)


@settings(max_examples=40, deadline=None)
@given(x=st.floats(-12, 12), y=st.floats(-12, 12), phase=st.floats(0, 6.3))
def test_the_strongest_frequency_of_a_patch_that_does_not_repeat_is_found_between_the_lines(
    x: float, y: float, phase: float
) -> None:
    """To a twentieth of a line, where the wave and its mirror image do not run into each other."""
    assume(np.hypot(x, y) > 4)
    field = wave((x, y), phase=phase)
    found = np.array(dominant_frequency(field, windowed=True)) * SIDE * PITCH
    true = np.array([x, y])
    assert min(np.abs(found - true).max(), np.abs(found + true).max()) < 0.05
    assert tuple(found) > (0, 0)


# Recipes


@pytest.mark.parametrize(
    ("change", "field", "value", "expected"),
    [
        ({"source": {"kind": "dunes"}}, "source.kind", "dunes", "'bumps'"),
        ({"source": {"kind": "bumps", "height": -1}}, "source.height", -1, "0.0001"),
        ({"source": {"kind": "bumps", "cell": [0.5, 2]}}, "source.cell", [0.5, 2], "no smaller"),
        ({"source": {"kind": "blazed", "edge": 3}}, "source.edge", 3, "less than the period"),
        ({"source": {"kind": "pits", "runs": [5, 5]}}, "source.runs", [5, 5], "shorter"),
        ({"source": {"kind": "pits", "bits": 40}}, "source.bits", 40, "44 channel bits"),
        ({"source": {"kind": "pits", "edge": 0.6}}, "source.edge", 0.6, "0.5 um"),
        ({"source": {"kind": "pits", "seed": -1}}, "source.seed", -1, "greater than or equal"),
        ({"source": {"kind": "fingers", "spacing": 3}}, "source.spacing", 3, "the length"),
        ({"source": {"kind": "roughness", "period": 5}}, "source.period", 5, "eight"),
        ({"source": {"kind": "file"}}, "source.path", None, "missing"),
        (
            {"source": {"kind": "file", "path": "x", "pitch_um": 0}},
            "source.pitch_um",
            0,
            "0.0001",
        ),
        ({"level": 6}, "level", 6, "the order of a polynomial, 2 to 5"),
        ({"level": True}, "level", True, "none, mean, plane"),
        ({"level": "flat"}, "level", "flat", "none, mean, plane"),
        ({"level": "plane", "source": {"kind": "bumps"}}, "level", "plane", "generated (bumps)"),
        ({"outlier_rows": True, "source": {"kind": "pits"}}, "outlier_rows", True, "generated"),
        ({"crop": {"x": -1, "y": 0, "width": 1, "height": 1}}, "crop.x", -1, "greater than or"),
        ({"tiling": "torn"}, "tiling", "torn", "'mirrored'"),
        ({"methods": []}, "methods", [], "at least 1 item"),
        ({"methods": ["taylor", "taylor"]}, "methods", ["taylor", "taylor"], "each method once"),
        ({"methods": ["fourier"]}, "methods.0", "fourier", "'jacobi-anger'"),
        ({"terms": 0}, "terms", 0, "greater than or equal to 1"),
        ({"error": 0}, "error", 0, "greater than 0"),
        ({"roughness": -0.1}, "roughness", -0.1, "greater than or equal to 0"),
        ({"metal": "tin"}, "metal", "tin", "'aluminium'"),
        ({"pich": 1}, "pich", 1, "no such field"),
    ],
)
def test_each_bad_field_of_a_recipe_is_named(
    tmp_path: Path, change: dict[str, Any], field: str, value: object, expected: str
) -> None:
    contents = {"kind": "height-field", "source": {"kind": "file", "path": "x.npy"}, **change}
    file = tmp_path / "recipe.json"
    file.write_text(json.dumps(contents))
    with refused(file, field, value, expected):
        read_recipe(file)


def test_a_recipe_of_one_line_has_sensible_defaults(tmp_path: Path) -> None:
    file = tmp_path / "recipe.json"
    file.write_text('{"kind": "height-field", "source": {"kind": "fingers"}}')
    found = read_recipe(file)
    assert isinstance(found, HeightFieldRecipe)
    assert found.methods == ("jacobi-anger",)
    assert prepared(found, tmp_path).period == pytest.approx((6 * 2.2, 17 * 0.8))
    for tiling, times in (("periodic", 1), ("mirrored", 2)):
        other = found.model_copy(update={"tiling": tiling, "pitch": 0.08})
        assert prepared(other, tmp_path).period == pytest.approx((times * 13.2, times * 13.6))


def test_a_pitch_may_be_one_number_or_two() -> None:
    source = {"kind": "file", "path": "x.png", "height_um": 0.3}
    for given_pitch, expected in ((0.05, (0.05, 0.05)), ([0.05, 0.06], (0.05, 0.06))):
        found = FileSource.model_validate({**source, "pitch_um": given_pitch})
        assert found.pitch_um == expected
        # What a map's sidecar says of its recipe is a recipe again.
        assert FileSource.model_validate(json.loads(found.model_dump_json())) == found


# Real scans


def real(path: str, **settings: Any) -> HeightField:
    scale = {} if path.endswith(".nid") else {"pitch_um": 0.09, "height_um": 0.15}
    source = {"kind": "file", "path": path, **scale}
    contents = {"kind": "height-field", "source": source, **settings}
    return prepared(HeightFieldRecipe.model_validate(contents), SHARED)


@needs_shared_data
def test_a_real_grating_at_45_degrees_has_its_period_along_both_axes() -> None:
    field = real("afm/grid.nid", tiling="mirrored", outlier_rows=True)
    assert field.period == pytest.approx((6, 6))
    # Mirrored, +45° and −45° are alike.
    x, y = dominant_frequency(field)
    assert abs(x) == pytest.approx(abs(y), rel=0.1)
    assert 1 / np.hypot(x, y) == pytest.approx(0.3, abs=0.02)


@needs_shared_data
@pytest.mark.parametrize("name", ["Elaph", "Xeno"])
def test_real_skins_are_prepared_at_a_pitch_they_do_not_say(name: str) -> None:
    path = f"height_fields/{name}100x100.png"
    for tiling, side in (("periodic", 9.0), ("mirrored", 18.0)):
        assert real(path, tiling=tiling).period == pytest.approx((side, side))


@needs_shared_data
def test_real_pits_are_too_coarse_until_they_are_interpolated() -> None:
    file = SHARED / "afm" / "circles.nid"
    crop = {"x": 0, "y": 0, "width": 24, "height": 24}
    with refused(file, "pitch", 0.195312, "a pitch in the recipe, to interpolate"):
        real("afm/circles.nid", crop=crop, tiling="mirrored")
    field = real("afm/circles.nid", crop=crop, tiling="mirrored", pitch=0.03)
    assert max(field.pitch) <= 0.03
