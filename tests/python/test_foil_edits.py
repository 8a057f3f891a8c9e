"""Edits of a foil: what they leave alone stays, what they move moves as a sheet of foil would."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from refusals import refused
from typer.testing import CliRunner

from precompute.acquisition.pattern import gratings_of, texel_indices
from precompute.acquisition.radiance import Lamp, Relief, foil_radiance
from precompute.cli import app
from precompute.foils.bumps import Bumps
from precompute.foils.edit_lines import parsed
from precompute.foils.edits import edited_map
from precompute.foils.foil_map import foil_axes, foil_map
from precompute.maps import Map, Table
from precompute.profiles import Sinusoidal
from precompute.spectra import WAVELENGTHS

ROWS, COLUMNS = 24, 36
TILE = (18.0, 12.0)


def patches() -> Map:
    """Four patches of 12 × 18 texels: upper left 10°, upper right 50°, lower 100° and 170°.

    The upper ones are of 1.2 and 1.6 µm, the lower ones of 2.0 µm, and the last diffracts by half.
    """
    θ, period, strength = np.zeros((3, ROWS, COLUMNS))
    for rows, columns, angle, a, s in (
        (slice(0, 12), slice(0, 18), 10, 1.2, 1.0),
        (slice(0, 12), slice(18, 36), 50, 1.6, 1.0),
        (slice(12, 24), slice(0, 18), 100, 2.0, 1.0),
        (slice(12, 24), slice(18, 36), 170, 2.0, 0.5),
    ):
        θ[rows, columns], period[rows, columns], strength[rows, columns] = np.radians(angle), a, s
    recipe = {"kind": "foil", "design": "patches", "profile": "sinusoidal"}
    foil = foil_map(θ, 1 / period, strength, height=0.15, tile_mm=TILE, recipe=recipe)
    confidence = np.arange(ROWS * COLUMNS, dtype=float).reshape(ROWS, COLUMNS, 1) / 1024
    axes = foil_axes(ROWS, COLUMNS)
    foil.tables["confidence"] = Table(confidence, axes, ("confidence",), "float16")
    return foil


def edit(*lines: str, foil: Map | None = None, folder: Path = Path()) -> Map:
    return edited_map(foil or patches(), Path("patches.json"), [parsed(x) for x in lines], folder)


def texels(foil: Map) -> np.ndarray:
    return foil.tables["grating"].values


def degrees(foil: Map) -> np.ndarray:
    return np.rad2deg(gratings_of(foil).orientation)


def same(one: Map, other: Map) -> None:
    for key in ("grating", "confidence"):
        np.testing.assert_array_equal(one.tables[key].values, other.tables[key].values)
    assert one.constants["tile_mm"] == pytest.approx(other.constants["tile_mm"])


# ---- What changes nothing ------------------------------------------------------------------------


@pytest.mark.parametrize(
    "lines",
    [
        ["rotate degrees=90"] * 4,
        ["rotate degrees=-90", "rotate degrees=450"],
        ["rotate degrees=180", "rotate degrees=180"],
        ["rotate degrees=0"],
        ["offset degrees=180"],
        ["offset degrees=90", "offset degrees=90"],
        ["repeat across=3 down=2", "crop columns=36 rows=24"],
        ["repeat across=3 down=2", "crop columns=36 rows=24 column=36 row=24"],
        ["rescale factor=3", "rescale factor=0.3333333333333333"],
        ["rescale factor=2 periods=true", "rescale factor=0.5 periods=yes"],
        ["crop columns=36 rows=24"],
    ],
    ids=" then ".join,
)
def test_some_edits_undo_each_other(lines: list[str]) -> None:
    same(edit(*lines), patches())


def test_offsets_add_up() -> None:
    once = edit("offset degrees=77")
    thrice = edit("offset degrees=30", "offset degrees=-13", "offset degrees=240")
    assert texels(once) == pytest.approx(texels(thrice))
    assert degrees(once)[0, 0] == pytest.approx(87)
    assert degrees(once)[-1, 0] == pytest.approx(177)
    assert degrees(once)[-1, -1] == pytest.approx(67)


# ---- Turned as a sheet is turned -----------------------------------------------------------------


def radiance(foil: Map, points: np.ndarray, eye: np.ndarray, light: np.ndarray) -> np.ndarray:
    """What a sheet whose middle is the origin sends to an eye, by the reference."""
    tile = np.array(foil.constants["tile_mm"])
    index = texel_indices(texels(foil).shape[:2], points / tile + 0.5)
    gratings = gratings_of(foil)
    here = type(gratings)(*(part.ravel()[index] for part in vars(gratings).values()))
    slopes = np.zeros_like(points)
    if "normal" in foil.tables:
        slopes = -foil.tables["normal"].values[..., :2].reshape(-1, 2)[index]
    weights = np.zeros((len(WAVELENGTHS), 2))
    weights[120, 0] = weights[220, 1] = 1
    lamp = Lamp(light, np.radians(2), weights)
    relief = Relief(0.15, Sinusoidal(), 16.25, np.radians(2))
    return foil_radiance(points, slopes, here, relief, eye, lamp, 20)


def leaning(foil: Map) -> Map:
    """All of a foil leant by 0.8° towards u and by 0.4° away from v."""
    normal = np.broadcast_to([0.014, -0.007], (ROWS, COLUMNS, 2))
    foil.tables["normal"] = Bumps(normal, 0.02).table()
    return foil


@pytest.mark.parametrize("foil", [patches(), leaning(patches())], ids=["flat", "leaning"])
@pytest.mark.parametrize("angle", [90.0, 180.0, -90.0, 30.0, 197.0])
def test_the_turned_foil_is_the_foil_turned(angle: float, foil: Map) -> None:
    """With eye and lamp turned alike each point sends what it did before."""
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    # In the middles of the patches, at least a texel from their edges.
    points = np.array([[-5.0, 2.5], [4.5, 3.5], [-4.0, -2.5], [5.0, -3.0]])
    # Where the first order of a grating in the patch's direction, λ/a, about meets the eye.
    light = np.array([120.0, 60.0, 300.0])
    eyes = [np.array(eye) for eye in ([20.0, 0, 350], [0, -150, 300], [-200, 60, 280])]
    upright, turned = foil, edit(f"rotate degrees={angle}", foil=foil)
    for eye in eyes:
        before = radiance(upright, points, eye, light)
        after = radiance(turned, points @ turn[:2, :2].T, turn @ eye, turn @ light)
        assert before.max() > 1e-3
        assert after == pytest.approx(before, rel=1e-6)
    # The gratings have to turn as well: with those that stay something else is seen.
    left = edit(f"rotate degrees={angle}", f"offset degrees={-angle}", foil=foil)
    if angle % 180:
        seen = radiance(left, points @ turn[:2, :2].T, turn @ eyes[0], turn @ light)
        assert seen != pytest.approx(radiance(upright, points, eyes[0], light), rel=0.5)


def test_a_quarter_turn_takes_the_right_side_to_the_top() -> None:
    turned = edit("rotate degrees=90")
    assert texels(turned).shape == (COLUMNS, ROWS, 4)
    assert turned.constants["tile_mm"] == pytest.approx((12, 18))
    # Counter-clockwise: 50° from the upper right to the upper left, 10° to the lower left.
    found = degrees(turned)[[0, -1, 0, -1], [0, 0, -1, -1]]
    assert found == pytest.approx([140, 100, 80, 10])
    confidence = turned.tables["confidence"]
    assert confidence.values[0, 0, 0] == (COLUMNS - 1) / 1024
    assert [axis.size for axis in confidence.axes] == [COLUMNS, ROWS]


def test_a_foil_turned_aslant_is_bare_around_and_keeps_its_area() -> None:
    turned = edit("rotate degrees=30")
    width, height = np.ravel(turned.constants["tile_mm"])
    # 18 cos 30° + 12 sin 30° by 18 sin 30° + 12 cos 30°, up to a texel of ½ mm.
    assert (width, height) == pytest.approx((21.59, 19.39), abs=0.5)
    rows, columns, _ = texels(turned).shape
    assert (width / columns, height / rows) == pytest.approx((0.5, 0.5))
    strength = texels(turned)[..., 3]
    assert strength[0, 0] == strength[-1, -1] == 0
    assert np.count_nonzero(strength) == pytest.approx(ROWS * COLUMNS, rel=0.02)


# ---- Periods, masks, sizes -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("blend", "at"),
    [
        ("linear", lambda t: t),
        ("quadratic", lambda t: t * t),
        ("sin2", lambda t: (1 - np.cos(np.pi * t)) / 2),
    ],
)
@pytest.mark.parametrize("bins", [18, 180])
def test_periods_follow_orientation(blend: str, at: Any, bins: int) -> None:
    """Shortest at 0°, longest one bin below 180°: patches of 10, 50, 100 and 170° lie in bins."""
    foil = edit(f"period shortest=1.2 longest=2.2 bins={bins} blend={blend}")
    period = 1 / texels(foil)[..., 2]
    for (row, column), angle in zip(
        ((0, 0), (0, -1), (-1, 0), (-1, -1)), (10, 50, 100, 170), strict=False
    ):
        t = angle * bins / 180 / (bins - 1)
        assert period[row, column] == pytest.approx(1.2 + 1.0 * at(t))
    expected = [1 / period.max(), 1 / period.min()]
    assert [foil.constants[f"{m}_frequency"] for m in ("min", "max")] == pytest.approx(expected)


def test_rounding_to_8_bits_does_not_move_orientations_to_another_bin(tmp_path: Path) -> None:
    """Multiples of 15°, as stored in 8 bits, in 12 bins: each has a period of its own."""
    θ = np.radians(15.0 * np.arange(12))[None, :] + np.zeros((2, 1))
    foil_map(θ, 1 / 1.66, 1.0, height=0.15, tile_mm=1, recipe={}).write(tmp_path, "steps")
    stored = Map.read(tmp_path / "steps")
    foil = edit("period shortest=1 longest=2.1 bins=12", foil=stored)
    assert 1 / texels(foil)[0, :, 2] == pytest.approx(1 + 0.1 * np.arange(12))


def test_a_mask_leaves_what_is_light(tmp_path: Path) -> None:
    grey = np.zeros((2, 3), np.uint8)
    grey[0, 0], grey[1, 2] = 255, 51
    Image.fromarray(grey).save(tmp_path / "mask.png")
    foil = edit("mask file=mask.png", folder=tmp_path)
    strength = texels(foil)[..., 3]
    # A third of the columns and half of the rows for each pixel.
    assert np.all(strength[:12, :12] == 1)
    assert strength[12:, 24:] == pytest.approx(0.5 * 0.2)
    assert np.count_nonzero(strength) == 2 * 12 * 12
    told = foil.recipe["edits"][0]
    assert told["sha256"] == hashlib.sha256((tmp_path / "mask.png").read_bytes()).hexdigest()
    inverted = edit("mask file=mask.png invert=true", folder=tmp_path)
    assert texels(inverted)[..., 3] + strength == pytest.approx(texels(patches())[..., 3])


def test_a_transparent_mask_is_a_dark_one(tmp_path: Path) -> None:
    image = np.full((2, 2, 4), 255, np.uint8)
    image[0, :, 3] = 0
    Image.fromarray(image).save(tmp_path / "mask.png")
    strength = texels(edit("mask file=mask.png", folder=tmp_path))[..., 3]
    assert strength[:12].max() == 0
    assert strength[12:].min() == 0.5


def test_a_crop_is_a_rectangle_from_the_top_left() -> None:
    foil = edit("crop columns=9 rows=6 column=12 row=10")
    np.testing.assert_array_equal(texels(foil), texels(patches())[10:16, 12:21])
    assert foil.constants["tile_mm"] == pytest.approx((4.5, 3.0))
    assert foil.tables["confidence"].values.shape == (6, 9, 1)


def test_a_repeat_is_tiles_side_by_side() -> None:
    foil = edit("repeat across=2 down=3")
    np.testing.assert_array_equal(texels(foil), np.tile(texels(patches()), (3, 2, 1)))
    assert foil.constants["tile_mm"] == pytest.approx((36, 36))
    same(edit("repeat across=2", "repeat down=3"), foil)


@pytest.mark.parametrize(("periods", "longest"), [("false", 2.0), ("true", 5.0)])
def test_rescaled_patterns_keep_their_periods_unless_told(periods: str, longest: float) -> None:
    foil = edit(f"rescale factor=2.5 periods={periods}")
    assert texels(foil).shape == (60, 90, 4)
    assert foil.constants["tile_mm"] == pytest.approx((45, 30))
    assert foil.constants["min_frequency"] == pytest.approx(1 / longest)
    assert degrees(foil)[[0, 29, 30, 59], [44, 45, 44, 45]] == pytest.approx([10, 50, 100, 170])


def test_edits_come_in_the_order_given() -> None:
    first = edit("crop columns=18 rows=12", "rotate degrees=90")
    assert np.unique(degrees(first).round(6)) == pytest.approx([100])
    other = edit("rotate degrees=90", "crop columns=12 rows=18")
    assert np.unique(degrees(other).round(6)) == pytest.approx([140])


# ---- Files ---------------------------------------------------------------------------------------


def test_a_map_tells_how_it_was_made(tmp_path: Path) -> None:
    """Through files and the command, in one go or in two: the same lines, the same texels."""
    patches().write(tmp_path, "patches")
    Image.fromarray(np.full((3, 3), 255, np.uint8)).save(tmp_path / "white.png")
    lines = [
        f"mask file='{tmp_path / 'white.png'}'",
        "crop columns=20 rows=10",
        "rotate degrees=90",
    ]

    def run(source: str, name: str, some: list[str]) -> Map:
        options = [part for line in some for part in ("--edit", line)]
        arguments = ["edit", str(tmp_path / source), "-o", str(tmp_path / name), *options]
        result = CliRunner().invoke(app, arguments)
        assert result.exit_code == 0, result.output
        return Map.read(tmp_path / name)

    once = run("patches.json", "once", lines)
    run("patches", "half", lines[:2])
    twice = run("half", "twice", lines[2:])
    assert once.recipe == twice.recipe
    recipe = once.recipe
    assert (recipe["kind"], recipe["design"]) == ("foil", "edited")
    assert recipe["profile"] == "sinusoidal"
    assert recipe["from"] == {"map": "patches", "recipe": patches().recipe}
    assert [line["kind"] for line in recipe["edits"]] == ["mask", "crop", "rotate"]
    assert recipe["edits"][0]["file"] == "white.png"
    assert recipe["edits"][2] == {"kind": "rotate", "degrees": 90.0}
    for key in ("grating", "confidence"):
        np.testing.assert_array_equal(once.tables[key].values, twice.tables[key].values)
    # Its stored texels are the source's, moved: nothing is rounded again.
    stored = texels(Map.read(tmp_path / "patches"))
    expected = np.rot90(stored[:10, :20])
    assert texels(once)[..., 3] == pytest.approx(expected[..., 3])
    assert texels(once)[..., :2] == pytest.approx(-expected[..., :2], abs=1e-12)
    assert texels(once)[..., 2] == pytest.approx(expected[..., 2], abs=1e-12)


def test_a_map_that_is_only_read_and_written_keeps_its_texels(tmp_path: Path) -> None:
    patches().write(tmp_path, "one")
    edit("rotate degrees=0", foil=Map.read(tmp_path / "one")).write(tmp_path, "two")
    images = [(tmp_path / f"{name}.grating.png").read_bytes() for name in ("one", "two")]
    assert images[0] == images[1]


# ---- Bad input -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("line", "field", "value", "expected"),
    [
        ("", "kind", None, "the field is missing"),
        ("degrees=3", "kind", None, "the field is missing"),
        ("fold", "kind", "fold", "'rotate'"),
        ("rotate", "degrees", None, "the field is missing"),
        ("rotate degrees=up", "degrees", "up", "a valid number"),
        ("rotate degrees=nan", "degrees", "nan", "a finite number"),
        ("rotate 90", "fields", "90", "FIELD=VALUE"),
        ("rotate degrees=1 degrees=2", "fields", "degrees=2", "each field once"),
        ("rotate degrees=1 axis=x", "axis", "x", "no such field"),
        ("mask file='a.png", "quotes", "mask file='a.png", "closing"),
        ("crop columns=0 rows=1", "columns", "0", "greater than or equal to 1"),
        ("crop columns=1 rows=1.5", "rows", "1.5", "a valid integer"),
        ("rescale factor=0", "factor", "0", "0.01"),
        ("period shortest=2 longest=1", "longest", "1", "the shortest, 2 um, or more"),
        ("period shortest=1 longest=2 blend=cubic", "blend", "cubic", "'sin2'"),
        ("period shortest=1 longest=2 bins=1", "bins", "1", "greater than or equal to 2"),
    ],
)
def test_lines_that_are_no_edit_are_refused(
    line: str, field: str, value: object, expected: str
) -> None:
    with refused(f'edit "{line}"', field, value, expected):
        parsed(line)


def test_edits_that_do_not_fit_the_map_are_refused(tmp_path: Path) -> None:
    with refused("edit crop", "columns", 20, "at most 16, from 20 of 36"):
        edit("crop columns=20 rows=3 column=20")
    with refused("edit crop", "rows", 25, "at most 24, from 0 of 24"):
        edit("crop columns=20 rows=25")
    with refused("edit repeat", "across", 1000, "16384 texels a side, not 36000"):
        edit("repeat across=1000")
    with refused("edit rescale", "factor", 50.0, "16384"):
        edit("repeat across=10", "rescale factor=50")
    Image.fromarray(np.zeros((2, 2), np.uint8)).save(tmp_path / "black.png")
    with refused("foil map", "strength", 0.0, "above 0 somewhere"):
        edit("mask file=black.png", folder=tmp_path)
    (tmp_path / "text.png").write_text("no picture")
    for name in ("text.png", "none.png"):
        with pytest.raises(ValueError, match="a readable file"):
            edit(f"mask file={name}", folder=tmp_path)
    Image.fromarray(np.zeros((2, 2), np.uint16)).save(tmp_path / "deep.png")
    with refused(tmp_path / "deep.png", "bits", "I;16", "8 bits"):
        edit("mask file=deep.png", folder=tmp_path)
    metals = Map("metals", "", "", {}, {}, {})
    with refused("patches.json", "kind", "metals", "foil"):
        edit("rotate degrees=90", foil=metals)


def test_the_command_says_it_in_one_line(tmp_path: Path) -> None:
    patches().write(tmp_path, "patches")
    arguments = ["edit", str(tmp_path / "patches"), "-o", str(tmp_path / "out"), "-e"]
    result = CliRunner().invoke(app, [*arguments, "crop columns=99 rows=1"])
    assert result.exit_code == 2
    assert "edit crop: columns = 99: expected at most 36, from 0 of 36" in result.output
    assert not list(tmp_path.glob("out*"))
    sidecar = json.loads((tmp_path / "patches.json").read_text())
    assert sidecar["recipe"] == patches().recipe
