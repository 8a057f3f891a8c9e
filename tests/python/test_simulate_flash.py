"""Simulated photographs: what they must show, what noise does, and what is written beside them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from precompute.acquisition.capture import Capture, read_capture
from precompute.acquisition.highlight import mirror_point
from precompute.acquisition.observations import half_vectors
from precompute.acquisition.pattern import Gratings, gratings_of
from precompute.acquisition.photographs import Photo, read_photographs
from precompute.acquisition.simulate import Sheet, SmoothField, simulate_flash
from precompute.acquisition.simulation import read_simulation
from precompute.acquisition.view import View
from precompute.errors import InputError
from precompute.maps import Map

PERIOD = 1.66
LIGHT = (30.0, 20.0, 150.0)
FOIL: dict[str, Any] = {
    "kind": "foil",
    "design": "polygons",
    "size": 32,
    "tile_mm": 15,
    "polygons": 5,
    "orientations": 5,
    "periods": [PERIOD],
}
RECIPE: dict[str, Any] = {
    "kind": "flash-capture",
    "foil": "foil.json",
    "surface": {"size_mm": [60, 45]},
    "camera": {"position_mm": [0, 0, 300], "focal_px": 700, "channels": "grey"},
    "size_px": [160, 120],
    "photographs": [{"light": {"position_mm": list(LIGHT)}, "exposures_s": [0.001]}],
    "sensor": {"file": "exr"},
    "step_nm": 20,
    "subpixels": 1,
}
MATT = {"haze": 0.05, "table": 0.4, "size_mm": [60, 45]}


def simulate(folder: Path, recipe: dict[str, Any], name: str = "bench") -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "foil.json").write_text(json.dumps(FOIL))
    (folder / f"{name}.json").write_text(json.dumps(recipe))
    return simulate_flash(folder / f"{name}.json", folder / "out")


def with_fields(**fields: Any) -> dict[str, Any]:
    """The recipe with fields of its parts changed."""
    changed = json.loads(json.dumps(RECIPE))
    for name, value in fields.items():
        if isinstance(value, dict) and isinstance(changed.get(name), dict):
            changed[name] |= value
        else:
            changed[name] = value
    return changed


def photos(file: Path) -> list[Photo]:
    return list(read_photographs(read_capture(file, "flash"), file.parent))


@pytest.fixture(scope="module")
def ideal(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A capture without noise."""
    return simulate(tmp_path_factory.mktemp("ideal"), RECIPE)


def on_sample(capture: Capture) -> tuple[np.ndarray, np.ndarray]:
    """Where each pixel sees the plane, mm, shape (120, 160, 2), and whether that is the sheet."""
    y, x = np.mgrid[:120, :160]
    pixels = np.stack([x.ravel(), y.ravel()], axis=1).astype(float)
    xy = View.of(capture.camera, (160, 120)).on_sample(pixels).reshape(120, 160, 2)
    return xy, np.all(np.abs(xy) <= np.array(capture.sample.size_mm) / 2, axis=2)


# ---- Light ---------------------------------------------------------------------------------------


def test_the_highlight_is_where_the_mirror_law_puts_it(ideal: Path) -> None:
    capture, (photo,) = read_capture(ideal, "flash"), photos(ideal)
    xy, sheet = on_sample(capture)
    expected = mirror_point(np.array([0.0, 0.0, 300.0]), np.array(LIGHT))
    assert expected == pytest.approx([20, 40 / 3])  # 2/3 of the lamp's place
    near = sheet & (np.linalg.norm(xy - expected, axis=2) < 6)
    light = photo.values[..., 0] * near
    middle = (light[..., None] * xy).sum(axis=(0, 1)) / light.sum()
    assert middle == pytest.approx(expected, abs=0.4)  # a pixel is 0.43 mm


def test_pieces_are_lit_where_the_grating_equation_says(ideal: Path) -> None:
    """Bright pixels lie along a piece's grating vector, at mλ/a for some visible λ."""
    capture, (photo,) = read_capture(ideal, "flash"), photos(ideal)
    truth = gratings_of(Map.read(ideal.parent / "truth" / "foil.json"))
    xy, sheet = on_sample(capture)
    points = xy[sheet]
    h, _ = half_vectors(points, np.array([0.0, 0.0, 300.0]), np.array(LIGHT))
    ρ, φ = np.hypot(h[:, 0], h[:, 1]), np.arctan2(h[:, 1], h[:, 0])
    # By hand: rows of texels from the sheet's top left, 32 to 15 mm.
    column = np.floor((points[:, 0] + 30) * 32 / 15).astype(int) % 32
    row = np.floor((22.5 - points[:, 1]) * 32 / 15).astype(int) % 32
    θ, strength = truth.orientation[row, column], truth.strength[row, column]
    away = np.abs(ρ * np.sin(φ - θ))
    seen = photo.values[..., 0][sheet]
    haze = np.median(seen)
    beyond = ρ > 0.1
    bright = beyond & (seen > 20 * haze)
    assert bright.sum() > 50
    # Lobes: the lamp's 0.0122 and the window's 0.0038 at 0.55 µm, three standard deviations.
    assert np.all(away[bright] < 3.5 * 0.0135) and np.all(strength[bright] == 1)
    assert np.all(ρ[bright] > 0.4 / PERIOD - 3.5 * 0.0135)  # no colour below 0.4 µm to speak of
    lit = beyond & (strength == 1) & (away < 0.007) & (ρ > 0.45 / PERIOD) & (ρ < 0.62 / PERIOD)
    assert lit.sum() > 20
    assert np.all(seen[lit] > 20 * haze)


def test_matt_light_by_lambert(tmp_path: Path) -> None:
    """Full scale in a second is a white matt sheet at the middle: one of albedo 0.05 is 0.05."""
    rgb = with_fields(
        surface=MATT,
        camera={"channels": "rgb"},
        photographs=[{"light": {"position_mm": [0, 0, 150]}, "exposures_s": [1]}],
        size_px=[80, 60],
    )
    rgb["camera"]["focal_px"] = 260
    file = simulate(tmp_path, rgb)
    (photo,) = photos(file)
    capture = read_capture(file, "flash")
    y, x = np.mgrid[:60, :80]
    pixels = np.stack([x.ravel(), y.ravel()], axis=1).astype(float)
    xy = View.of(capture.camera, (80, 60)).on_sample(pixels)
    off = np.any(np.abs(xy) > [31, 23.5], axis=1)
    distance = np.hypot(150, np.linalg.norm(xy[off], axis=1))
    brightest = photo.values.reshape(-1, 3)[off].max(axis=1)
    # cosθ · (150/d)² with cosθ = 150/d.
    assert brightest == pytest.approx(0.4 * (150 / distance) ** 3, rel=1e-5)
    darkest = photo.values.reshape(-1, 3)[~off].min(axis=0).max()
    assert darkest == pytest.approx(0.05 * (150 / np.hypot(150, 37.5)) ** 3, rel=0.02)


def test_a_filter_takes_light_away(tmp_path: Path, ideal: Path) -> None:
    filtered = with_fields()
    filtered["photographs"][0]["filter"] = {"peak_um": 0.53, "fwhm_um": 0.03}
    file = simulate(tmp_path, filtered)
    assert read_capture(file, "flash").photographs[0].filter is not None
    before, after = photos(ideal)[0].values, photos(file)[0].values
    assert 0 < after.sum() < 0.3 * before.sum()


# ---- The sensor ----------------------------------------------------------------------------------


def test_exposures_multiply_and_files_clip(tmp_path: Path, ideal: Path) -> None:
    recipe = with_fields(sensor={"file": "tif", "bits": 16})
    recipe["photographs"][0]["exposures_s"] = [0.001, 0.1]
    file = simulate(tmp_path, recipe)
    capture = read_capture(file, "flash")
    assert capture.photographs[0].brackets is not None
    exposures = [bracket.exposure_s for bracket in capture.photographs[0].brackets]
    assert exposures == [0.001, 0.1]
    (merged,), (exact,) = photos(file), photos(ideal)
    unclipped = exact.values[..., 0] < 0.9 / 0.001
    # Rounding is half a step of the exposure that shows a pixel.
    short, long = 0.5 / 65535 / 0.001, 0.5 / 65535 / 0.1
    assert merged.values[unclipped] == pytest.approx(exact.values[unclipped], abs=1.02 * short)
    dim = exact.values[..., 0] < 1
    assert merged.values[dim] == pytest.approx(exact.values[dim], abs=2 * long)


def test_shot_and_read_noise_are_of_the_stated_electrons(tmp_path: Path, ideal: Path) -> None:
    """At x of white: variance x/full well + (read noise/full well)²."""
    exact = photos(ideal)[0].values[..., 0]
    recipe = with_fields(sensor={"full_well": 2000, "read_noise": 10})
    recipe["photographs"][0]["exposures_s"] = [0.5]
    noisy = photos(simulate(tmp_path, recipe))[0].values[..., 0] * 0.5
    x = exact * 0.5
    deviation = np.sqrt(x / 2000 + (10 / 2000) ** 2)
    normal = (noisy - x) / deviation
    # Of 19200 pixels: standard errors of the mean 0.007, of the variance 0.01.
    assert np.mean(normal) == pytest.approx(0, abs=0.03)
    assert np.var(normal) == pytest.approx(1, abs=0.05)
    for part in (x < np.quantile(x, 0.3), x > np.quantile(x, 0.7)):
        assert np.var(normal[part]) == pytest.approx(1, abs=0.08)


def test_noise_in_decibels_is_even(tmp_path: Path, ideal: Path) -> None:
    recipe = with_fields(sensor={"noise_db": 40})
    noisy = photos(simulate(tmp_path, recipe))[0].values * 0.001
    rest = noisy - photos(ideal)[0].values * 0.001
    assert np.std(rest) == pytest.approx(0.01, rel=0.03)
    assert np.mean(rest) == pytest.approx(0, abs=3e-4)


# ---- The sheet -----------------------------------------------------------------------------------


def sheet(**fields: Any) -> Sheet:
    """Four by three tiles of 10 mm with 10 × 10 texels, nothing off."""
    size, none = np.array([40.0, 30.0]), np.zeros((10, 10))
    rng = np.random.default_rng(1)
    still = {
        "size": size,
        "tile": np.array([10.0, 10.0]),
        "gratings": Gratings(none, none, none),
        "shifts": np.zeros((3, 4, 2)),
        "warp": SmoothField(rng, size, 5.0, 0.0),
        "slopes": SmoothField(rng, size, 5.0, 0.0),
    }
    return Sheet(**(still | fields))


def test_a_shifted_tile_shows_the_pattern_elsewhere() -> None:
    """What the tile in the first row and second column showed at x it shows at x + shift."""
    shifts = np.zeros((3, 4, 2))
    shifts[0, 1] = [2, -3]
    moved, still = sheet(shifts=shifts), sheet()
    point = np.array([[-6.5, 11.5]])  # in column 1 (−10 to 0) and row 0 (5 to 15)
    assert still.texels(point).tolist() == [3 * 10 + 3]
    assert moved.texels(point + np.array([2, -3])).tolist() == [3 * 10 + 3]
    beside = np.array([[6.5, 11.5], [-6.5, 1.5]])
    assert moved.texels(beside).tolist() == still.texels(beside).tolist()


def test_smooth_fields_have_their_deviation_and_width() -> None:
    field = SmoothField(np.random.default_rng(2), np.array([400.0, 300.0]), 5.0, 0.3)
    points = np.random.default_rng(3).uniform(-0.5, 0.5, (4000, 2)) * [400, 300]
    values = field.at(points)
    assert values.std(axis=0) == pytest.approx([0.3, 0.3], rel=0.1)
    # White noise blurred by a Gaussian of σ is correlated over d by exp(−d²/4σ²).
    for distance, correlation in ((5, np.exp(-1 / 4)), (10, np.exp(-1)), (25, 0)):
        beside = field.at(points + np.array([distance, 0]))
        found = np.mean(values * beside, axis=0) / np.mean(values**2, axis=0)
        assert found == pytest.approx([correlation] * 2, abs=0.16)
    assert np.corrcoef(*values.T)[0, 1] == pytest.approx(0, abs=0.16)


# ---- Files ---------------------------------------------------------------------------------------


def test_the_truth_is_beside_the_photographs(tmp_path: Path) -> None:
    recipe = with_fields(surface={"shift_mm": 0.7}, size_px=[40, 30])
    recipe["camera"]["focal_px"] = 170
    file = simulate(tmp_path, recipe)
    assert Map.read(file.parent / "truth" / "foil.json").constants["tile_mm"] == (15, 15)
    shifts = np.array(json.loads((file.parent / "truth" / "tiles.json").read_text())["shifts_mm"])
    assert shifts.shape == (3, 4, 2)
    assert shifts[1, 1].tolist() == [0, 0]  # the reference tile
    # All were 0.7 mm off before the reference tile's was taken away: they lie on a circle through 0
    # about minus that, |s − c| = |c|.
    others = np.delete(shifts.reshape(-1, 2), 5, axis=0)
    centre = np.linalg.lstsq(2 * others, np.sum(others**2, axis=1))[0]
    assert np.linalg.norm(centre) == pytest.approx(0.7)
    assert np.linalg.norm(others - centre, axis=1) == pytest.approx([0.7] * 11)


def test_the_capture_says_where_sample_and_tile_are_seen(ideal: Path) -> None:
    capture = read_capture(ideal, "flash")
    photograph = capture.photographs[0]
    assert photograph.light is not None and photograph.light.position_mm == LIGHT
    scale = 700 / 300
    corners = [(-30, 22.5), (30, 22.5), (30, -22.5), (-30, -22.5)]
    expected = [(79.5 + scale * x, 59.5 - scale * y) for x, y in corners]
    assert np.array(photograph.corners_px) == pytest.approx(np.array(expected), abs=1e-3)
    # The tile in the second row of three and the second column of four.
    tile = [(-15, 7.5), (0, 7.5), (0, -7.5), (-15, -7.5)]
    expected = [(79.5 + scale * x, 59.5 - scale * y) for x, y in tile]
    assert np.array(capture.sample.reference_tile_px) == pytest.approx(np.array(expected), abs=1e-3)
    assert capture.sample.tile_mm == (15, 15)


def test_the_capture_keeps_to_itself_what_is_omitted(tmp_path: Path) -> None:
    omit = [
        "camera.position_mm",
        "camera.focal_px",
        "camera.spectral_response_csv",
        "photographs.corners_px",
        "sample.tile_mm",
        "sample.reference_tile_px",
    ]
    recipe = with_fields(omit=omit, size_px=[20, 15])
    capture = read_capture(simulate(tmp_path, recipe), "flash")
    assert capture.camera.position_mm is None and capture.camera.focal_px is None
    assert capture.camera.spectral_response_csv is None
    assert capture.photographs[0].corners_px is None
    assert capture.sample.tile_mm is None and capture.sample.reference_tile_px is None
    assert not (tmp_path / "out" / "bench" / "camera.csv").exists()


def test_the_same_seed_gives_the_same_files(tmp_path: Path) -> None:
    recipe = with_fields(
        surface={"shift_mm": 0.5, "bumps_deg": 0.5, "warp_mm": 0.2},
        sensor={"file": "tif", "full_well": 1000, "read_noise": 5},
        size_px=[40, 30],
    )
    one, two, three = (
        simulate(tmp_path / name, recipe | {"seed": seed})
        for name, seed in (("a", 7), ("b", 7), ("c", 8))
    )
    names = sorted(f.relative_to(one.parent) for f in one.parent.rglob("*") if f.is_file())
    for name in names:
        assert (one.parent / name).read_bytes() == (two.parent / name).read_bytes(), name
    for name in ("flash-0.tif", "truth/tiles.json"):
        assert (one.parent / name).read_bytes() != (three.parent / name).read_bytes()


# ---- Recipes -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"camera": {"position_mm": None}}, "camera.position_mm and camera.focal_px"),
        ({"camera": {"focal_px": None}}, "camera.position_mm and camera.focal_px"),
        ({"camera": {"response": "srgb"}}, "a linear response for exr"),
        ({"sensor": {"noise_db": 40, "full_well": 100}}, "full_well or noise_db"),
        ({"sensor": {"read_noise": 4}}, "in whose electrons"),
        ({"surface": {"haze": 1.5}}, "surface.haze"),
        ({"step_nm": 21}, "step_nm"),
        ({"omit": ["sample.size_mm"]}, "omit"),
        ({"photographs": []}, "photographs"),
        ({"flash": 1}, "flash"),
    ],
)
def test_recipes_that_cannot_be_simulated(
    tmp_path: Path, change: dict[str, Any], said: str
) -> None:
    (tmp_path / "bench.json").write_text(json.dumps(with_fields(**change)))
    with pytest.raises(InputError) as caught:
        read_simulation(tmp_path / "bench.json")
    assert said in str(caught.value)


def test_a_recipe_that_is_no_foils(tmp_path: Path) -> None:
    (tmp_path / "metals.json").write_text('{"kind": "metals"}')
    with pytest.raises(InputError, match="the recipe of a foil"):
        simulate(tmp_path, with_fields(foil="metals.json"))
