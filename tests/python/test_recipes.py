"""Bad recipes: one error each, of the recipe's file, field and value."""

import json
from pathlib import Path
from typing import Any

import pytest
from refusals import refused

from precompute.bake import bake
from precompute.errors import InputError
from precompute.recipes import read_grating_recipe, read_recipe

STARS = {"kind": "foil", "design": "stars"}
GRATING = {"kind": "grating", "period": 1.6, "height": 0.1}
NAN, INFINITY = float("nan"), float("inf")


def written(folder: Path, contents: object) -> Path:
    file = folder / "recipe.json"
    file.write_text(json.dumps(contents))
    return file


@pytest.mark.parametrize("field", ["period", "height", "coherence", "angular_radius"])
@pytest.mark.parametrize("value", [0, 0.0, -1.0, NAN, INFINITY, -INFINITY])
def test_lengths_and_angular_radii_must_be_positive_and_finite(
    tmp_path: Path, field: str, value: float
) -> None:
    file = written(tmp_path, {**GRATING, field: value})
    positive = value == value and abs(value) < INFINITY
    with refused(file, field, value, "greater than 0" if positive else "a finite number"):
        read_grating_recipe(file)


def test_a_source_without_angular_radius_is_a_point(tmp_path: Path) -> None:
    recipe = read_grating_recipe(written(tmp_path, GRATING))
    assert recipe.light(tmp_path).angular_radius == 0


@pytest.mark.parametrize(
    ("change", "field", "value", "expected"),
    [
        ({"metal": "tin"}, "metal", "tin", "'aluminium'"),
        ({"illuminant": "D50"}, "illuminant", "D50", "D65, A, inverse-A"),
        ({"observer": "1964-10"}, "observer", "1964-10", "'1931-2'"),
        ({"profile": "round"}, "profile.kind", "round", "'sinusoidal', 'rectangular'"),
        ({"profile": {"duty": 0.5}}, "profile.kind", None, "a kind"),
        ({"profile": {"kind": "rectangular", "duty": 1}}, "profile.duty", 1, "less than 1"),
        ({"profile": {"kind": "sampled"}}, "profile.heights", None, "missing"),
        ({"profile": {"kind": "sampled", "heights": [0, 2]}}, "profile.heights.1", 2, "less than"),
        ({"roughness": -0.1}, "roughness", -0.1, "greater than or equal to 0"),
        ({"roughness": 1.6}, "roughness", 1.6, "less than 1.57"),
        ({"tint": [1, NAN, 1]}, "tint.1", NAN, "finite"),
        ({"energy": "free"}, "energy", "free", "'conserving'"),
        ({"method": "guess"}, "method", "guess", "'closed-form'"),
        ({"wavelength_step": 0.5}, "wavelength_step", 0.5, "less than or equal to 0.05"),
        ({"profile": "blazed", "efficiencies": "taylor"}, "efficiencies", "taylor", "table"),
        ({"perid": 1}, "perid", 1, "no such field"),
        ({"period": "wide"}, "period", "wide", "a valid number"),
        ({"kind": "profile"}, "kind", "profile", "'grating'"),
    ],
)
def test_bad_grating_recipe_is_refused(
    tmp_path: Path, change: dict[str, Any], field: str, value: object, expected: str
) -> None:
    file = written(tmp_path, {**GRATING, **change})
    with refused(file, field, value, expected):
        read_grating_recipe(file)


@pytest.mark.parametrize(
    ("contents", "field", "value", "expected"),
    [
        (GRATING, "kind", "grating", "'profile', 'lobes', 'metals', 'foil'"),
        ({}, "kind", None, "a kind"),
        ({"kind": "profile"}, "profile", None, "missing"),
        ({"kind": "profile", "profile": "round"}, "profile.kind", "round", "'sinusoidal'"),
        (
            {"kind": "profile", "profile": {"kind": "triangular", "apex": 0}},
            "profile.apex",
            0,
            "greater than 0",
        ),
        ({"kind": "lobes", "illuminant": "D50"}, "illuminant", "D50", "D65"),
        ({"kind": "lobes", "widths": 1}, "widths", 1, "greater than or equal to 4"),
        ({"kind": "foil", "design": "polygons", "periods": [1, -1]}, "periods.1", -1, "greater"),
        ({"kind": "foil"}, "design", None, "a design"),
        (
            {"kind": "foil", "design": "hearts"},
            "design",
            "hearts",
            "'polygons', 'stars', 'circles', 'disc', 'figures', 'stochastic'",
        ),
        ({**STARS, "points": 2}, "points", 2, "greater than or equal to 3"),
        ({**STARS, "polygons": 2}, "polygons", 2, "no such field"),
        ({**STARS, "period_range": [2, 1]}, "period_range", [2, 1], "below the longest"),
        ({**STARS, "period_range": [1, 2, 3]}, "period_range", [1, 2, 3], "at most 2 items"),
        ({**STARS, "period_range": [0, 1]}, "period_range.0", 0, "greater than 0"),
        (
            {**STARS, "periods": [1.5], "period_range": [1, 2]},
            "periods",
            [1.5],
            "no such field where period_range is stated",
        ),
        ({**STARS, "periods": []}, "periods", [], "at least 1 item"),
        ({**STARS, "variation": "smooth"}, "variation", "smooth", "no period_range"),
        ({**STARS, "seed": -1}, "seed", -1, "greater than or equal to 0"),
        ([], "contents", [], "object"),
    ],
)
def test_bad_recipe_is_refused_and_nothing_is_baked(
    tmp_path: Path, contents: object, field: str, value: object, expected: str
) -> None:
    file = written(tmp_path, contents)
    with refused(file, field, value, expected):
        bake(file, tmp_path / "maps")
    assert not (tmp_path / "maps").exists()


def test_unreadable_recipes_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "none.json"
    problem = f"[Errno 2] No such file or directory: '{file}'"
    with refused(file, "contents", problem, "a readable file"):
        read_recipe(file)
    for text in ("[" * 100_000, '{"kind": "lobes", "illuminant": "a\\ud800.csv"}'):
        file.write_text(text)
        with pytest.raises(InputError) as caught:
            read_recipe(file)
        assert (caught.value.file, caught.value.field) == (str(file), "contents")
    file.write_text('{"kind": "lobes", "illuminant": "a\\u0000.csv"}')
    with refused(file, "contents", "a NUL character", "a readable file"):
        read_recipe(file)
    file.write_text("{'kind': 'metals'}")
    problem = "Expecting property name enclosed in double quotes: line 1 column 2 (char 1)"
    with refused(file, "contents", problem, "a readable file"):
        read_recipe(file)


def test_a_csv_illuminant_is_looked_for_beside_its_recipe(tmp_path: Path) -> None:
    file = written(tmp_path, {"kind": "lobes", "illuminant": "lamp.csv"})
    lamp = tmp_path / "lamp.csv"
    problem = f"[Errno 2] No such file or directory: '{lamp}'"
    with refused(lamp, "contents", problem, "a readable file"):
        bake(file, tmp_path)
    recipe = read_grating_recipe(written(tmp_path, {**GRATING, "illuminant": "lamp.csv"}))
    assert recipe.light(tmp_path).illuminant == str(lamp)
