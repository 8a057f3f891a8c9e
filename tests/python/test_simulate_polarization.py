"""Simulated polarisation photographs: what they must show, and what is written beside them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from precompute.acquisition.capture import read_capture
from precompute.acquisition.pattern import gratings_of
from precompute.acquisition.photographs import read_photographs
from precompute.acquisition.polarization_simulation import read_polarization_simulation
from precompute.acquisition.simulate_polarization import Pose, simulate_polarization
from precompute.cli import app
from precompute.errors import InputError
from precompute.maps import Map
from precompute.spectra import refractive_index

FOIL: dict[str, Any] = {
    "kind": "foil",
    "design": "polygons",
    "size": 32,
    "tile_mm": 32,
    "polygons": 6,
    "orientations": 6,
    "periods": [1.2, 1.8],
    "border": 0.02,
}
R, ζ = 1.3, np.deg2rad(150)
# Each pixel shows a texel, at all but right angles: 32 mm from 10 m away.
RECIPE: dict[str, Any] = {
    "kind": "polarization-capture",
    "foil": "foil.json",
    "metal": {"ratio": {"r": R, "zeta_deg": 150}},
    "plastic": {"first_surface": 0},
    "sheet": {"size_mm": [32, 32], "haze": 0, "table": 0},
    "panel": {"position_mm": [0, 0, 10000], "radius_mm": 2000, "falloff": 0},
    "camera": {"position_mm": [0, 0, 10000], "focal_px": 10000, "channels": "grey"},
    "filter": {"peak_um": 0.55, "fwhm_um": 0.001},
    "size_px": [32, 32],
    "polariser_deg": [0, 30, 75, 110],
    "exposures_s": [0.25],
    "subpixels": 1,
    "sensor": {"file": "exr"},
}


def with_fields(**fields: Any) -> dict[str, Any]:
    """The recipe with fields of its parts changed."""
    changed = json.loads(json.dumps(RECIPE))
    for name, value in fields.items():
        if isinstance(value, dict) and isinstance(changed.get(name), dict):
            changed[name] |= value
        else:
            changed[name] = value
    return changed


def simulate(folder: Path, recipe: dict[str, Any], foil: dict[str, Any] = FOIL) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "foil.json").write_text(json.dumps(foil))
    (folder / "bench.json").write_text(json.dumps(recipe))
    return simulate_polarization(folder / "bench.json", folder / "out")


def photos(file: Path) -> np.ndarray:
    """Light of all photographs, shape (photographs, height, width)."""
    capture = read_capture(file, "polarization")
    return np.stack([p.values[..., 0] for p in read_photographs(capture, file.parent)])


def truth(file: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """θ, period over the longest, and what diffracts, at each of the 32 × 32 texels."""
    gratings = gratings_of(Map.read(file.parent / "truth" / "foil.json"))
    diffracts = gratings.strength > 0
    period = gratings.frequency[diffracts].min() / gratings.frequency
    return gratings.orientation, period, diffracts


@pytest.fixture(scope="module")
def ideal(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return simulate(tmp_path_factory.mktemp("ideal"), RECIPE)


# ---- Light ---------------------------------------------------------------------------------------


def test_pixels_follow_the_closed_form(ideal: Path) -> None:
    """Eq. 9 for ψ − θ, times the square of the period; mirrors between the pieces stay at 1."""
    θ, period, diffracts = truth(ideal)
    assert len(np.unique(period[diffracts].round(3))) == 2 and (~diffracts).sum() > 50
    for seen, ψ in zip(photos(ideal), np.deg2rad([0, 30, 75, 110]), strict=True):
        expected = (1 + R**2) / 2 + (1 - R**2) / 2 * np.cos(2 * (ψ - θ))
        expected -= R * np.sin(ζ) * np.sin(2 * (ψ - θ))
        expected = np.where(diffracts, expected * period**2, 1)
        # 8 bits of the map's cos 2θ and 1/a: a part in 255 of each.
        assert seen == pytest.approx(expected, abs=0.03)
        assert np.sqrt(np.mean((seen - expected) ** 2)) < 0.008
        assert seen[~diffracts] == pytest.approx(1, abs=1e-5)


def test_phases_are_orientations_up_to_the_offset(ideal: Path) -> None:
    θ, _, diffracts = truth(ideal)
    ψ = np.deg2rad([0, 30, 75, 110])
    basis = np.stack([np.ones(4), np.cos(2 * ψ), np.sin(2 * ψ)], axis=1)
    fit = np.linalg.lstsq(basis, photos(ideal).reshape(4, -1))[0].reshape(3, 32, 32)
    phase = np.arctan2(fit[2], fit[1])
    told = json.loads((ideal.parent / "truth" / "polarization.json").read_text())
    off = np.angle(np.exp(2j * (phase / 2 + np.deg2rad(told["offset_deg"]) - θ)))[diffracts] / 2
    assert np.abs(off).max() < np.deg2rad(0.35)  # the map's 8 bits


def test_tiles_start_at_the_sheet_s_top_left(tmp_path: Path, ideal: Path) -> None:
    larger = with_fields(sheet={"size_mm": [40, 50]}, size_px=[40, 50])
    seen = photos(simulate(tmp_path, larger))
    tile = np.pad(photos(ideal), ((0, 0), (0, 18), (0, 8)), mode="wrap")
    assert seen == pytest.approx(tile, abs=1e-4)


def test_metals_and_plastic_reach_the_picture(tmp_path: Path, ideal: Path) -> None:
    """Fresnel's ratio for iron at 10° modulates by 2 sin²φ/|nN| or so; a retarder by sin 2Δ."""
    iron = photos(simulate(tmp_path / "a", with_fields(metal={"kind": "iron", "ratio": None})))
    _, period, diffracts = truth(ideal)
    swing = np.ptp(iron / period**2, axis=0)[diffracts]
    expected = 2 * np.sin(np.deg2rad(10)) ** 2 / (1.468 * abs(2.95 + 2.93j))
    assert 0.5 * expected < swing.mean() < 2 * expected  # four angles meet no extremes
    retarder = with_fields(plastic={"retardation_deg": 5, "axis_deg": 30})
    seen = photos(simulate(tmp_path / "b", retarder))[:, ~diffracts].mean(axis=1)
    ψ = np.deg2rad([0, 30, 75, 110])
    assert seen == pytest.approx(
        1 + np.sin(np.deg2rad(10)) * np.sin(2 * (ψ - np.deg2rad(30))), abs=1e-4
    )


def test_retardation_goes_with_the_inverse_of_wavelength(tmp_path: Path, ideal: Path) -> None:
    red = with_fields(plastic={"retardation_deg": 5}, filter={"peak_um": 0.66}, polariser_deg=[45])
    seen = photos(simulate(tmp_path, red))[0][~truth(ideal)[2]]
    assert seen == pytest.approx(1 + np.sin(np.deg2rad(10 * 0.55 / 0.66)), abs=2e-4)


def test_matt_light_does_not_turn(tmp_path: Path, ideal: Path) -> None:
    """Albedo times the panel's share of what shines on the sheet, r²/(r² + z²) = 1/26."""
    matt = with_fields(
        sheet={"bare": "matte", "bare_albedo": 0.6, "haze": 0.1, "table": 0.4}, size_px=[40, 40]
    )
    seen = photos(simulate(tmp_path, matt))
    sheet = np.zeros((40, 40), bool)
    sheet[4:36, 4:36] = True
    bare = np.zeros((40, 40), bool)
    bare[4:36, 4:36] = ~truth(ideal)[2]
    assert seen[:, ~sheet] == pytest.approx(0.4 / 26, rel=1e-4)
    assert seen[:, bare] == pytest.approx(0.7 / 26, rel=1e-4)
    difference = seen[:, 4:36, 4:36] - photos(ideal)
    assert difference[:, ~bare[4:36, 4:36]] == pytest.approx(0.1 / 26, rel=1e-2)


def test_the_panel_is_seen_by_the_law_of_the_mirror(tmp_path: Path, ideal: Path) -> None:
    """At equal heights its image is half as large, about the middle of the two."""
    small = with_fields(panel={"position_mm": [8, 6, 10000], "radius_mm": 20})
    seen = photos(simulate(tmp_path, small))[0]
    y, x = np.mgrid[:32, :32]
    distance = np.hypot(x - 15.5 - 4, 15.5 - y - 3)
    assert np.all(seen[distance > 10.01] == 0)
    inside = distance < 9.99
    assert seen[inside] == pytest.approx(photos(ideal)[0][inside], abs=1e-5)


def test_bumps_move_the_panel_s_image(tmp_path: Path) -> None:
    """A tilt of δ moves the mirrored ray by 2δ: of a panel 1° wide, bumps of 0.5° lose much."""
    disc = {"radius_mm": 10000 * np.tan(np.deg2rad(0.5))}
    flat = photos(simulate(tmp_path / "a", with_fields(panel=disc)))[0]
    bumpy = with_fields(panel=disc, sheet={"bumps_deg": 0.25, "bump_mm": 1})
    bumps = photos(simulate(tmp_path / "b", bumpy))[0]
    assert np.all(flat > 0)
    # Of two tilts with σ = 0.25° the sum of squares stays below (0.25°)²: 1 − e^{−1/2} = 0.39.
    assert np.mean(bumps > 0) == pytest.approx(0.39, abs=0.12)


def test_oblique_mirrors_do_not_return_circular_light(tmp_path: Path) -> None:
    """At 45° |r_s/r_p|² = |cos(i − t)/cos(i + t)|² across the plane of incidence, 1 along it."""
    aside = with_fields(
        metal={"ratio": {"r": 1, "zeta_deg": 180}},
        camera={"position_mm": [100000, 0, 100000], "focal_px": 141421},
        panel={"position_mm": [-100000, 0, 100000]},
        polariser_deg=[0, 90, 45],
    )
    foil = FOIL | {"periods": [1.2]}
    along, across, between = photos(simulate(tmp_path, aside, foil))[:, 14:18, 14:18]
    index = refractive_index("aluminium", 0.55)
    i = np.arcsin(np.sqrt(0.5) / 1.468)
    t = np.arcsin(np.sqrt(0.5) / index)
    ratio = np.cos(i - t) / np.cos(i + t)
    assert along == pytest.approx(1, rel=1e-3)
    assert across == pytest.approx(abs(ratio) ** 2, rel=1e-3)
    assert between == pytest.approx(abs(1 - 1j * ratio) ** 2 / 2, rel=2e-3)


# ---- Photographs ---------------------------------------------------------------------------------


def test_a_moved_camera_shows_things_moved_and_turned() -> None:
    pose = Pose(0.0, np.array([3.0, -2.0]), np.pi / 2, 1.0)
    # Of 21 × 11 pixels: five right of the middle goes clockwise to five below it, then the shift.
    moved = np.array([[10.0 + 3, 5.0 + 5 - 2]])
    assert pose.steady(moved, (21, 11)) == pytest.approx(np.array([[15.0, 5.0]]))
    still = Pose(0.0, np.zeros(2), 0.0, 1.0)
    assert still.steady(moved, (21, 11)) == pytest.approx(moved)


def test_what_differs_between_photographs_is_told_in_the_truth(tmp_path: Path, ideal: Path) -> None:
    handling = {"polariser_deg": 4, "shift_px": 3, "turn_deg": 2, "light": 0.05}
    file = simulate(tmp_path, with_fields(handling=handling, polariser_deg=[0, 30, 75, 110] * 8))
    told = json.loads((file.parent / "truth" / "polarization.json").read_text())["photographs"]
    noted = [p.polariser_deg for p in read_capture(file, "polarization").photographs]
    assert noted == [0, 30, 75, 110] * 8
    assert told[0] == {"polariser_deg": 0, "shift_px": [0, 0], "turn_deg": 0, "light": 1}
    off = np.array([p["polariser_deg"] for p in told[1:]]) - noted[1:]
    shift = np.array([p["shift_px"] for p in told[1:]])
    turn = np.array([p["turn_deg"] for p in told[1:]])
    light = np.log([p["light"] for p in told[1:]])
    # 31 draws: three standard errors of their deviations are 0.38.
    for values, deviation in ((off, 4), (shift, 3), (turn, 2), (light, 0.05)):
        assert np.sqrt(np.mean(values**2)) == pytest.approx(deviation, rel=0.4)
    assert photos(file)[0] == pytest.approx(photos(ideal)[0], abs=1e-6)


def test_the_polariser_s_own_angle_and_the_light_are_what_is_seen(tmp_path: Path) -> None:
    handling = {"polariser_deg": 10, "light": 0.2}
    file = simulate(tmp_path / "a", with_fields(handling=handling, polariser_deg=[0, 60]))
    told = json.loads((file.parent / "truth" / "polarization.json").read_text())["photographs"][1]
    exact = with_fields(polariser_deg=[told["polariser_deg"]])
    expected = told["light"] * photos(simulate(tmp_path / "b", exact))[0]
    assert photos(file)[1] == pytest.approx(expected, rel=1e-5)


def test_exposures_noise_and_files(tmp_path: Path, ideal: Path) -> None:
    recipe = with_fields(
        sensor={"file": "tif", "bits": 16, "full_well": 5000, "read_noise": 5},
        exposures_s=[0.2, 0.4],
        polariser_deg=[0],
    )
    file = simulate(tmp_path, recipe)
    brackets = read_capture(file, "polarization").photographs[0].brackets
    assert brackets is not None and [b.exposure_s for b in brackets] == [0.2, 0.4]
    rest = photos(file)[0] - photos(ideal)[0]
    assert 0.005 < rest.std() < 0.05  # at 0.2 to 0.4 of 5000 electrons 2 to 3 %, of two 2 %


def test_the_capture_says_where_the_sample_is(ideal: Path) -> None:
    capture = read_capture(ideal, "polarization")
    assert capture.sample.size_mm == (32, 32) and capture.sample.tile_mm is None
    assert [p.polariser_deg for p in capture.photographs] == [0, 30, 75, 110]
    assert all(p.light is None and p.filter is not None for p in capture.photographs)
    corners = np.array(capture.photographs[2].corners_px)
    expected = np.array([[-0.5, -0.5], [31.5, -0.5], [31.5, 31.5], [-0.5, 31.5]])
    assert corners == pytest.approx(expected, abs=1e-3)
    assert (ideal.parent / "camera.csv").exists()


def test_the_capture_keeps_to_itself_what_is_omitted(tmp_path: Path) -> None:
    omit = [
        "camera.position_mm",
        "camera.focal_px",
        "camera.spectral_response_csv",
        "photographs.corners_px",
    ]
    capture = read_capture(simulate(tmp_path, with_fields(omit=omit)), "polarization")
    assert capture.camera.position_mm is None and capture.camera.focal_px is None
    assert capture.camera.spectral_response_csv is None
    assert all(photograph.corners_px is None for photograph in capture.photographs)


def test_the_same_seed_gives_the_same_files(tmp_path: Path) -> None:
    recipe = with_fields(
        handling={"polariser_deg": 1, "shift_px": 1, "turn_deg": 1, "light": 0.01},
        sheet={"bumps_deg": 0.2},
        sensor={"file": "png", "noise_db": 40},
        polariser_deg=[0, 45],
    )
    one, two, three = (
        simulate(tmp_path / name, recipe | {"seed": seed})
        for name, seed in (("a", 7), ("b", 7), ("c", 8))
    )
    names = sorted(f.relative_to(one.parent) for f in one.parent.rglob("*") if f.is_file())
    assert len(names) == 7  # two photographs, capture, camera, and three of truth
    for name in names:
        assert (one.parent / name).read_bytes() == (two.parent / name).read_bytes(), name
    for name in ("polarization-1.png", "truth/polarization.json"):
        assert (one.parent / name).read_bytes() != (three.parent / name).read_bytes()


def test_interrupted_there_is_no_capture(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Photographs that were made stay; the capture file is written last."""
    from precompute.acquisition import simulate_polarization as module

    written = module.write_photograph

    def stops(file: Path, *rest: Any) -> None:
        if file.stem == "polarization-2":
            raise KeyboardInterrupt
        written(file, *rest)

    monkeypatch.setattr(module, "write_photograph", stops)
    with pytest.raises(KeyboardInterrupt):
        simulate(tmp_path, RECIPE)
    found = sorted(f.name for f in (tmp_path / "out" / "bench").iterdir())
    assert found == ["polarization-0.exr", "polarization-1.exr"]


def test_the_command(tmp_path: Path) -> None:
    """The capture's path, or one line and exit code 2."""
    recipe = tmp_path / "bench.json"
    (tmp_path / "foil.json").write_text(json.dumps(FOIL))
    arguments = ["simulate", "polarization", str(recipe), "-o", str(tmp_path / "out")]
    recipe.write_text(json.dumps(with_fields(polariser_deg=[0])))
    result = CliRunner().invoke(app, arguments, catch_exceptions=False)
    assert result.exit_code == 0
    assert result.stderr.split() == [str(tmp_path / "out" / "bench" / "capture.json")]
    recipe.write_text(json.dumps(with_fields(seed=-1)))
    result = CliRunner().invoke(app, arguments, catch_exceptions=False)
    assert result.exit_code == 2
    assert result.stderr.count("\n") == 1 and "seed = -1" in result.stderr


# ---- Recipes -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"camera": {"position_mm": None}}, "camera.position_mm and camera.focal_px"),
        ({"camera": {"focal_px": None}}, "camera.position_mm and camera.focal_px"),
        ({"camera": {"response": "srgb"}}, "a linear response for exr"),
        ({"metal": {"kind": "lead"}}, "metal.kind"),
        ({"metal": {"angle_deg": 61}}, "metal.angle_deg"),
        ({"metal": {"ratio": {"r": 0, "zeta_deg": 0}}}, "metal.ratio.r"),
        ({"metal": {"ratio": {"r": 1, "zeta_deg": 400}}}, "metal.ratio.zeta_deg"),
        ({"metal": {"ratio": {"r": 1}}}, "metal.ratio.zeta_deg"),
        ({"plastic": {"index": 0.9}}, "plastic.index"),
        ({"plastic": {"retardation_deg": 91}}, "plastic.retardation_deg"),
        ({"plastic": {"axis_deg": 361}}, "plastic.axis_deg"),
        ({"plastic": {"first_surface": 1}}, "plastic.first_surface"),
        ({"plastic": {"first_surface_phase_deg": 361}}, "plastic.first_surface_phase_deg"),
        ({"plastic": {"first_surface_retardation_deg": -1}}, "first_surface_retardation_deg"),
        ({"sheet": {"size_mm": [0, 1]}}, "sheet.size_mm"),
        ({"sheet": {"bare": "glossy"}}, "sheet.bare"),
        ({"sheet": {"bare_albedo": 1.5}}, "sheet.bare_albedo"),
        ({"sheet": {"haze": 1.5}}, "sheet.haze"),
        ({"sheet": {"table": -1}}, "sheet.table"),
        ({"sheet": {"bumps_deg": 11}}, "sheet.bumps_deg"),
        ({"sheet": {"bump_mm": 0}}, "sheet.bump_mm"),
        ({"panel": {"position_mm": [0, 0, -1]}}, "z above 0"),
        ({"panel": {"radius_mm": 0}}, "panel.radius_mm"),
        ({"panel": {"falloff": 21}}, "panel.falloff"),
        ({"panel": {"spectrum": "moonlight"}}, "panel.spectrum"),
        ({"filter": {"fwhm_um": 0}}, "filter.fwhm_um"),
        ({"size_px": [0, 10]}, "size_px"),
        ({"polariser_deg": []}, "polariser_deg"),
        ({"polariser_deg": [0, 361]}, "polariser_deg.1"),
        ({"exposures_s": [0]}, "exposures_s"),
        ({"handling": {"polariser_deg": 46}}, "handling.polariser_deg"),
        ({"handling": {"shift_px": -1}}, "handling.shift_px"),
        ({"handling": {"turn_deg": 46}}, "handling.turn_deg"),
        ({"handling": {"light": 0.4}}, "handling.light"),
        ({"sensor": {"noise_db": 40, "full_well": 100}}, "full_well or noise_db"),
        ({"omit": ["sample.size_mm"]}, "omit"),
        ({"step_nm": 21}, "step_nm"),
        ({"subpixels": 0}, "subpixels"),
        ({"seed": -1}, "seed"),
        ({"photographs": []}, "photographs"),
    ],
)
def test_recipes_that_cannot_be_simulated(
    tmp_path: Path, change: dict[str, Any], said: str
) -> None:
    (tmp_path / "bench.json").write_text(json.dumps(with_fields(**change)))
    with pytest.raises(InputError) as caught:
        read_polarization_simulation(tmp_path / "bench.json")
    assert said in str(caught.value)


def test_files_that_recipes_name(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="the recipe of a foil"):
        simulate(tmp_path, with_fields(), {"kind": "metals"})
    with pytest.raises(InputError, match=r"lamp\.csv"):
        simulate(tmp_path, with_fields(panel={"spectrum": "lamp.csv"}))


@pytest.mark.parametrize(
    "file",
    sorted((Path(__file__).parents[2] / "maps" / "captures").glob("polarization-*.json")),
    ids=lambda file: file.stem,
)
def test_shipped_recipes(file: Path) -> None:
    recipe = read_polarization_simulation(file)
    assert (file.parent / recipe.foil).exists()
    angles = np.unique(np.round(np.mod(recipe.polariser_deg, 180), 6))
    assert 4 <= len(recipe.polariser_deg) <= 17
    assert len(angles) >= 4
