"""Foils of pieces: they repeat, their orientations share them equally, 8 bits hold them."""

from pathlib import Path

import numpy as np
import pytest
from refusals import refused

from precompute.foils.circles import circles_foil
from precompute.foils.disc import disc_foil
from precompute.foils.foil_map import foil_axes, foil_map
from precompute.foils.polygons import polygons_foil
from precompute.foils.recipe import (
    CirclesFoilRecipe,
    DiscFoilRecipe,
    PolygonsFoilRecipe,
    StarsFoilRecipe,
)
from precompute.foils.stars import stars_foil
from precompute.inspection import write_pictures
from precompute.maps import Map, Table

Drawn = PolygonsFoilRecipe | StarsFoilRecipe | CirclesFoilRecipe

PERIODS = (1.2, 1.66, 2.0)
POLYGONS = PolygonsFoilRecipe(kind="foil", design="polygons", periods=PERIODS)
STARS = StarsFoilRecipe(kind="foil", design="stars", periods=PERIODS)
CIRCLES = CirclesFoilRecipe(kind="foil", design="circles", periods=PERIODS)
DESIGNS = [pytest.param(r, id=r.design) for r in (POLYGONS, STARS, CIRCLES)]


def foil(recipe: Drawn) -> Map:
    match recipe:
        case StarsFoilRecipe():
            return stars_foil(recipe)
        case CirclesFoilRecipe():
            return circles_foil(recipe)
        case PolygonsFoilRecipe():
            return polygons_foil(recipe)
    raise TypeError(recipe)


def grating(recipe: Drawn, **change: object) -> np.ndarray:
    return foil(recipe.model_copy(update=change)).tables["grating"].values


def orientation(values: np.ndarray) -> np.ndarray:
    """θ in degrees, 0 to 180."""
    return np.rad2deg(np.arctan2(values[..., 1], values[..., 0]) / 2) % 180


def changes(θ: np.ndarray, axis: int) -> np.ndarray:
    """Share of texels, by line, that the next line turns; the last line meets the first."""
    differs = np.abs(np.roll(θ, -1, axis) - θ) > 1e-6
    return differs.mean(axis=1 - axis)


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("recipe", DESIGNS)
def test_the_tile_repeats(recipe: Drawn, axis: int) -> None:
    """At the tile's edge orientations change no more often than inside: pieces go on there."""
    θ = orientation(grating(recipe))
    lines = changes(θ, axis)
    assert lines[-1] <= lines[:-1].max()
    assert lines[-1] < 0.2
    # Without repetition eleven of twelve texels would differ.
    cut = changes(θ[:170, :170], axis)
    assert cut[-1] > max(0.6, cut[:-1].max())


def test_the_recipe_says_how_many_orientations_and_all_share_the_foil() -> None:
    for count in (10, 12, 24):
        values = grating(POLYGONS, orientations=count, polygons=4 * count)
        found, texels = np.unique(orientation(values).round(6), return_counts=True)
        assert found == pytest.approx(np.arange(count) * 180 / count)
        # Four polygons each, whose sizes differ.
        assert texels / texels.mean() == pytest.approx(np.ones(count), abs=0.4)


@pytest.mark.parametrize("count", [10, 12])
@pytest.mark.parametrize(("recipe", "number"), [(STARS, "stars"), (CIRCLES, "circles")])
def test_stars_and_circles_share_orientations_equally(
    recipe: Drawn, number: str, count: int
) -> None:
    """Four of each piece of a star or a disc have each of them."""
    values = grating(recipe, orientations=count, border=0.0, **{number: 4 * count})
    found, texels = np.unique(orientation(values).round(6), return_counts=True)
    assert found == pytest.approx(np.arange(count) * 180 / count)
    assert texels / texels.mean() == pytest.approx(np.ones(count), abs=0.25)


@pytest.mark.parametrize("recipe", DESIGNS)
def test_default_foils_have_ten_or_more_orientations_and_one_period(
    recipe: Drawn,
) -> None:
    default = type(recipe).model_validate({"kind": "foil", "design": recipe.design})
    values = grating(default)
    assert len(np.unique(orientation(values).round(6))) >= 10
    assert 1 / np.unique(values[..., 2]) == pytest.approx([1.66])
    assert values[..., 3].mean() > 0.8


@pytest.mark.parametrize("recipe", DESIGNS)
def test_periods_are_those_listed(recipe: Drawn) -> None:
    found = np.unique(1 / grating(recipe)[..., 2].round(12))
    assert found == pytest.approx(PERIODS)


@pytest.mark.parametrize("recipe", DESIGNS)
def test_each_piece_has_a_period_of_the_range(recipe: Drawn) -> None:
    made = foil(
        recipe.model_copy(update={"periods": None, "period_range": (1.2, 2.0), "border": 0.004})
    )
    period = 1 / made.tables["grating"].values[..., 2]
    found = np.unique(period.round(9))
    pieces = {"polygons": 48, "stars": 12 * 11, "circles": 16 * 5}[recipe.design]
    # Some lie under a seam or between texels.
    assert 0.95 * pieces <= len(found) <= pieces
    steps = (found - 1.2) / (0.8 / (pieces - 1))
    assert steps == pytest.approx(steps.round(), abs=1e-6)
    assert (found[0], found[-1]) == pytest.approx((1.2, 2.0), abs=0.02)
    assert made.constants["min_frequency"] == pytest.approx(1 / found[-1])
    # What varies from piece to piece is alike within: where the period changes there is a seam.
    strength = made.tables["grating"].values[..., 3]
    assert np.all(strength[np.abs(np.roll(period, -1, 0) - period) > 1e-9] == 0)


@pytest.mark.parametrize("recipe", DESIGNS)
def test_a_smooth_period_rises_and_falls_once(recipe: Drawn) -> None:
    """a = shortest + (longest − shortest)·(sin² πx + sin² πy)/2, over opposite edges too."""
    change = {"periods": None, "period_range": (1.2, 2.0), "variation": "smooth"}
    period = 1 / grating(recipe, **change)[..., 2]
    texel = (np.arange(256) + 0.5) / 256
    wave = np.sin(np.pi * texel) ** 2
    assert period == pytest.approx(1.2 + 0.4 * (wave + wave[:, None]), rel=1e-12)


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("recipe", DESIGNS)
def test_the_seam_lies_where_pieces_meet(recipe: Drawn, axis: int) -> None:
    values = grating(recipe, border=0.004)
    θ, strength = orientation(values), values[..., 3]
    meet = np.abs(np.roll(θ, -1, axis) - θ) > 1e-6
    assert np.all(strength[meet] == 0)
    assert np.all(np.roll(strength, -1, axis)[meet] == 0)
    assert set(np.unique(strength)) == {0, 1}
    assert 0.02 < np.mean(strength == 0) < 0.3
    assert np.all(grating(recipe, border=0.0)[..., 3] == 1)


@pytest.mark.parametrize("recipe", DESIGNS)
def test_eight_bits_hold_the_design(tmp_path: Path, recipe: Drawn) -> None:
    designed = foil(recipe)
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
    change = {"polygons": 2, "orientations": 2, "size": 64, "border": 0.0, "periods": (1.0,)}
    θ = orientation(grating(POLYGONS, **change))
    turn = np.random.default_rng(POLYGONS.seed).permutation(2)
    assert θ[9, 32] == pytest.approx(90 * turn[0])
    assert θ[41, 32] == pytest.approx(90 * turn[1])


PAIR = np.array([[0.25, 0.55], [0.75, 0.55]])
"""Half a tile apart: what lies about them has room for the radius ¼."""


def about_the_first(size: int) -> tuple[np.ndarray, np.ndarray]:
    """Distance and direction (rad) of texels from the first of the pair."""
    texel = (np.arange(size) + 0.5) / size
    x, y = texel - PAIR[0, 0], texel[::-1, None] - PAIR[0, 1]
    return np.hypot(x, y), np.arctan2(y, x)


@pytest.mark.parametrize(("points", "notch"), [(5, 0.45), (3, 0.3), (8, 0.7)])
def test_stars_are_as_large_and_as_pointed_as_asked(
    monkeypatch: pytest.MonkeyPatch, points: int, notch: float
) -> None:
    """2n triangles with the sides R, R·notch and the angle π/n between them."""
    monkeypatch.setattr("precompute.foils.stars.spread_points", lambda *_: PAIR)
    change = {"stars": 2, "points": points, "notch": notch, "border": 0.0, "ground": False}
    star = grating(STARS, size=512, orientations=64, **change)
    shines = star[..., 3] == 1
    area = 2 * points * 0.25**2 * notch * np.sin(np.pi / points)
    assert shines.mean() == pytest.approx(area, rel=0.01)
    distance, direction = about_the_first(512)
    shines &= distance <= 0.25
    far = np.rad2deg(direction[shines & (distance > 0.93 * 0.25)])
    turned = np.random.default_rng(STARS.seed).random(2)[0] * 360
    to_point = (far - turned + 180 / points) % (360 / points) - 180 / points
    assert np.abs(to_point).max() < 10
    assert len(np.unique(((far - turned) / (360 / points)).round() % points)) == points
    # Between two points and two notches there is one grating a facet, each of its own.
    facet = np.floor((np.rad2deg(direction) - turned) / (180 / points)) % (2 * points)
    clear = np.abs((np.rad2deg(direction) - turned) % (180 / points) - 90 / points) < 80 / points
    found = [
        np.unique(orientation(star[shines & clear & (facet == f)]).round(6))
        for f in range(2 * points)
    ]
    assert [len(θ) for θ in found] == [1] * 2 * points
    assert len(np.unique(np.concatenate(found))) == 2 * points


@pytest.mark.parametrize(("rings", "step"), [(4, 36.0), (1, 90.0), (9, 18.0)])
def test_rings_are_as_wide_and_turn_as_asked(
    monkeypatch: pytest.MonkeyPatch, rings: int, step: float
) -> None:
    monkeypatch.setattr("precompute.foils.circles.spread_points", lambda *_: PAIR)
    change = {"circles": 2, "rings": rings, "border": 0.0, "orientations": 10}
    θ = orientation(grating(CIRCLES, size=512, **change))
    bare = grating(CIRCLES, size=512, ground=False, **change)[..., 3] == 0
    assert bare.mean() == pytest.approx(1 - 2 * np.pi * 0.25**2, rel=0.01)
    distance, _ = about_the_first(512)
    within = distance < 0.25
    assert not bare[within].any()
    turns = np.floor(distance / (0.25 / rings)) * step
    assert np.ptp((θ - turns).round(6)[within] % 180) == pytest.approx(0, abs=1e-5)


@pytest.mark.parametrize("recipe", [STARS, CIRCLES])
def test_neighbouring_pieces_differ(recipe: Drawn) -> None:
    """Where seams leave a star or a disc parted, its neighbours have orientations of their own."""
    values = grating(recipe, size=512, border=0.0)
    change = np.abs(np.diff(values[..., 2], axis=0)) > 1e-9  # pieces meet, of other periods
    apart = change & (np.abs(np.diff(orientation(values), axis=0)) > 1e-6)
    # But for the ground's straight borders, where neighbours are of two stars.
    assert apart.sum() > 0.95 * change.sum()


def test_a_map_of_gratings_of_any_origin(tmp_path: Path) -> None:
    """Not square, orientations beyond π, strengths between, and a table of its own."""
    rng = np.random.default_rng(3)
    θ = rng.uniform(-9, 9, (5, 7))
    strength = rng.random((5, 7)).round(2)
    strength[0, 0] = 0.0
    frequency = np.full((5, 7), 0.6)
    frequency[0, 0] = 0.0  # nothing diffracts here
    options = {"height": 0.2, "tile_mm": (70.0, 50.0), "recipe": {"profile": "sinusoidal"}}
    made = foil_map(θ, frequency, strength, **options)
    confidence = Table(strength[..., None], foil_axes(5, 7), ("confidence",), "float16")
    made.tables["confidence"] = confidence
    made.write(tmp_path, "foil")
    read = Map.read(tmp_path / "foil")
    assert set(read.tables) == {"grating", "confidence"}
    pictures = write_pictures(tmp_path / "foil", tmp_path / "pictures")
    assert [p.name for p in pictures] == ["foil-grating.png", "foil-confidence.png"]
    turned = (orientation(read.tables["grating"].values) - np.rad2deg(θ) + 90) % 180 - 90
    assert np.abs(turned).max() < 0.17
    assert read.tables["grating"].values[..., 3] == pytest.approx(strength, abs=0.5 / 255)
    assert read.constants["tile_mm"] == (70.0, 50.0)
    assert read.constants["min_frequency"] == read.constants["max_frequency"] == 0.6
    turned_about = foil_map(θ + np.pi, frequency, strength, **options).tables["grating"].values
    assert turned_about == pytest.approx(made.tables["grating"].values, abs=1e-12)


@pytest.mark.parametrize(
    ("change", "field", "value", "expected"),
    [
        ({"orientation": np.nan}, "orientation", np.nan, "finite"),
        ({"frequency": 0.0}, "frequency", 0.0, "above 0"),
        ({"frequency": np.inf}, "frequency", np.inf, "above 0"),
        ({"frequency": -0.6, "strength": 0.0}, "frequency", -0.6, "above 0"),
        ({"strength": 1.5}, "strength", 1.5, "0 to 1"),
        ({"strength": np.nan}, "strength", np.nan, "0 to 1"),
        ({"strength": 0.0}, "strength", 0.0, "above 0 somewhere"),
    ],
)
def test_what_is_no_grating_is_refused(
    change: dict[str, float], field: str, value: float, expected: str
) -> None:
    fields = {"orientation": 0.0, "frequency": 0.6, "strength": 1.0} | change
    arrays = [np.full((4, 4), fields[name]) for name in ("orientation", "frequency", "strength")]
    with refused("foil map", field, value, expected):
        foil_map(*arrays, height=0.1, tile_mm=1.0, recipe={"profile": "sinusoidal"})


def test_a_disc_s_grating_vectors_are_its_radii() -> None:
    recipe = DiscFoilRecipe(
        kind="foil", design="disc", size=64, tile_mm=32, inner_mm=6, outer_mm=14, period=1.5
    )
    values = disc_foil(recipe).tables["grating"].values
    # Texels are half a millimetre; the one in row 16, column 48 is 8.25 mm right and 7.75 up.
    assert orientation(values)[16, 48] == pytest.approx(np.rad2deg(np.arctan2(7.75, 8.25)))
    assert orientation(values)[16, 15] == pytest.approx(180 - np.rad2deg(np.arctan2(7.75, 8.25)))
    y, x = np.mgrid[:64, :64] / 2 - 15.75
    radius = np.hypot(x, y)
    assert np.array_equal(values[..., 3] == 1, (radius >= 6) & (radius <= 14))
    assert np.all(values[..., 2] == 1 / 1.5)


@pytest.mark.parametrize(("inner", "outer"), [(6, 5), (6, 17), (16, None)])
def test_discs_that_have_no_tracks(inner: float, outer: float | None) -> None:
    with pytest.raises(ValueError, match="up to half the tile, 16 mm"):
        DiscFoilRecipe(kind="foil", design="disc", tile_mm=32, inner_mm=inner, outer_mm=outer)
