"""Flash photographs to a foil's map by the command: what comes out, and what is refused."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from scipy.ndimage import gaussian_filter
from typer.testing import CliRunner, Result

from precompute.acquisition.capture import Camera, read_capture
from precompute.acquisition.flash import FlashOptions, acquire_flash
from precompute.acquisition.flash_report import FlashReport
from precompute.acquisition.image_files import read_image, write_image
from precompute.acquisition.pattern import gratings_of
from precompute.acquisition.refusal_pictures import drawn
from precompute.acquisition.shots import read_shots
from precompute.cli import app
from precompute.maps import Map

PERIOD = 1.66
TEXELS = 64
LIGHTS = ((-45, 20, 150), (40, 30, 150), (5, -45, 150))
ROUGHNESS_DEG = 0.2
FOIL: dict[str, Any] = {
    "kind": "foil",
    "design": "polygons",
    "size": TEXELS,
    "tile_mm": 15,
    "polygons": 6,
    "orientations": 6,
    "periods": [PERIOD],
}
RECIPE: dict[str, Any] = {
    "kind": "flash-capture",
    "foil": "foil.json",
    "surface": {"size_mm": [90, 75], "roughness_deg": ROUGHNESS_DEG},
    "camera": {"position_mm": [0, 0, 300], "focal_px": 900, "black": 256},
    "size_px": [283, 236],
    "photographs": [
        {"light": {"position_mm": list(light)}, "exposures_s": [0.002, 0.06]} for light in LIGHTS
    ],
    "sensor": {"file": "tif", "bits": 16, "full_well": 30000, "read_noise": 4},
    "step_nm": 20,
    "subpixels": 1,
}


def run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(app, [str(a) for a in arguments], catch_exceptions=False)


@pytest.fixture(scope="module")
def capture(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A capture of three photographs in two brackets each."""
    folder = tmp_path_factory.mktemp("flash")
    (folder / "foil.json").write_text(json.dumps(FOIL))
    (folder / "bench.json").write_text(json.dumps(RECIPE))
    result = run("simulate", "flash", folder / "bench.json", "-o", folder / "captures")
    assert result.exit_code == 0
    return folder / "captures" / "bench" / "capture.json"


@pytest.fixture(scope="module")
def solved(capture: Path) -> Path:
    """The map made from it, and pictures of every step in ``debug``."""
    folder = capture.parent / "solved"
    size = ("--size", str(TEXELS), str(TEXELS))
    result = run(
        *("acquire", "flash", capture, "-o", folder / "foil", *size, "--debug", folder / "debug")
    )
    assert result.exit_code == 0
    return folder


def changed(capture: Path, folder: Path, change: Any) -> Path:
    """A copy of a capture in which `change` was done to the JSON and the files beside it."""
    for file in capture.parent.iterdir():
        if file.is_file():
            shutil.copy(file, folder)
    fields = json.loads(capture.read_text())
    change(fields, folder)
    (folder / "capture.json").write_text(json.dumps(fields))
    return folder / "capture.json"


def mirror_pixel(light: Iterable[float]) -> np.ndarray:
    """Where the camera, 300 mm before the sample, sees a lamp's mirror image."""
    x, y, z = light
    return np.array([141 + 3 * x * 300 / (z + 300), 117.5 - 3 * y * 300 / (z + 300)])


def single(fields: dict[str, Any], bracket: int = 0) -> Iterable[str]:
    """Keep one bracket of each photograph."""
    for photograph in fields["photographs"]:
        photograph |= photograph.pop("brackets")[bracket]
        yield photograph["file"]


def acquire(file: Path, *options: str) -> Result:
    return run("acquire", "flash", file, "-o", file.parent / "foil", *options)


def refusal(file: Path, *options: str) -> str:
    """The one line in which an acquisition ends."""
    result = acquire(file, "--size", "16", "16", *options)
    assert result.exit_code == 2
    assert not (file.parent / "foil.json").exists()
    lines = result.stderr.strip().splitlines()
    assert not list(file.parent.glob("*.part"))
    return lines[-1]


def picture(line: str) -> Path:
    """The picture that a line ends by naming: it is there, small and not one colour all over."""
    file = Path(line.rsplit("; see ", 1)[1])
    with Image.open(file) as image:
        assert image.format == "PNG" and max(image.size) <= 1200
        assert np.asarray(image.convert("L")).std() > 5
    return file


def covered(fields: dict[str, Any], folder: Path) -> None:
    """Something dark on the foil, 36 mm wide, where the second lamp's mirror image was."""
    x, y = (round(float(c)) for c in mirror_pixel(LIGHTS[1]))
    for name in ("flash-1-0.tif", "flash-1-1.tif"):
        numbers = read_image(folder / name, Camera(black=256)).numbers
        numbers[max(y - 54, 0) : y + 54, x - 54 : x + 54] = 300
        write_image(folder / name, numbers, 1.0)


# ---- What comes out ------------------------------------------------------------------------------


def test_orientation_and_period_are_those_that_were_planted(capture: Path, solved: Path) -> None:
    truth = gratings_of(Map.read(capture.parent / "truth" / "foil.json"))
    foil = Map.read(solved / "foil.json")
    found = gratings_of(foil)
    seen = (foil.tables["confidence"].values[..., 0] > 0) & (truth.strength > 0)
    assert np.mean(seen[truth.strength > 0]) > 0.85
    off = np.mod(found.orientation - truth.orientation + np.pi / 2, np.pi) - np.pi / 2
    assert np.median(np.abs(np.degrees(off[seen]))) <= 1
    assert np.abs(np.mean(np.degrees(off[seen & (np.abs(off) < 0.1)]))) < 0.3  # no common turn
    assert np.median(found.frequency[seen]) == pytest.approx(1 / PERIOD, rel=0.01)


def test_the_report_says_what_was_seen(solved: Path) -> None:
    report = FlashReport.model_validate_json((solved / "foil.report.json").read_text())
    assert report.left_out == {} and report.remarks == []
    assert report.is_one_period and not report.is_relative
    assert report.periods_um[1] == pytest.approx(PERIOD, rel=0.01)
    assert report.tiles == (6, 5) and report.tile_mm == (15, 15)
    assert report.explained > 0.8
    assert ROUGHNESS_DEG / 2 < report.roughness_deg < 2 * ROUGHNESS_DEG
    shares = report.texels.model_dump()
    assert sum(shares.values()) == pytest.approx(1)
    assert shares["seen"] + shares["unsure"] > 0.85
    for photograph, light in zip(report.photographs, LIGHTS, strict=True):
        # A pixel is 1/3 mm; the lamp moves 1.5 times as far as its image.
        assert photograph.light_mm == pytest.approx(light, abs=0.5)
        assert photograph.light_off_mm < 0.5
        assert photograph.period_over_all == pytest.approx(1, abs=0.03)


def test_the_map_is_one_that_the_material_can_load(solved: Path) -> None:
    """What web/surfaces/foil.ts asks of a foil."""
    foil = Map.read(solved / "foil.json")
    assert foil.kind == "foil"
    assert foil.recipe["profile"] == "sinusoidal"
    low, high = foil.constants["min_frequency"], foil.constants["max_frequency"]
    assert isinstance(low, float) and isinstance(high, float) and 0 < low <= high
    assert foil.constants["height_um"] == 0.15
    assert foil.constants["tile_mm"] == (15, 15)
    assert foil.tables["grating"].values.shape == (TEXELS, TEXELS, 4)
    assert foil.tables["confidence"].values.shape == (TEXELS, TEXELS, 1)
    assert (
        0 <= foil.tables["confidence"].values.min() <= foil.tables["confidence"].values.max() <= 1
    )


def test_pictures_show_every_step(solved: Path) -> None:
    names = {"lit", "orientation", "period", "confidence"}
    for number in range(3):
        names |= {f"rectified-{number}", f"half-vectors-{number}", f"rendering-{number}"}
    files = list((solved / "debug").iterdir())
    assert {file.stem for file in files} == names
    for file in files:
        with Image.open(file) as image:
            assert np.asarray(image.convert("L")).std() > 5  # not one colour all over


# ---- Less than three good photographs ------------------------------------------------------------


def test_a_photograph_without_highlight_is_left_out(capture: Path, tmp_path: Path) -> None:
    file = changed(capture, tmp_path, covered)
    result = acquire(file, "--size", "24", "24", "--no-align", "--periods", "one")
    assert result.exit_code == 0
    report = FlashReport.model_validate_json((tmp_path / "foil.report.json").read_text())
    assert [photograph.name for photograph in report.photographs] == [
        "flash-0-0.tif",
        "flash-2-0.tif",
    ]
    assert list(report.left_out) == ["flash-1-0.tif"]
    assert "of another colour than the lamp's" in report.left_out["flash-1-0.tif"]
    (remark,) = (remark for remark in report.remarks if "left out" in remark)
    assert picture(remark) == tmp_path / "foil.flash-1-0.tif.refused.png"
    assert remark in result.stderr
    assert report.periods_um[1] == pytest.approx(PERIOD, rel=0.02)
    taken = read_shots(read_capture(file, "flash"), tmp_path, lambda _: None)
    assert len(taken.rectifications) == 3  # those of photographs that are left out too


def test_a_tile_that_is_not_said_is_found_in_one_photograph(capture: Path, tmp_path: Path) -> None:
    def unsaid(fields: dict[str, Any], folder: Path) -> None:
        del fields["sample"]["tile_mm"], fields["sample"]["reference_tile_px"]
        del fields["photographs"][1:]

    file = changed(capture, tmp_path, unsaid)
    result = acquire(file, "--size", "24", "24", "--no-align", "--periods", "one")
    assert result.exit_code == 0
    report = FlashReport.model_validate_json((tmp_path / "foil.report.json").read_text())
    assert report.tile_mm == pytest.approx((15, 15), abs=0.1)  # a third of a pixel
    assert report.periods_um[1] == pytest.approx(PERIOD, rel=0.02)


def test_a_lamp_at_another_height_disagrees_with_the_others(capture: Path, tmp_path: Path) -> None:
    """At 4/5 of its height the lamp's (u, v) grow, and so would the periods by that."""

    def lowered(fields: dict[str, Any], folder: Path) -> None:
        x, y, z = LIGHTS[2]
        # The mirror image stays where it is: x/z + (its place) (1/z + 1/eye) = 0.
        image = np.array([x, y]) * 300 / (z + 300)
        lower = 0.8 * z
        at = image * (1 + lower / 300)
        fields["photographs"][2]["light"]["position_mm"] = [*at.tolist(), lower]

    file = changed(capture, tmp_path, lowered)
    result = acquire(file, "--size", "24", "24", "--no-align", "--periods", "one")
    assert result.exit_code == 0
    report = FlashReport.model_validate_json((tmp_path / "foil.report.json").read_text())
    assert any("photographs disagree on periods" in remark for remark in report.remarks)
    first, second, wrong = (photograph.period_over_all for photograph in report.photographs)
    assert wrong < 0.95 * min(first, second)
    assert "light.position_mm" in result.stderr


def test_what_a_camera_without_colours_shows_is_darkness(capture: Path, tmp_path: Path) -> None:
    """Whose sensitivity nobody said: then facets are not told by their colour."""

    def change(fields: dict[str, Any], folder: Path) -> None:
        covered(fields, folder)
        del fields["camera"]["spectral_response_csv"]

    file = changed(capture, tmp_path, change)
    draw = tmp_path / "debug"
    options = FlashOptions((24, 24), is_one_period=True, align=False)
    said: list[str] = []
    acquired = acquire_flash(file, options, said.append, lambda e: drawn(e, draw, ""))
    assert list(acquired.report.left_out) == ["flash-1-0.tif"]
    assert "highlight = 'nothing but darkness'" in acquired.report.left_out["flash-1-0.tif"]
    (remark,) = (remark for remark in said if "left out" in remark)
    assert picture(remark) == draw / "flash-1-0.tif.refused.png"


@pytest.mark.parametrize("off", [8, -40])
def test_a_lamp_that_was_measured_badly_is_put_right_and_said(
    capture: Path, tmp_path: Path, off: float
) -> None:
    def moved(fields: dict[str, Any], folder: Path) -> None:
        fields["photographs"][0]["light"]["position_mm"][1] += off

    file = changed(capture, tmp_path, moved)
    result = acquire(file, "--size", "24", "24", "--no-align", "--periods", "one")
    assert result.exit_code == 0
    report = FlashReport.model_validate_json((tmp_path / "foil.report.json").read_text())
    assert len(report.remarks) == 1 and "mm from light.position_mm" in report.remarks[0]
    assert report.photographs[0].light_off_mm == pytest.approx(abs(off), abs=0.3)
    assert report.photographs[0].light_mm == pytest.approx(LIGHTS[0], abs=0.3)


# ---- Bad input -----------------------------------------------------------------------------------


def test_a_missing_photograph(capture: Path, tmp_path: Path) -> None:
    def removed(fields: dict[str, Any], folder: Path) -> None:
        (folder / "flash-1-1.tif").unlink()

    assert "flash-1-1.tif" in refusal(changed(capture, tmp_path, removed))
    assert not list(tmp_path.glob("*.png"))


def test_photographs_of_other_sizes(capture: Path, tmp_path: Path) -> None:
    def cropped(fields: dict[str, Any], folder: Path) -> None:
        for name in ("flash-2-0.tif", "flash-2-1.tif"):
            image = read_image(folder / name, read_capture(capture, "flash").camera)
            write_image(folder / name, np.ascontiguousarray(image.numbers[:-10]), 1.0)

    message = refusal(changed(capture, tmp_path, cropped))
    assert "283 × 226" in message and "283 × 236" in message and "flash-2-0.tif" in message
    assert picture(message).name == "foil.flash-2-0.tif.refused.png"


def test_highlights_that_are_clipped_everywhere(capture: Path, tmp_path: Path) -> None:
    def long(fields: dict[str, Any], folder: Path) -> None:
        list(single(fields, bracket=1))

    message = refusal(changed(capture, tmp_path, long))
    assert "highlight" in message and "clipped" in message and "flash-0-1.tif" in message
    pictures = {tmp_path / f"foil.flash-{number}-1.tif.refused.png" for number in range(3)}
    assert picture(message) in pictures
    assert set(tmp_path.glob("*.png")) == pictures


def test_pictures_of_refusals_are_with_the_other_pictures(capture: Path, tmp_path: Path) -> None:
    def far(fields: dict[str, Any], folder: Path) -> None:
        for photograph in fields["photographs"]:
            photograph["light"]["position_mm"][0] += 400

    file = changed(capture, tmp_path, far)
    result = acquire(file, "--size", "16", "16", "--debug", str(tmp_path / "debug"))
    lines = result.stderr.strip().splitlines()
    assert result.exit_code == 2 and len(lines) == 3
    for line, number in zip(lines, (1, 2, 0), strict=True):
        assert "light.position_mm = \"the lamp's mirror image at" in line
        assert picture(line) == tmp_path / f"debug/flash-{number}-0.tif.refused.png"


def test_no_sample_in_the_photographs(capture: Path, tmp_path: Path) -> None:
    """A table, lit from its middle."""

    def table(fields: dict[str, Any], folder: Path) -> None:
        del fields["camera"]["focal_px"]
        y, x = np.mgrid[:236, :283]
        shade = np.exp(-((x - 140) ** 2 + (y - 120) ** 2) / (2 * 60**2))
        painted(fields, folder, 300 + 20000 * np.repeat(shade[..., None], 3, axis=2))
        for photograph in fields["photographs"]:
            del photograph["corners_px"]

    message = refusal(changed(capture, tmp_path, table))
    assert "corners_px" in message and "flash-0-0.tif, flash-1-0.tif, flash-2-0.tif" in message
    assert picture(message).name == "foil.corners.refused.png"


def test_photographs_that_are_black(capture: Path, tmp_path: Path) -> None:
    def black(fields: dict[str, Any], folder: Path) -> None:
        for name in single(fields):
            write_image(folder / name, np.full((236, 283, 3), 256, np.uint16), 0.002)

    message = refusal(changed(capture, tmp_path, black))
    assert "numbers = 'all black'" in message
    assert picture(message).name == "foil.flash-0-0.tif.refused.png"


def painted(fields: dict[str, Any], folder: Path, background: np.ndarray) -> None:
    """Photographs of the lamp's mirror image on something else, numbers to 65535."""
    height, width = background.shape[:2]
    y, x = np.mgrid[:height, :width]
    for name, photograph in zip(single(fields), fields["photographs"], strict=True):
        column, row = mirror_pixel(photograph["light"]["position_mm"])
        spot = np.exp(-((x - column) ** 2 + (y - row) ** 2) / (2 * 3.0**2))
        picture = background + 40000 * spot[..., None]
        write_image(folder / name, picture.clip(0, 65535).astype(np.uint16), 0.002)


@pytest.mark.parametrize("options", [(), ("--no-align", "--periods", "one")])
def test_nothing_lit_but_the_highlight(
    capture: Path, tmp_path: Path, options: tuple[str, ...]
) -> None:
    def dark(fields: dict[str, Any], folder: Path) -> None:
        painted(fields, folder, np.full((236, 283, 3), 300.0))

    message = refusal(changed(capture, tmp_path, dark), *options)
    assert "photographs" in message and "lit points of a foil" in message
    assert picture(message).name == "foil.flash-0-0.tif.refused.png"


@pytest.mark.parametrize("grain", [0, 2, 6])
def test_photographs_of_something_else(capture: Path, tmp_path: Path, grain: float) -> None:
    def texture(fields: dict[str, Any], folder: Path) -> None:
        noise = np.random.default_rng(3).standard_normal((236, 283, 3))
        blurred = gaussian_filter(noise, (grain, grain, 0))
        painted(fields, folder, 256 + 800 * np.exp(blurred / blurred.std()))

    message = refusal(changed(capture, tmp_path, texture))
    assert "photographs = " in message and "of a foil" in message
    assert picture(message).parent == tmp_path
