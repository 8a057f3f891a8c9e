"""The foil of polygons: it repeats, its orientations share it equally, 8 bits hold it."""

from pathlib import Path

import numpy as np
import pytest

from precompute.foils.polygons import polygons_foil
from precompute.foils.recipe import PolygonsFoilRecipe
from precompute.maps import Map

RECIPE = PolygonsFoilRecipe(kind="foil", design="polygons", periods=(1.2, 1.66, 2.0))


def grating(recipe: PolygonsFoilRecipe = RECIPE) -> np.ndarray:
    return polygons_foil(recipe).tables["grating"].values


def orientation(values: np.ndarray) -> np.ndarray:
    """θ in degrees, 0 to 180."""
    return np.rad2deg(np.arctan2(values[..., 1], values[..., 0]) / 2) % 180


def changes(θ: np.ndarray, axis: int) -> np.ndarray:
    """Share of texels, by line, that the next line turns; the last line meets the first."""
    differs = np.abs(np.roll(θ, -1, axis) - θ) > 1e-6
    return differs.mean(axis=1 - axis)


@pytest.mark.parametrize("axis", [0, 1])
def test_the_tile_repeats(axis: int) -> None:
    """At the tile's edge orientations change no more often than inside: polygons go on there."""
    lines = changes(orientation(grating()), axis)
    assert lines[-1] <= lines[:-1].max()
    assert lines[-1] < 0.2  # without repetition eleven of twelve texels would differ


def test_the_recipe_says_how_many_orientations_and_all_share_the_foil() -> None:
    for count in (10, 12, 24):
        recipe = RECIPE.model_copy(update={"orientations": count, "polygons": 4 * count})
        found, texels = np.unique(orientation(grating(recipe)).round(6), return_counts=True)
        assert found == pytest.approx(np.arange(count) * 180 / count)
        # Four polygons each, whose sizes differ.
        assert texels / texels.mean() == pytest.approx(np.ones(count), abs=0.4)


def test_default_foil_has_ten_or_more_orientations() -> None:
    recipe = PolygonsFoilRecipe(kind="foil", design="polygons")
    assert len(np.unique(orientation(grating(recipe)).round(6))) >= 10


def test_periods_are_taken_in_turn() -> None:
    found = np.unique(1 / grating()[..., 2].round(12))
    assert found == pytest.approx([1.2, 1.66, 2.0])


@pytest.mark.parametrize("axis", [0, 1])
def test_the_seam_lies_where_polygons_meet(axis: int) -> None:
    values = grating()
    θ, strength = orientation(values), values[..., 3]
    meet = np.abs(np.roll(θ, -1, axis) - θ) > 1e-6
    assert np.all(strength[meet] == 0)
    assert np.all(np.roll(strength, -1, axis)[meet] == 0)
    assert set(np.unique(strength)) == {0, 1}
    assert 0.02 < np.mean(strength == 0) < 0.15
    assert np.all(grating(RECIPE.model_copy(update={"border": 0.0}))[..., 3] == 1)


def test_eight_bits_hold_the_design(tmp_path: Path) -> None:
    designed = polygons_foil(RECIPE)
    designed.write(tmp_path, "foil")
    before = designed.tables["grating"].values
    after = Map.read(tmp_path / "foil").tables["grating"].values
    turned = (orientation(after) - orientation(before) + 90) % 180 - 90
    # Half a step of 2/255 across, over a circle of 2θ: 0.0039·√2/2 rad = 0.16 degrees.
    assert np.abs(turned).max() < 0.17
    assert after[..., 2] == pytest.approx(before[..., 2], abs=0.5 / 255 / 1.2)
    assert np.array_equal(after[..., 3], before[..., 3])
    error = np.sqrt(np.mean((after - before) ** 2) / np.mean(before**2))
    assert designed.error["relative_rms"] == pytest.approx(error, rel=1e-9)


def test_the_first_row_of_the_image_is_the_top(monkeypatch: pytest.MonkeyPatch) -> None:
    """Polygons about v = 0.85 and about v = 0.35: upside down they would change places."""
    points = np.array([[0.5, 0.85], [0.5, 0.35]])
    monkeypatch.setattr("precompute.foils.polygons.spread_points", lambda rng, count: points)
    recipe = RECIPE.model_copy(
        update={"polygons": 2, "orientations": 2, "size": 64, "border": 0.0, "periods": (1.0,)}
    )
    θ = orientation(grating(recipe))
    turn = np.random.default_rng(recipe.seed).permutation(2)
    assert θ[9, 32] == pytest.approx(90 * turn[0])
    assert θ[41, 32] == pytest.approx(90 * turn[1])
