"""Photographs through a turning polariser to a foil's map: what comes out, and what is refused."""

from __future__ import annotations

import json
import re
import shutil
import socket
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from distributed import Client, LocalCluster, get_task_stream
from PIL import Image
from refusals import refused
from typer.testing import CliRunner, Result

from precompute.acquisition import blocks, orientation_filter, polarization_fit
from precompute.acquisition import diffracting as diffracting_module
from precompute.acquisition import registration as registration_module
from precompute.acquisition.capture import read_capture
from precompute.acquisition.diffracting import diffracting
from precompute.acquisition.image_files import read_image, write_image
from precompute.acquisition.pattern import gratings_of
from precompute.acquisition.polarization import (
    PolarizationOptions,
    acquire_polarization,
    confidences,
)
from precompute.acquisition.polarization_report import PolarizationReport
from precompute.acquisition.registration import Move, Outlines
from precompute.acquisition.simulate_polarization import simulate_polarization
from precompute.cli import app
from precompute.maps import Map

TEXELS, PIXELS = 48, 112
PERIODS = (1.2, 1.8)
FOIL: dict[str, Any] = {
    "kind": "foil",
    "design": "polygons",
    "size": TEXELS,
    "tile_mm": 32,
    "polygons": 12,
    "orientations": 7,
    "periods": list(PERIODS),
    "border": 0.03,
}
# Each texel of 32 mm is two pixels; 8 px of table around the sheet.
RECIPE: dict[str, Any] = {
    "kind": "polarization-capture",
    "foil": "foil.json",
    "metal": {"ratio": {"r": 1.1, "zeta_deg": 160}},
    "plastic": {"retardation_deg": 3, "axis_deg": 20, "first_surface": 0},
    "sheet": {"size_mm": [32, 32]},
    "panel": {"position_mm": [0, 0, 10000], "radius_mm": 2000, "falloff": 0},
    "camera": {"position_mm": [0, 0, 10000], "focal_px": 30000, "channels": "grey", "black": 256},
    "filter": {"peak_um": 0.55, "fwhm_um": 0.001},
    "size_px": [PIXELS, PIXELS],
    "polariser_deg": [0, 37, 75, 110, 150],
    "exposures_s": [0.4],
    "handling": {"shift_px": 0.8, "turn_deg": 0.4, "light": 0.01},
    "sensor": {"file": "tif", "bits": 16, "full_well": 60000, "read_noise": 4},
    "subpixels": 4,
}
NAMES = [f"polarization-{number}.tif" for number in range(5)]


def run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(app, [str(a) for a in arguments], catch_exceptions=False)


def simulated(folder: Path, **fields: Any) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "foil.json").write_text(json.dumps(FOIL))
    (folder / "bench.json").write_text(json.dumps(RECIPE | fields))
    return simulate_polarization(folder / "bench.json", folder)


@pytest.fixture(scope="module")
def capture(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return simulated(tmp_path_factory.mktemp("polarized"))


def told(file: Path) -> dict[str, Any]:
    return json.loads((file.parent / "truth" / "polarization.json").read_text())


@pytest.fixture(scope="module")
def solved(capture: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("solved")
    arguments = ["--offset", told(capture)["offset_deg"], "--periods", *PERIODS]
    arguments += ["--debug", folder / "debug"]
    result = run("acquire", "polarization", capture, "-o", folder / "foil", *map(str, arguments))
    assert result.exit_code == 0, result.stderr
    return folder


Change = Callable[[dict[str, Any], Path], None]


def changed(capture: Path, folder: Path, change: Change) -> Path:
    """A copy of a capture after a change of its fields or of files beside it."""
    shutil.copytree(capture.parent, folder, dirs_exist_ok=True)
    fields = json.loads((folder / "capture.json").read_text())
    change(fields, folder)
    (folder / "capture.json").write_text(json.dumps(fields))
    return folder / "capture.json"


def refusal(file: Path, *options: str) -> str:
    """The one line of a refused capture; nothing is written but a picture."""
    result = run("acquire", "polarization", file, "-o", file.parent / "refused", *options)
    assert result.exit_code == 2
    lines = result.stderr.strip().splitlines()
    assert len(lines) == 1
    assert not list(file.parent.glob("refused*json"))
    return lines[0]


def repainted(folder: Path, name: str, numbers: Callable[[np.ndarray], np.ndarray]) -> None:
    camera = read_capture(folder / "capture.json", "polarization").camera
    image = read_image(folder / name, camera)
    changed_numbers = numbers(image.numbers.astype(np.float64)).clip(0, 65535)
    write_image(folder / name, changed_numbers.astype(np.uint16), 0.4)


def truth_on(capture: Path, rows: int, columns: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """θ, period and what diffracts on a map of so many texels over the one tile."""
    gratings = gratings_of(Map.read(capture.parent / "truth" / "foil.json"))
    row = np.arange(rows) * TEXELS // rows
    column = np.arange(columns) * TEXELS // columns
    grid = np.ix_(row, column)
    with np.errstate(divide="ignore"):
        return (
            gratings.orientation[grid],
            1 / gratings.frequency[grid],
            gratings.strength[grid] > 0.5,
        )


def off_deg(found: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """How far orientations are apart, degrees, −90 to 90."""
    return np.degrees(np.angle(np.exp(2j * (found - truth))) / 2)


# ---- What comes out ------------------------------------------------------------------------------


def test_orientations_are_the_foil_s(capture: Path, solved: Path) -> None:
    """A = 0.39 of noise 0.005, five photographs: some 0.5°; 8 bits of the map 0.3°."""
    gratings = gratings_of(Map.read(solved / "foil.json"))
    rows, columns = gratings.orientation.shape
    assert (rows, columns) == (96, 96)  # pixels that the sheet takes
    θ, _, diffracts = truth_on(capture, rows, columns)
    found = gratings.strength > 0.5
    assert np.mean(found == diffracts) > 0.95
    off = off_deg(gratings.orientation, θ)[found & diffracts]
    assert np.median(np.abs(off)) < 0.7
    assert np.quantile(np.abs(off), 0.8) < 1.5  # a fifth are pixels at edges, which show two
    assert abs(np.median(off)) < 0.4  # no common turn, nor x for y


def test_periods_go_with_the_root_of_brightness(capture: Path, solved: Path) -> None:
    gratings = gratings_of(Map.read(solved / "foil.json"))
    _, period, diffracts = truth_on(capture, *gratings.strength.shape)
    both = diffracts & (gratings.strength > 0.5)
    off = np.abs(1 / gratings.frequency / period - 1)[both]
    assert np.median(off) < 0.02 and np.mean(off < 0.05) > 0.85


def test_confidence_is_nothing_where_nothing_diffracts(capture: Path, solved: Path) -> None:
    foil = Map.read(solved / "foil.json")
    confidence = foil.tables["confidence"].values[..., 0]
    strength = gratings_of(foil).strength
    assert np.all(confidence[strength < 0.5] == 0)
    assert np.median(confidence[strength > 0.5]) > 0.95


def test_the_report_says_what_was_seen(capture: Path, solved: Path) -> None:
    report = PolarizationReport.model_validate_json((solved / "foil.report.json").read_text())
    assert [photograph.name for photograph in report.photographs] == NAMES
    assert [photograph.polariser_deg for photograph in report.photographs] == pytest.approx(
        RECIPE["polariser_deg"]
    )
    for photograph, truth in zip(report.photographs, told(capture)["photographs"], strict=True):
        # The simulated pixel has 4 × 4 points: the sheet's edge is told to an eighth of one.
        assert photograph.shift_px == pytest.approx(truth["shift_px"], abs=0.15)
        assert photograph.turn_deg == pytest.approx(truth["turn_deg"], abs=0.15)
        assert photograph.quality > 0.4 and photograph.clipped == 0
    moved = [truth["shift_px"] for truth in told(capture)["photographs"]]
    assert np.abs(moved).max() > 0.8  # else nothing was asked
    assert report.angles == 5 and report.size == (96, 96)
    assert report.unknown < 0.03 and report.correlation > 0.95
    assert report.circle.is_known
    # A/c of r = 1.1, ζ = 160°: Eq. 9.
    swing = np.hypot((1 - 1.1**2) / 2, 1.1 * np.sin(np.deg2rad(160)))
    assert report.circle.radius == pytest.approx(swing / ((1 + 1.1**2) / 2), rel=0.03)
    assert not report.is_relative and report.periods_um == PERIODS
    assert [remark for remark in report.remarks if "heuristic" in remark] == report.remarks


def test_the_map_is_one_that_the_material_can_load(solved: Path) -> None:
    foil = Map.read(solved / "foil.json")
    assert foil.kind == "foil" and foil.recipe["profile"] == "sinusoidal"
    low, high = foil.constants["min_frequency"], foil.constants["max_frequency"]
    assert isinstance(low, float) and isinstance(high, float)
    assert 1 / high == pytest.approx(1.2) and 1 / low == pytest.approx(1.8)
    assert foil.constants["tile_mm"] == (32, 32)
    assert foil.tables["confidence"].values.shape == (96, 96, 1)


def test_pictures_show_every_step(solved: Path) -> None:
    names = {"mean", "correlation", "mask", "circle"}
    names |= {"orientation", "noise", "confidence", "period"}
    files = list((solved / "debug").iterdir())
    assert {file.stem for file in files} == names
    for file in files:
        with Image.open(file) as image:
            assert np.asarray(image.convert("L")).std() > 5  # not one colour all over


# ---- Less, or otherwise --------------------------------------------------------------------------


def test_three_photographs_do(capture: Path, tmp_path: Path) -> None:
    def fewer(fields: dict[str, Any], folder: Path) -> None:
        del fields["photographs"][1::2]

    file = changed(capture, tmp_path, fewer)
    offset = np.radians(told(capture)["offset_deg"])
    said: list[str] = []
    acquired = acquire_polarization(file, PolarizationOptions(offset=offset), said.append)
    assert acquired.report.residual is None and acquired.report.angles == 3
    assert any("1 µm" in remark for remark in said)
    θ, _, diffracts = truth_on(capture, 96, 96)
    found = acquired.found
    believed = (confidences(found) > 0) & diffracts
    assert believed.sum() > 0.8 * diffracts.sum()
    off = off_deg(found.fit.phase / 2 + offset, θ)[believed]
    assert np.median(np.abs(off)) < 1


def test_repeated_angles_count_as_one(capture: Path, tmp_path: Path) -> None:
    def turned(fields: dict[str, Any], folder: Path) -> None:
        for index, angle in ((0, 0), (1, 179.5), (3, 180)):
            fields["photographs"][index]["polariser_deg"] = angle

    said: list[str] = []
    file = changed(capture, tmp_path, turned)
    acquired = acquire_polarization(file, PolarizationOptions(passes=0), said.append)
    remark = "photographs 0, 1 and 3 are at one angle modulo 180° and count as one"
    assert said.count(remark) == acquired.report.remarks.count(remark) == 1
    assert acquired.report.angles == 3


def test_without_an_offset_orientations_are_relative(capture: Path) -> None:
    said: list[str] = []
    acquired = acquire_polarization(capture, PolarizationOptions(), said.append)
    assert acquired.report.is_relative
    assert any("--offset is not given" in remark for remark in said)
    θ, _, diffracts = truth_on(capture, 96, 96)
    gratings = gratings_of(acquired.foil)
    both = diffracts & (gratings.strength > 0.5)
    off = off_deg(gratings.orientation, θ - np.radians(told(capture)["offset_deg"]))[both]
    assert np.median(np.abs(off)) < 0.7


def test_a_smaller_map_has_the_mean_of_pixels(capture: Path) -> None:
    """Half the resolution looks up the same points, and has the mean of four."""
    options = PolarizationOptions(size=(48, 48), offset=np.radians(told(capture)["offset_deg"]))
    acquired = acquire_polarization(capture, options, lambda _: None)
    whole = acquire_polarization(capture, PolarizationOptions(), lambda _: None)
    assert acquired.report.size == (48, 48)
    θ, _, diffracts = truth_on(capture, 48, 48)
    gratings = gratings_of(acquired.foil)
    both = diffracts & (gratings.strength > 0.5)
    assert np.median(np.abs(off_deg(gratings.orientation, θ)[both])) < 0.6
    expected = whole.registered.light.reshape(5, 48, 2, 48, 2).mean(axis=(2, 4))
    assert np.asarray(acquired.registered.light) == pytest.approx(expected, abs=1e-5, nan_ok=True)
    assert acquired.report.noise_deg < 0.8 * whole.report.noise_deg


def test_corners_are_taken_from_the_first_photograph_or_the_camera(
    capture: Path, tmp_path: Path
) -> None:
    def unsaid(fields: dict[str, Any], folder: Path) -> None:
        for photograph in fields["photographs"]:
            del photograph["corners_px"]

    file = changed(capture, tmp_path, unsaid)
    said: list[str] = []
    acquired = acquire_polarization(file, PolarizationOptions(), said.append)
    assert any("instead of photographs.0.corners_px" in remark for remark in said)
    same = acquire_polarization(capture, PolarizationOptions(), lambda _: None)
    assert np.mean(acquired.found.mask == same.found.mask) > 0.999


def test_clipped_pixels_are_unknown(capture: Path, tmp_path: Path) -> None:
    def spot(fields: dict[str, Any], folder: Path) -> None:
        def bright(numbers: np.ndarray) -> np.ndarray:
            numbers[50:60, 40:60] = 65535
            return numbers

        repainted(folder, NAMES[2], bright)

    file = changed(capture, tmp_path, spot)
    said: list[str] = []
    acquired = acquire_polarization(file, PolarizationOptions(), said.append)
    assert any("clipped" in remark for remark in said)
    assert acquired.report.photographs[2].clipped == pytest.approx(200 / 96**2, rel=0.2)
    inside = np.s_[44:50, 36:48]  # 8 px of table are before it
    assert not np.isfinite(acquired.found.fit.mean[inside]).any()
    assert np.all(confidences(acquired.found)[inside] == 0)


def test_an_angle_that_was_noted_wrong(capture: Path, tmp_path: Path) -> None:
    def mistaken(fields: dict[str, Any], folder: Path) -> None:
        fields["photographs"][3]["polariser_deg"] += 60

    message = refusal(changed(capture, tmp_path, mistaken))
    assert f"{NAMES[3]}: photographs.3 = 'light " in message
    assert "what the others foretell" in message and "at 170°" in message
    assert message.endswith(f"see {tmp_path}/refused.{NAMES[3]}.refused.png")


# ---- On a cluster --------------------------------------------------------------------------------


def local_cluster(workers: int) -> Any:
    """Of processes with one thread each; what Dask says of its type is that of its coroutines."""
    return LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=":0")


def test_a_cluster_writes_the_same_bytes(
    capture: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of 96 × 96 pixels in 12 and 8 blocks, on two workers."""
    monkeypatch.setattr(polarization_fit, "BLOCK", 8 * 96)
    monkeypatch.setattr(orientation_filter, "BLOCK", 12 * 96)
    monkeypatch.setattr(orientation_filter, "BLOCK_ROWS", 1)
    here, there = tmp_path / "here", tmp_path / "there"
    command = ("acquire", "polarization", capture, "--passes", "2")
    assert run(*command, "-o", here / "foil").exit_code == 0
    with local_cluster(2) as cluster, Client(cluster) as onlooker:
        stream: Any = get_task_stream(onlooker)
        with stream as tasks:
            scheduler = ("--scheduler", cluster.scheduler_address)
            assert run(*command, "-o", there / "foil", *scheduler).exit_code == 0
    # The photographs' means and circle are fitted first, then all of them, then two passes.
    assert len(tasks.data) == 12 + 12 + 8 + 8
    assert len({task["worker"] for task in tasks.data}) == 2
    names = sorted(file.name for file in here.iterdir())
    assert names == sorted(file.name for file in there.iterdir()) and len(names) == 4
    for name in names:
        assert (here / name).read_bytes() == (there / name).read_bytes()


def test_a_scheduler_that_is_none(
    capture: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(blocks, "TIMEOUT_S", 2)
    file = changed(capture, tmp_path, lambda fields, folder: None)
    with socket.create_server(("127.0.0.1", 0)) as silent:
        port = silent.getsockname()[1]
        message = refusal(file, "--scheduler", f"127.0.0.1:{port}")
    expected = "a Dask scheduler that answers within 2 s"
    assert message == f"options: scheduler = '127.0.0.1:{port}': expected {expected}"
    message = refusal(file, "--scheduler", f"127.0.0.1:{port}")  # nobody listens now
    assert f"scheduler = '127.0.0.1:{port}': expected the address of a Dask" in message
    assert "missing port number" in refusal(file, "--scheduler", "somewhere")


def test_a_cluster_without_workers() -> None:
    with local_cluster(0) as cluster:
        address = cluster.scheduler_address
        with refused("options", "scheduler", address, "one worker or more"):
            with blocks.on_cluster(address):
                pass


# ---- Laying photographs on one another -----------------------------------------------------------


def scene(move: Move, size: tuple[int, int], contrast: float) -> np.ndarray:
    """A smooth pattern as a moved camera shows it: pixel p shows what `moved` takes to p."""
    width, height = size
    x, y = np.meshgrid(np.arange(width), np.arange(height))
    middle = (np.array(size) - 1) / 2
    seen = np.stack([x.ravel(), y.ravel()], 1) - middle - move.shift
    cosine, sine = np.cos(move.turn), np.sin(move.turn)
    at = seen @ np.array([[cosine, -sine], [sine, cosine]])
    rng = np.random.default_rng(4)
    waves = rng.uniform(-0.25, 0.25, (12, 2))
    pattern = np.cos(at @ waves.T + rng.uniform(0, 6, 12)).sum(axis=1)
    return (10 + contrast * pattern).reshape(height, width).astype(np.float32)


@pytest.mark.parametrize("contrast", [1.0, -0.7])
@pytest.mark.parametrize(
    "shift, turn_deg", [((0.0, 0.0), 0.0), ((3.3, -7.6), 0.4), ((25.0, 10.0), -1.0)]
)
def test_moves_are_found_whatever_the_contrast(
    contrast: float, shift: tuple[float, float], turn_deg: float
) -> None:
    size = (300, 270)
    still = Move(np.zeros(2), 0.0, 1.0)
    truth = Move(np.array(shift), np.radians(turn_deg), 1.0)
    found = Outlines(scene(still, size, 1)).move_of(Outlines(scene(truth, size, contrast)))
    assert found.shift == pytest.approx(truth.shift, abs=0.025)
    assert found.turn == pytest.approx(truth.turn, abs=2e-4)
    assert found.quality > 0.99
    corner = np.array([[10.0, 20.0]])
    assert found.moved(corner, size) == pytest.approx(truth.moved(corner, size), abs=0.05)


def test_large_photographs_are_compared_reduced(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(registration_module, "LONGEST", 160)
    monkeypatch.setattr(registration_module, "COARSEST", 64)
    size = (301, 272)
    truth = Move(np.array([5.5, 2.25]), 0.01, 1.0)
    first = Outlines(scene(Move(np.zeros(2), 0.0, 1.0), size, 1))
    assert first.factor == 2 and first.levels[0].shape == (136, 150) and len(first.levels) == 2
    found = first.move_of(Outlines(scene(truth, size, 1)))
    assert found.shift == pytest.approx(truth.shift, abs=0.05)
    assert found.turn == pytest.approx(truth.turn, abs=2e-4)


def test_something_else_does_not_lie_on_it() -> None:
    size = (200, 200)
    first = Outlines(scene(Move(np.zeros(2), 0.0, 1.0), size, 1))
    noise = np.random.default_rng(2).random((200, 200)).astype(np.float32)
    assert first.move_of(Outlines(noise)).quality < 0.2
    assert first.move_of(Outlines(np.ones((200, 200), np.float32))).quality == 0


def test_likeness_is_that_of_the_print() -> None:
    size, frame = (200, 200), np.full((200, 200), 40, np.float32)
    still = Move(np.zeros(2), 0.0, 1.0)
    truth = Move(np.array([2.5, -1.5]), 0.01, 1.0)
    corners = np.array([[40.0, 40], [160, 40], [160, 160], [40, 160]])

    def framed(move: Move, contrast: float) -> Outlines:
        picture = frame.copy()
        picture[30:170, 30:170] = scene(move, size, contrast)[30:170, 30:170]
        return Outlines(picture)

    first = framed(still, 1)
    assert first.likeness(framed(truth, -0.7), truth, corners) > 0.95
    assert first.likeness(framed(truth, 1), still, corners) < 0.85  # 3 px off
    other = Move(np.array([80.0, 50.0]), 1.0, 1.0)  # another part of the pattern
    assert abs(first.likeness(framed(other, 1), still, corners)) < 0.3
    assert first.likeness(Outlines(frame), still, corners) == 0


@pytest.mark.parametrize("noise, off", [(0, 0.005), (5, 0.2)])
def test_noise_that_hides_fine_edges(noise: float, off: float) -> None:
    """The pattern's deviation is 2.4: coarser pictures tell the move, at the finest edges drown."""
    size = (512, 512)
    still, truth = Move(np.zeros(2), 0.0, 1.0), Move(np.array([2.5, -1.5]), 0.01, 1.0)
    corners = np.array([[40.0, 40], [472, 40], [472, 472], [40, 472]])
    rng = np.random.default_rng(3)

    def noisy(move: Move) -> Outlines:
        return Outlines(scene(move, size, 1) + rng.normal(0, noise, size).astype(np.float32))

    first, second = noisy(still), noisy(truth)
    move = first.move_of(second)
    # Where pixels are, corners included: a turn moves those by 360 px times it.
    apart = move.moved(corners, size) - truth.moved(corners, size)
    assert np.hypot(*apart.T).max() < 5 * off
    np.testing.assert_allclose(move.shift, truth.shift, atol=off)
    assert first.likeness(second, move, corners) > 0.7
    elsewhere = noisy(Move(np.array([80.0, 50.0]), 1.0, 1.0))
    assert abs(first.likeness(elsewhere, still, corners)) < 0.3


# ---- Which pixels diffract -----------------------------------------------------------------------


def noisy_light(noise: float, ψ: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Light of stripes of gratings and bare mirrors under a retarder, and θ and who diffracts."""
    rng = np.random.default_rng(5)
    y, x = np.mgrid[:120, :120]
    θ = np.pi * np.mod(x // 24 * 0.2 + y // 20 / 12, 1)
    diffracts = (x // 12) % 4 > 0
    own = 0.1 * np.cos(2 * (ψ[:, None, None] - θ))
    common = 1 + 0.15 * np.sin(2 * (ψ[:, None, None] - 0.4))
    light = np.where(diffracts, 0.8 * (common + own), 0.8 * common)
    light = light + noise * rng.standard_normal(light.shape)
    return light.astype(np.float32), θ, diffracts


@pytest.mark.parametrize("noise, wrong", [(0.001, 0.002), (0.02, 0.05), (0.08, 0.15)])
def test_bare_mirrors_are_told_from_gratings(noise: float, wrong: float) -> None:
    """Also where noise in radii is half the radius, from neighbours then."""
    ψ = np.radians(np.arange(8) * 22.5)
    light, θ, diffracts = noisy_light(noise, ψ)
    found = diffracting(light, ψ)
    assert found.circle.known
    assert np.mean(found.mask != diffracts) < wrong
    believed = found.mask & diffracts
    off = off_deg(found.fit.phase / 2, θ)[believed]
    # σ of a phase is σ/g √(2/8) / A, and θ is half of it.
    expected = np.degrees(noise / 0.8 * 0.5 / 0.1 / 2)
    if noise < 0.05:
        assert np.std(off) == pytest.approx(expected, rel=0.2, abs=0.3)
        assert np.degrees(np.median(found.noise[believed])) / 2 == pytest.approx(expected, rel=0.2)


@pytest.mark.parametrize("lit", [0.12, 0.04])
@pytest.mark.parametrize("photographs", [3, 8])
def test_little_of_a_sheet_diffracts(lit: float, photographs: int) -> None:
    """Squares of 5 × 5 pixels among bare mirrors under a retarder."""
    rng = np.random.default_rng(7)
    ψ = np.pi * np.arange(photographs) / photographs
    square = np.ones((5, 5))
    diffracts = np.kron(rng.random((32, 32)) < lit, square) > 0
    θ = np.kron(np.pi * rng.random((32, 32)), square)
    turn = 2 * (ψ[:, None, None] - θ)
    common = 1 + 0.15 * np.sin(2 * (ψ[:, None, None] - 0.4))
    light = 0.8 * (common + 0.2 * np.where(diffracts, np.cos(turn), 0))
    light = light + 0.01 * rng.standard_normal(light.shape)
    found = diffracting(light.astype(np.float32), ψ)
    assert found.circle.known
    assert found.circle.radius == pytest.approx(0.2, rel=0.02)
    assert np.count_nonzero(found.mask != diffracts) < 0.01 * np.count_nonzero(diffracts)
    off = off_deg(found.fit.phase / 2, θ)[found.mask & diffracts]
    # σ/g √(2/K) / A of a phase; 1.5° at the most.
    expected = np.degrees(0.01 / 0.8 * np.sqrt(2 / photographs) / 0.2 / 2)
    assert np.std(off) == pytest.approx(expected, rel=0.2)
    assert np.median(confidences(found)[found.mask]) > 0.95


def test_what_is_counted_from_nowhere_is_worth_nothing() -> None:
    """Two orientations all over: neither their circle's centre nor what is bare can be told."""
    ψ = np.radians(np.arange(8) * 22.5)
    rng = np.random.default_rng(7)
    θ = np.kron(rng.choice([0.3, 1.0], (20, 20)), np.ones((6, 6)))
    light = 1 + 0.2 * np.cos(2 * (ψ[:, None, None] - θ))
    light = light + 0.01 * rng.standard_normal(light.shape)
    found = diffracting(light.astype(np.float32), ψ)
    assert not found.circle.known
    assert found.mask.any() and not confidences(found).any()


def test_what_is_dark_does_not_diffract() -> None:
    """Of a hundredth of the brightness noise is half the light, whatever its phase is."""
    ψ = np.radians(np.arange(8) * 22.5)
    light, _, diffracts = noisy_light(0.004, ψ)
    rng = np.random.default_rng(6)
    light[:, :30] = 0.008 + 0.004 * rng.standard_normal((8, 30, 120))
    found = diffracting(light, ψ)
    assert not found.mask[:28].any()
    assert np.mean(found.mask[32:] != diffracts[32:]) < 0.01


def test_three_photographs_take_noise_from_the_circle() -> None:
    ψ = np.radians([0, 60, 120])
    light, _, diffracts = noisy_light(0.01, ψ)
    found = diffracting(light, ψ)
    expected = 0.01 / 0.8 * np.sqrt(2 / 3) / 0.1
    assert np.median(found.noise[diffracts]) == pytest.approx(expected, rel=0.3)


def test_what_is_found_does_not_depend_on_which_pixels_judge(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    ψ = np.radians(np.arange(8) * 22.5)
    light, θ, diffracts = noisy_light(0.005, ψ)
    monkeypatch.setattr(diffracting_module, "JUDGED", 120**2 / 9)
    found = diffracting(light, ψ)
    assert np.mean(found.mask != diffracts) < 0.002
    assert np.median(np.abs(off_deg(found.fit.phase / 2, θ)[diffracts])) < 1


# ---- Bad input -----------------------------------------------------------------------------------


def test_fewer_files_than_the_capture_says(capture: Path, tmp_path: Path) -> None:
    def removed(fields: dict[str, Any], folder: Path) -> None:
        (folder / NAMES[3]).unlink()

    message = refusal(changed(capture, tmp_path, removed))
    assert "4 files of 5, without polarization-3.tif" in message


def test_a_file_that_is_named_twice(capture: Path, tmp_path: Path) -> None:
    def twice(fields: dict[str, Any], folder: Path) -> None:
        fields["photographs"][3]["file"] = NAMES[2]

    assert "4 files of 5, some named twice" in refusal(changed(capture, tmp_path, twice))


@pytest.mark.parametrize("angles", [[10, 40], [0, 45, 180, 225, 360], [30, 30.2, 75, 75, 75]])
def test_fewer_than_three_angles(capture: Path, tmp_path: Path, angles: list[float]) -> None:
    def turned(fields: dict[str, Any], folder: Path) -> None:
        del fields["photographs"][len(angles) :]
        for photograph, angle in zip(fields["photographs"], angles, strict=True):
            photograph["polariser_deg"] = angle

    message = refusal(changed(capture, tmp_path, turned))
    assert "photographs.polariser_deg" in message  # before any of them is read
    assert "three angles that differ modulo 180°, not 2" in message


def test_a_photograph_of_something_else(capture: Path, tmp_path: Path) -> None:
    def noise(fields: dict[str, Any], folder: Path) -> None:
        rng = np.random.default_rng(1)
        repainted(folder, NAMES[2], lambda n: 20000 + 8000 * rng.random(n.shape))

    message = refusal(changed(capture, tmp_path, noise))
    assert NAMES[2] in message
    assert re.search(r"registration = 'shift \(.*\) px, quality -?0\.0", message)
    assert message.endswith(f"see {tmp_path / 'refused.polarization-2.tif.refused.png'}")
    assert (tmp_path / "refused.polarization-2.tif.refused.png").exists()


def test_a_photograph_of_another_foil_in_its_place(capture: Path, tmp_path: Path) -> None:
    """The sheet's outline is where it was; what is printed on it is not."""

    def turned(fields: dict[str, Any], folder: Path) -> None:
        repainted(folder, NAMES[2], lambda n: n[::-1, ::-1])

    message = refusal(changed(capture, tmp_path, turned))
    assert NAMES[2] in message and "registration = " in message


def test_a_photograph_that_is_flat(capture: Path, tmp_path: Path) -> None:
    def grey(fields: dict[str, Any], folder: Path) -> None:
        repainted(folder, NAMES[1], lambda n: np.full_like(n, 20000))

    message = refusal(changed(capture, tmp_path, grey))
    assert NAMES[1] in message and "numbers = 'flat'" in message


def test_a_photograph_that_is_clipped(capture: Path, tmp_path: Path) -> None:
    def long(fields: dict[str, Any], folder: Path) -> None:
        repainted(folder, NAMES[4], lambda n: 256 + 4 * (n - 256))

    message = refusal(changed(capture, tmp_path, long))
    assert NAMES[4] in message and "of the sample clipped" in message and "brackets" in message


def test_nothing_that_the_polariser_changes(capture: Path, tmp_path: Path) -> None:
    """A print: the first photograph five times, but for noise."""

    def printed(fields: dict[str, Any], folder: Path) -> None:
        camera = read_capture(folder / "capture.json", "polarization").camera
        first = read_image(folder / NAMES[0], camera).numbers.astype(np.float64)
        rng = np.random.default_rng(1)
        for name in NAMES:
            repainted(folder, name, lambda n: first + 100 * rng.standard_normal(n.shape))

    message = refusal(changed(capture, tmp_path, printed))
    assert "diffracting pixels" in message and str(tmp_path / "capture.json") in message


def test_a_sheet_that_is_a_mirror_all_over(tmp_path: Path) -> None:
    """Under a retarder it changes with the polariser, but alike everywhere."""
    ψ = np.radians([0, 40, 80, 120, 160])
    light = 1 + 0.2 * np.sin(2 * ψ)[:, None, None] * np.ones((1, 90, 90))
    light += 0.005 * np.random.default_rng(3).standard_normal(light.shape)
    with pytest.raises(ValueError, match="diffracting pixels"):
        diffracting(light.astype(np.float32), ψ)


def test_options_out_of_range(capture: Path, tmp_path: Path) -> None:
    with refused("options", "periods", (2.0, 1.0), "the shorter first"):
        PolarizationOptions(periods=(2.0, 1.0))
    with refused("options", "size", (4, 100), "8 to 8192"):
        PolarizationOptions(size=(4, 100))
    with refused("options", "height", 0.0, "above 0"):
        PolarizationOptions(height=0.0)
    with refused("options", "offset", float("nan"), "finite"):
        PolarizationOptions(offset=float("nan"))
    file = changed(capture, tmp_path, lambda fields, folder: None)
    assert "not both" in refusal(file, "--period", "1", "--periods", "1", "2")


def test_a_flash_capture(capture: Path, tmp_path: Path) -> None:
    def flash(fields: dict[str, Any], folder: Path) -> None:
        fields["method"] = "flash"
        for photograph in fields["photographs"]:
            del photograph["polariser_deg"]
            photograph["light"] = {"position_mm": [0, 0, 100]}

    assert "method = 'flash': expected polarization" in refusal(changed(capture, tmp_path, flash))
