"""Stochastic foils: shapes that cover and repeat, gratings that follow their distribution."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from refusals import refused
from scipy.stats import chi2
from typer.testing import CliRunner

from precompute.bake import bake
from precompute.cli import app
from precompute.foils.distribution import GratingDistribution
from precompute.foils.recipe import StochasticFoilRecipe
from precompute.foils.shapes import disc, mask, square, strewn
from precompute.foils.stochastic import stochastic_foil
from precompute.maps import Map

SHAPES = ["discs", "squares", "polygons"]
EDGES = np.deg2rad([0, 45, 90, 135, 180]), np.array([0.45, 0.55, 0.65, 0.75])
WEIGHTS = np.array([[6, 1, 1], [1, 8, 1], [1, 2, 5], [3, 0, 1]]) / 30


def recipe(folder: Path, **change: Any) -> StochasticFoilRecipe:
    """A tile of 256 texels with a hundred shapes along its side."""
    GratingDistribution(*EDGES, WEIGHTS).write(folder / "d.json")
    contents = {
        "kind": "foil",
        "design": "stochastic",
        "distribution": {"kind": "file", "file": "d.json"},
        "size": 256,
        "tile_mm": 20.0,
        "shape_mm": 0.4,
    }
    return StochasticFoilRecipe.model_validate(contents | change)


def grating(folder: Path, **change: Any) -> np.ndarray:
    return stochastic_foil(recipe(folder, **change), folder).tables["grating"].values


def orientation(values: np.ndarray) -> np.ndarray:
    """θ, rad, 0 to π."""
    return np.mod(np.arctan2(values[..., 1], values[..., 0]) / 2, np.pi)


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("shape", SHAPES)
def test_the_tile_repeats(tmp_path: Path, shape: str, axis: int) -> None:
    """Gratings change as often over the tile's edge as they do inside."""
    f = grating(tmp_path, shape=shape, shape_mm=1.0)[..., 2]
    lines = np.mean(np.roll(f, -1, axis) != f, axis=1 - axis)
    assert lines[-1] == pytest.approx(lines[:-1].mean(), abs=5 * lines[:-1].std())
    cut = f[:200, :200]
    differs = np.mean(np.roll(cut, -1, axis) != cut, axis=1 - axis)
    assert differs[-1] > differs[:-1].mean() + 10 * differs[:-1].std()


@pytest.mark.parametrize("shape", SHAPES)
def test_areas_follow_the_distribution(tmp_path: Path, shape: str) -> None:
    """One count for each grating that is seen: shapes are covered whatever their grating is."""
    values = grating(tmp_path, shape=shape, size=512)
    distribution = GratingDistribution(*EDGES, WEIGHTS)
    seen = values[values[..., 3] > 0]
    gratings = np.unique(seen, axis=0)
    counts = distribution.histogram_of(orientation(gratings), gratings[:, 2]) * len(gratings)
    assert len(gratings) > 2000

    def chi_square(weights: np.ndarray) -> float:
        some = weights > 0
        expected = weights[some] * len(gratings)
        return float(np.sum((counts[some] - expected) ** 2 / expected))

    limit = float(chi2.ppf(0.999, np.count_nonzero(WEIGHTS) - 1))
    assert counts[WEIGHTS == 0].sum() == 0
    assert counts.sum() == pytest.approx(len(gratings))
    assert chi_square(WEIGHTS) < limit
    # The wrong ones: orientation or frequency by the next cell, or the two unrelated.
    unrelated = np.outer(WEIGHTS.sum(axis=1), WEIGHTS.sum(axis=0))
    for wrong in (np.roll(WEIGHTS, 1, axis=0), np.roll(WEIGHTS, 1, axis=1), unrelated):
        assert chi_square(wrong) > 10 * limit
    # And by area: each cell's share within what so many shapes of unequal area can be off.
    area = distribution.histogram_of(orientation(seen), seen[:, 2])
    assert np.abs(area - WEIGHTS).max() < 0.03
    assert np.abs(area - unrelated).max() > 0.1


@pytest.mark.parametrize("cover", [0.5, 2.0])
@pytest.mark.parametrize("shape", ["discs", "squares", "mask"])
def test_what_is_left_bare(tmp_path: Path, shape: str, cover: float) -> None:
    """Shapes at random places leave exp(−cover) bare, whatever their own area is."""
    image = np.zeros((20, 30), np.uint8)
    image[:10], image[10:, :10] = 255, 200  # two thirds of what is two thirds of a square
    Image.fromarray(image).save(tmp_path / "mask.png")
    change = {"mask": "mask.png"} if shape == "mask" else {}
    values = grating(tmp_path, shape=shape, cover=cover, size=512, **change)
    bare = np.mean(values[..., 3] == 0)
    assert set(np.unique(values[..., 3])) == {0, 1}
    assert bare == pytest.approx(np.exp(-cover), rel=0.05)


def test_polygons_leave_nothing_bare_and_are_as_many_as_asked(tmp_path: Path) -> None:
    values = grating(tmp_path, shape="polygons", shape_mm=1.0)
    assert np.all(values[..., 3] == 1)
    assert len(np.unique(values[..., 2])) == pytest.approx(400, abs=4)


def test_shapes_lie_where_they_are_put_over_edges_and_over_one_another() -> None:
    places = np.array([[0.25, 0.75], [0.0, 0.0], [0.3, 0.75]])
    index = strewn(square, places, 0.25, 64)
    x = (np.arange(64) + 0.5) / 64
    y = x[::-1, None]
    first = (np.abs(x - 0.25) <= 0.125) & (np.abs(y - 0.75) <= 0.125)
    third = (np.abs(x - 0.3) <= 0.125) & (np.abs(y - 0.75) <= 0.125)
    corner = (np.minimum(x, 1 - x) <= 0.125) & (np.minimum(y, 1 - y) <= 0.125)
    expected = np.where(third, 2, np.where(corner, 1, np.where(first, 0, -1)))
    assert np.array_equal(index, expected)


def test_pieces_of_work_make_no_difference(monkeypatch: pytest.MonkeyPatch) -> None:
    places = np.random.default_rng(2).random((500, 2))
    whole = strewn(disc, places, 0.11, 100)
    monkeypatch.setattr("precompute.foils.shapes.TEXELS_AT_ONCE", 1000)
    assert np.array_equal(strewn(disc, places, 0.11, 100), whole)


def test_a_mask_is_upright_as_large_as_asked_and_light(tmp_path: Path) -> None:
    """An L, wider than high: its upright is at the left, its foot below."""
    image = np.full((4, 6, 4), (255, 255, 255, 0), np.uint8)  # light, but transparent
    image[:, :2, 3] = 255
    image[3, :, 3] = 255
    image[0, 1, :3] = 100  # opaque, but dark
    Image.fromarray(image).save(tmp_path / "l.png")
    index = strewn(mask(tmp_path / "l.png"), np.array([[0.5, 0.5]]), 0.25, 48)
    expected = np.full((48, 48), -1)
    expected[20:28, 18:22] = 0  # a pixel of the mask is two texels wide: 12 wide, 8 high
    expected[26:28, 18:30] = 0
    expected[20:22, 20:22] = -1
    assert np.array_equal(index, expected)


def written(folder: Path, **change: Any) -> Path:
    file = folder / "foil.json"
    file.write_text(json.dumps({"kind": "foil", "design": "stochastic"} | change))
    return file


SPIRAL = {"kind": "spiral"}


@pytest.mark.parametrize(
    ("change", "field", "value", "expected"),
    [
        ({}, "distribution", None, "missing"),
        ({"distribution": {}}, "distribution.kind", None, "a kind"),
        ({"distribution": {"kind": "disc"}}, "distribution.kind", "disc", "'spiral', 'file'"),
        ({"distribution": {"kind": "file"}}, "distribution.file", None, "missing"),
        ({"distribution": SPIRAL | {"longest": 1}}, "distribution.longest", 1, "above the short"),
        ({"distribution": SPIRAL | {"spread": 0}}, "distribution.spread", 0, "greater than"),
        ({"shape": "stars"}, "shape", "stars", "'discs', 'squares', 'polygons' or 'mask'"),
        ({"shape": "mask"}, "mask", None, "a PNG file"),
        ({"mask": "x.png"}, "mask", "x.png", "no such field where the shape is squares"),
        ({"shape": "polygons", "cover": 1}, "cover", 1, "no such field where the shape is poly"),
        ({"shape_mm": 0.05}, "shape_mm", 0.05, "two texels to half the tile, 0.09766 to 12.5"),
        ({"shape_mm": 13}, "shape_mm", 13, "two texels to half the tile"),
        ({"cover": 0}, "cover", 0, "greater than 0"),
        ({"seed": -1}, "seed", -1, "greater than or equal to 0"),
        ({"border": 0.1}, "border", 0.1, "no such field"),
    ],
)
def test_bad_recipes_are_refused(
    tmp_path: Path, change: dict[str, Any], field: str, value: object, expected: str
) -> None:
    stated = {} if field == "distribution" else {"distribution": SPIRAL}
    file = written(tmp_path, **(stated | change))
    with refused(file, field, value, expected):
        bake(file, tmp_path / "maps")
    assert not (tmp_path / "maps").exists()


def test_files_that_a_recipe_names_are_looked_for_beside_it(tmp_path: Path) -> None:
    file = written(tmp_path, distribution={"kind": "file", "file": "d.json"})
    problem = f"[Errno 2] No such file or directory: '{tmp_path / 'd.json'}'"
    with refused(tmp_path / "d.json", "contents", problem, "a readable file"):
        bake(file, tmp_path)
    file = written(tmp_path, distribution=SPIRAL, shape="mask", mask="m.png")
    problem = f"[Errno 2] No such file or directory: '{tmp_path / 'm.png'}'"
    with refused(tmp_path / "m.png", "contents", problem, "a readable file"):
        bake(file, tmp_path)
    Image.fromarray(np.zeros((4, 4), np.uint8)).save(tmp_path / "m.png")
    with refused(tmp_path / "m.png", "texels", "all dark or transparent", "a light"):
        bake(file, tmp_path)
    Image.fromarray(np.zeros((4, 4), np.uint16)).save(tmp_path / "m.png")
    with refused(tmp_path / "m.png", "bits", "I;16", "8 bits"):
        bake(file, tmp_path)


def test_a_foil_is_designed_from_a_distribution(tmp_path: Path) -> None:
    GratingDistribution(*EDGES, WEIGHTS).write(tmp_path / "d.json")
    Image.fromarray(np.full((4, 4), 255, np.uint8)).save(tmp_path / "m.png")
    name = tmp_path / "maps" / "mine"
    options = ["--shape", "mask", "--mask", str(tmp_path / "m.png"), "--size", "64"]
    options += ["--tile-mm", "8", "--height", "0.2", "--seed", "4", "--shape-mm", "0.5"]
    command = ["design", "stochastic", str(tmp_path / "d.json"), "-o", str(name), *options]
    result = CliRunner().invoke(app, command)
    assert result.exit_code == 0
    made = Map.read(name)
    assert made.constants["tile_mm"] == (8, 8)
    assert made.constants["height_um"] == 0.2
    assert made.tables["grating"].values.shape == (64, 64, 4)
    # What is stored says how to make it again beside the distribution, and names no folder.
    again = written(tmp_path, **{k: v for k, v in made.recipe.items() if v is not None})
    bake(again, tmp_path)
    assert (tmp_path / "foil.grating.png").read_bytes() == (
        tmp_path / "maps" / "mine.grating.png"
    ).read_bytes()
    assert str(tmp_path) not in (tmp_path / "maps" / "mine.json").read_text()


@pytest.mark.parametrize(
    ("options", "line"),
    [
        (["--shape", "stars"], "design stochastic: shape = 'stars': expected 'discs'"),
        (["--size", "8"], "design stochastic: size = 8: expected greater than or equal to 16"),
        (["--mask", "x.png"], "design stochastic: mask = "),
    ],
)
def test_bad_options_end_with_one_line(tmp_path: Path, options: list[str], line: str) -> None:
    file = tmp_path / "d.json"
    GratingDistribution(*EDGES, WEIGHTS).write(file)
    command = ["design", "stochastic", str(file), "-o", str(tmp_path / "maps" / "x"), *options]
    result = CliRunner().invoke(app, command)
    assert result.exit_code == 2
    assert result.stderr.startswith(line)
    assert result.stderr.count("\n") == 1
    assert not (tmp_path / "maps").exists()
