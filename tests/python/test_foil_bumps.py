"""Bumps of a foil: slopes by closed forms, at their places, and with the right signs."""

from __future__ import annotations

import hashlib
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from refusals import refused
from rich.console import Console

from precompute.foils.bumps import Bumps, random_bumps
from precompute.foils.edit_lines import parsed
from precompute.foils.edits import edited_map
from precompute.foils.foil_map import foil_map
from precompute.inspection import description, write_pictures
from precompute.maps import Map

ROWS, COLUMNS = 96, 160
TILE = (20.0, 12.0)
"""Width and height, mm: texels of an eighth of a millimetre."""
DEVIATION = np.tan(np.radians(0.5))


def flat() -> Map:
    θ = np.zeros((ROWS, COLUMNS))
    return foil_map(θ, 1 / 1.66, 1.0, height=0.15, tile_mm=TILE, recipe={"kind": "foil"})


def edit(*lines: str, foil: Map | None = None, folder: Path = Path()) -> Map:
    return edited_map(foil or flat(), Path("flat.json"), [parsed(x) for x in lines], folder)


def normals(foil: Map) -> np.ndarray:
    return foil.tables["normal"].values[..., :2]


RANDOM = "bumps deviation_deg=0.5 length_mm=1.2"


# ---- At random -----------------------------------------------------------------------------------


def test_slopes_have_the_stated_deviation_and_correlate_as_the_gradient_of_gaussian_heights() -> (
    None
):
    """Of heights with ρ = exp(−d²/L²): the second derivatives of ρ, by hand, at all distances."""
    length = 1.2
    normal = random_bumps((ROWS, COLUMNS), TILE, DEVIATION, length, 3).normal
    assert normal.std(axis=(0, 1)) == pytest.approx(DEVIATION, rel=1e-3)
    assert normal.mean(axis=(0, 1)) == pytest.approx(0, abs=1e-6 * DEVIATION)
    spectra = np.fft.fft2(normal, axes=(0, 1))

    def correlation(a: int, b: int) -> np.ndarray:
        product = spectra[..., a] * np.conj(spectra[..., b])
        return np.fft.ifft2(product).real / (ROWS * COLUMNS * DEVIATION**2)

    du = np.fft.fftfreq(COLUMNS, 1 / TILE[0])
    dv = -np.fft.fftfreq(ROWS, 1 / TILE[1])[:, None]
    gaussian = np.exp(-(du**2 + dv**2) / length**2)
    for a, b, expected in (
        (0, 0, (1 - 2 * du**2 / length**2) * gaussian),
        (1, 1, (1 - 2 * dv**2 / length**2) * gaussian),
        (0, 1, -2 * du * dv / length**2 * gaussian),
    ):
        assert correlation(a, b) == pytest.approx(expected, abs=1e-3)


def test_slopes_are_those_of_one_surface_without_a_seam() -> None:
    """Its height at a texel is the same by way of u first and by way of v first, round the tile."""
    normal = random_bumps((ROWS, COLUMNS), TILE, DEVIATION, 1.2, 1).normal
    # Twice around from a texel in the middle, so that the paths cross the seams; v grows upwards.
    tiled = np.tile(normal[::-1], (2, 2, 1))[ROWS // 2 :, COLUMNS // 2 :]

    def climbed(slopes: np.ndarray, axis: int) -> np.ndarray:
        """By the trapezium rule."""
        slopes = np.moveaxis(slopes, axis, 0)
        steps = np.concatenate([np.zeros_like(slopes[:1]), (slopes[1:] + slopes[:-1]) / 2])
        return np.moveaxis(np.cumsum(steps, axis=0), 0, axis) * 0.125

    along_u, along_v = climbed(-tiled[..., 0], 1), climbed(-tiled[..., 1], 0)
    one_way = along_u[:1] + along_v
    other_way = along_v[:, :1] + along_u
    # Heights' deviation is s L/√2; the rule errs by pitch²/(12 L²) of it or so a step.
    deviation = DEVIATION * 1.2 / np.sqrt(2)
    assert one_way.std() == pytest.approx(deviation, rel=0.1)
    assert np.abs(one_way - other_way).max() < 0.1 * deviation
    assert along_u[:, COLUMNS] == pytest.approx(0, abs=1e-12)
    assert along_v[ROWS] == pytest.approx(0, abs=1e-12)


def test_seeds_differ_and_are_kept() -> None:
    first = normals(edit(RANDOM))
    np.testing.assert_array_equal(first, normals(edit(f"{RANDOM} seed=1")))
    other = normals(edit(f"{RANDOM} seed=2"))
    assert np.mean(first * other) == pytest.approx(0, abs=0.2 * DEVIATION**2)


def test_eight_bits_keep_slopes_to_two_hundredths_of_their_deviation(tmp_path: Path) -> None:
    bumpy = edit(RANDOM)
    bumpy.write(tmp_path, "bumpy")
    stored = normals(Map.read(tmp_path / "bumpy"))
    off = (stored - normals(bumpy)).std()
    # Evenly spread over a step, of which 127 reach the steepest slope.
    steepest = np.linalg.norm(normals(bumpy), axis=-1).max()
    assert off == pytest.approx(steepest / 127 / np.sqrt(12), rel=0.03)
    assert off < 0.02 * DEVIATION
    # Read, turned about, and written: no bit has changed.
    edit("rotate degrees=180", foil=Map.read(tmp_path / "bumpy")).write(tmp_path, "half")
    edit("rotate degrees=-180", foil=Map.read(tmp_path / "half")).write(tmp_path, "whole")
    images = [(tmp_path / f"{name}.normal.png").read_bytes() for name in ("bumpy", "whole")]
    assert images[0] == images[1]


# ---- Of a picture --------------------------------------------------------------------------------


def wave(rows: int, columns: int) -> np.ndarray:
    """Heights 0 to 1: two crests along u, three along v, going up and to the right."""
    u = (np.arange(columns) + 0.5) / columns
    v = 1 - (np.arange(rows)[:, None] + 0.5) / rows
    return 0.5 + 0.5 * np.sin(2 * np.pi * (2 * u + 3 * v))


def normals_of_the_wave(depth_mm: float, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    slope = depth_mm / 2 * 2 * np.pi * np.cos(2 * np.pi * (2 * u + 3 * v))
    return -np.stack([slope * 2 / TILE[0], slope * 3 / TILE[1]], axis=-1)


@pytest.mark.parametrize(
    ("rows", "columns", "bits", "tolerance"),
    [(ROWS, COLUMNS, 16, 0.01), (48, 40, 16, 0.01), (400, 700, 16, 0.02), (ROWS, COLUMNS, 8, 0.05)],
)
def test_slopes_of_a_picture_are_those_of_its_wave(
    tmp_path: Path, rows: int, columns: int, bits: int, tolerance: float
) -> None:
    levels = np.round(wave(rows, columns) * (2**bits - 1))
    Image.fromarray(levels.astype(np.uint16 if bits == 16 else np.uint8)).save(tmp_path / "w.png")
    found = normals(edit("bumps file=w.png depth_um=40", folder=tmp_path))
    u = (np.arange(COLUMNS) + 0.5) / COLUMNS
    v = 1 - (np.arange(ROWS)[:, None] + 0.5) / ROWS
    expected = normals_of_the_wave(0.040, u, v)
    assert np.abs(found - expected).max() < tolerance * np.abs(expected).max()


def test_what_is_flat_in_a_picture_stays_flat(tmp_path: Path) -> None:
    heights = np.full((ROWS, COLUMNS), 80, np.uint8)
    heights[40:50, 60:90] = 200
    Image.fromarray(heights).save(tmp_path / "plate.png")
    edit("bumps file=plate.png depth_um=30", folder=tmp_path).write(tmp_path, "plate")
    stored = normals(Map.read(tmp_path / "plate"))
    assert stored[:20] == pytest.approx(0, abs=1e-12)
    # On its left it rises towards u, so that the normal leans back; at its top towards −v.
    assert stored[45, 60, 0] < -0.01
    assert stored[45, 89, 0] > 0.01
    assert stored[40, 75, 1] > 0.01
    assert stored[49, 75, 1] < -0.01


# ---- With other edits ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    "lines",
    [
        ["rotate degrees=90"] * 4,
        ["rotate degrees=180", "rotate degrees=-180"],
        ["repeat across=3 down=2", "crop columns=160 rows=96 column=160 row=96"],
        ["rescale factor=3", "rescale factor=0.3333333333333333"],
        ["period shortest=1.2 longest=2"],
        ["offset degrees=20"],
    ],
    ids=" then ".join,
)
def test_bumps_go_with_their_texels(lines: list[str]) -> None:
    np.testing.assert_allclose(normals(edit(RANDOM, *lines)), normals(edit(RANDOM)), atol=1e-15)


def test_a_quarter_turn_takes_bumps_along_and_turns_them() -> None:
    before, after = normals(edit(RANDOM)), normals(edit(RANDOM, "rotate degrees=90"))
    assert after.shape == (COLUMNS, ROWS, 2)
    # The upper right comes to the upper left; what leant to the right leans up.
    np.testing.assert_array_equal(after[0, 0], [-before[0, -1, 1], before[0, -1, 0]])
    np.testing.assert_array_equal(after[-1, 3], [-before[3, 0, 1], before[3, 0, 0]])


def test_bumps_turned_aslant_are_at_their_places(tmp_path: Path) -> None:
    levels = np.round(wave(ROWS, COLUMNS) * 65535).astype(np.uint16)
    Image.fromarray(levels).save(tmp_path / "w.png")
    foil = edit("bumps file=w.png depth_um=40", "rotate degrees=30", folder=tmp_path)
    rows, columns, _ = foil.tables["normal"].values.shape
    x = (np.arange(columns) + 0.5 - columns / 2) / 8
    y = (rows / 2 - np.arange(rows)[:, None] - 0.5) / 8
    c, s = np.sqrt(3) / 2, 0.5
    u, v = (c * x + s * y) / TILE[0] + 0.5, (c * y - s * x) / TILE[1] + 0.5
    here = normals_of_the_wave(0.040, u, v)
    expected = np.stack(
        [c * here[..., 0] - s * here[..., 1], s * here[..., 0] + c * here[..., 1]], axis=-1
    )
    assert np.abs(normals(foil) - expected).max() < 0.02 * np.abs(expected).max()


def test_larger_bumps_are_as_steep_and_smooth() -> None:
    before, after = normals(edit(RANDOM)), normals(edit(RANDOM, "rescale factor=2"))
    # A quarter of a texel to either side of each.
    expected = 0.75 * before[10, 10] + 0.25 * before[10, 11]
    expected = 0.75 * expected + 0.25 * (0.75 * before[11, 10] + 0.25 * before[11, 11])
    assert after[21, 21] == pytest.approx(expected)
    assert after.std() == pytest.approx(before.std(), rel=0.01)


def test_edits_replace_bumps_and_take_them_away() -> None:
    twice = edit("bumps deviation_deg=2 length_mm=3", RANDOM)
    np.testing.assert_array_equal(normals(twice), normals(edit(RANDOM)))
    bare = edit(RANDOM, "bumps deviation_deg=0")
    assert set(bare.tables) == set(flat().tables)
    assert bare.recipe["edits"][1] == {"kind": "bumps", "deviation_deg": 0.0}


def test_the_map_tells_of_its_bumps(tmp_path: Path) -> None:
    Image.fromarray((255 * wave(30, 30)).astype(np.uint8)).save(tmp_path / "w.png")
    told = edit(RANDOM, "bumps file=w.png depth_um=20", folder=tmp_path).recipe["edits"]
    checksum = hashlib.sha256((tmp_path / "w.png").read_bytes()).hexdigest()
    assert told == [
        {"kind": "bumps", "deviation_deg": 0.5, "length_mm": 1.2, "seed": 1},
        {"kind": "bumps", "file": "w.png", "sha256": checksum, "depth_um": 20.0},
    ]


def test_inspect_says_and_draws_them(tmp_path: Path) -> None:
    edit(RANDOM).write(tmp_path, "bumpy")
    console = Console(width=200, record=True, file=StringIO())
    console.print(description(tmp_path / "bumpy"))
    assert "deviation 0.5 deg along u, 0.5 deg along v" in console.export_text()
    names = [file.name for file in write_pictures(tmp_path / "bumpy", tmp_path)]
    assert names == ["bumpy-grating.png", "bumpy-normal.png"]


# ---- Bad input -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("line", "field", "value", "expected"),
    [
        ("bumps", "deviation_deg", None, "or a file of heights"),
        ("bumps length_mm=2", "deviation_deg", None, "a number of degrees"),
        ("bumps deviation_deg=-1 length_mm=2", "deviation_deg", "-1", "greater than or equal"),
        ("bumps deviation_deg=11 length_mm=2", "deviation_deg", "11", "less than or equal to 10"),
        ("bumps deviation_deg=1", "length_mm", None, "correlation length"),
        ("bumps deviation_deg=1 length_mm=0", "length_mm", "0", "greater than 0"),
        ("bumps deviation_deg=0 length_mm=2", "length_mm", "2", "above 0"),
        ("bumps deviation_deg=1 length_mm=2 depth_um=3", "depth_um", "3", "no such field"),
        ("bumps deviation_deg=1 length_mm=2 seed=-1", "seed", "-1", "greater than or equal to 0"),
        ("bumps file=a.png", "depth_um", None, "white over black"),
        ("bumps file=a.png depth_um=3 deviation_deg=1", "deviation_deg", "1", "no such field"),
        ("bumps file=a.png depth_um=3 length_mm=1", "length_mm", "1", "no such field"),
    ],
)
def test_lines_that_are_no_bumps_are_refused(
    line: str, field: str, value: object, expected: str
) -> None:
    with refused(f'edit "{line}"', field, value, expected):
        parsed(line)


def test_bumps_that_do_not_fit_are_refused(tmp_path: Path) -> None:
    for length in ("0.2", "3.1"):
        with refused("edit bumps", "length_mm", float(length), "0.25 to 3 mm"):
            edit(f"bumps deviation_deg=1 length_mm={length}")
    Image.fromarray((255 * wave(30, 30)).astype(np.uint8)).save(tmp_path / "w.png")
    with refused("edit bumps", "depth_um", 9000.0, "slopes of 1 (45 degrees) at most"):
        edit("bumps file=w.png depth_um=9000", folder=tmp_path)
    Image.fromarray(np.zeros((9, 9), np.uint8)).save(tmp_path / "black.png")
    with refused(tmp_path / "black.png", "heights", "all 0 um", "heights that differ"):
        edit("bumps file=black.png depth_um=9", folder=tmp_path)
    with pytest.raises(ValueError, match="a readable file"):
        edit("bumps file=none.png depth_um=9", folder=tmp_path)
    foil = flat()
    foil.tables["normal"] = Bumps(np.zeros((3, 4, 2)), 0.1).table()
    with refused("flat.json", "arrays.normal.shape", (3, 4, 4), "(96, 160, 4)"):
        edit("rotate degrees=90", foil=foil)
