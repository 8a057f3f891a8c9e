"""Foils of figures, from geometry: areas, distances, copies, tiles that repeat, what is refused."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pydantic import TypeAdapter
from refusals import refused
from scipy.ndimage import label

from precompute.foils.distances import bounding_disc, signed_distance
from precompute.foils.figure_recipes import Figure
from precompute.foils.figures import figures_foil
from precompute.foils.recipe import FiguresFoilRecipe
from precompute.recipes import read_recipe

Array = NDArray[np.float64]
ROOT = Path(__file__).parents[2]
TILE = 24.0
DISC = {"kind": "disc", "radius_mm": 4.0}
STAR = {"kind": "star", "points": 5, "radius_mm": 5.0, "notch": 0.4}
CONCAVE = [[0, 0], [6, 0], [6, 2], [2, 2], [2, 5], [0, 5]]
FIGURES = {
    "disc": DISC,
    "ring": {"kind": "disc", "radius_mm": 4.0, "inner_mm": 2.5},
    "rectangle": {"kind": "rectangle", "width_mm": 7.0, "height_mm": 3.0},
    "polygon": {"kind": "polygon", "corners_mm": CONCAVE},
    "clockwise": {"kind": "polygon", "corners_mm": CONCAVE[::-1]},
    "star": STAR,
    "stroke": {"kind": "stroke", "from_mm": 1.0, "to_mm": 6.0, "width_mm": [3.0, 0.8]},
    "even stroke": {"kind": "stroke", "to_mm": 5.0, "width_mm": [1.0, 1.0]},
    "flower": {"kind": "rosette", "radius_mm": 4.0, "amplitude_mm": 1.0, "lobes": 6},
    "line": {
        "kind": "rosette", "radius_mm": 4.0, "amplitude_mm": 0.5, "lobes": 5, "width_mm": 0.4
    },
}  # fmt: skip


def figure_of(contents: dict[str, Any]) -> Any:
    return TypeAdapter[Figure](Figure).validate_python(contents)


def grating(*figures: dict[str, Any], size: int = 240, seed: int = 1) -> Array:
    recipe = {"kind": "foil", "design": "figures", "size": size, "tile_mm": TILE, "seed": seed}
    made = figures_foil(FiguresFoilRecipe.model_validate(recipe | {"figures": figures}))
    return made.tables["grating"].values


def places(size: int = 240) -> tuple[Array, Array]:
    """x and y of texels, mm from the middle of the tile, the first row being the top."""
    x = TILE * ((np.arange(size) + 0.5) / size - 0.5)
    return np.broadcast_to(x, (size, size)), np.broadcast_to(x[::-1, None], (size, size))


def degrees(values: Array) -> Array:
    return np.rad2deg(np.arctan2(values[..., 1], values[..., 0]) / 2)


def turned(found: Array, expected: Array | float) -> Array:
    """How far orientations are from others, deg, modulo a half turn."""
    return np.abs((found - expected + 90) % 180 - 90)


def parted(lit: NDArray[np.bool_]) -> tuple[NDArray[np.intp], int]:
    """The connected part of each texel, corners too connecting, from 1, and how many there are."""
    found: Any = label(lit, np.ones((3, 3)))
    return found


def at(*points: dict[str, float]) -> dict[str, Any]:
    return {"kind": "points", "points": list(points)}


def rosette_length() -> float:
    φ = np.linspace(0, 2 * np.pi, 100_001)
    r = 4 + 0.5 * np.cos(5 * φ)
    return float(np.hypot(np.diff(r * np.cos(φ)), np.diff(r * np.sin(φ))).sum())


def hull_of_discs(first: float, last: float, apart: float) -> float:
    """Two sectors, and on either side of the line between them a trapezium."""
    lean = np.arcsin((first - last) / apart)
    sectors = first**2 * (np.pi / 2 + lean) + last**2 * (np.pi / 2 - lean)
    return float(sectors + (first + last) * apart * np.cos(lean))


AREAS = {
    "disc": np.pi * 16,
    "ring": np.pi * (16 - 2.5**2),
    "rectangle": 21.0,
    "polygon": 12.0 + 6.0,
    "clockwise": 12.0 + 6.0,
    "star": 5 * 25 * 0.4 * np.sin(np.pi / 5),
    "stroke": hull_of_discs(1.5, 0.4, 5.0),
    "even stroke": 5.0 + np.pi / 4,
    "flower": np.pi * (16 + 0.5),
    "line": 0.4 * rosette_length(),
}


@pytest.mark.parametrize("name", FIGURES)
def test_areas_are_those_of_geometry(name: str) -> None:
    """Turned, scaled, and over the tile's corner, where what leaves comes in again."""
    place = {"x_mm": 11.0, "y_mm": -10.0, "turn_deg": 33.0, "scale": 1.3}
    strength = grating(FIGURES[name] | {"at": at(place)})[..., 3]
    assert strength.mean() * TILE**2 == pytest.approx(1.3**2 * AREAS[name], rel=0.004)


@pytest.mark.parametrize("name", [n for n in FIGURES if FIGURES[n]["kind"] != "rosette"])
def test_distances_are_those_from_the_edge(name: str) -> None:
    """Against the nearest of many points on the edge; inside is what the edge winds around."""
    figure = FIGURES[name]
    x, y = np.random.default_rng(2).uniform(-7, 7, (2, 200))
    if figure["kind"] == "disc":
        r, inner = np.hypot(x, y), figure.get("inner_mm", 0.0)
        edges = [abs(r - 4)] + ([abs(r - inner)] if inner else [])
        distance, inside = np.min(edges, axis=0), (r < 4) & (r >= inner)
        expected = np.where(inside, -distance, distance)
    elif figure["kind"] == "stroke":  # the hull of two discs holds all discs between them
        (first, last), start = np.array(figure["width_mm"]) / 2, figure.get("from_mm", 0.0)
        t = np.linspace(0, 1, 4001)[:, None]
        middle = start + t * (figure["to_mm"] - start)
        expected = (np.hypot(x - middle, y) - first - t * (last - first)).min(axis=0)
    else:
        corners = {
            "rectangle": np.array([[3.5, 1.5], [-3.5, 1.5], [-3.5, -1.5], [3.5, -1.5]]),
            "polygon": np.array(figure.get("corners_mm")),
            "star": np.stack(
                [
                    np.tile([5, 2.0], 5) * np.cos(np.pi / 5 * np.arange(10)),
                    np.tile([5, 2.0], 5) * np.sin(np.pi / 5 * np.arange(10)),
                ],
                axis=-1,
            ),
        }[figure["kind"]]
        share = np.linspace(0, 1, 1001)[:-1, None, None]
        edge = (corners + share * (np.roll(corners, -1, axis=0) - corners)).swapaxes(0, 1)
        apart = edge.reshape(-1, 2)[:, 0] + 1j * edge.reshape(-1, 2)[:, 1] - (x + 1j * y)[:, None]
        winds = np.angle(np.roll(apart, -1, axis=1) / apart).sum(axis=1)
        expected = np.where(abs(winds) > np.pi, -1, 1) * abs(apart).min(axis=1)
    assert signed_distance(figure_of(figure), x, y) == pytest.approx(expected, abs=4e-3)


@pytest.mark.parametrize("name", FIGURES)
def test_all_of_a_figure_lies_in_its_bounding_disc(name: str) -> None:
    figure = figure_of(FIGURES[name])
    x, y, radius = bounding_disc(figure)
    across, up = np.meshgrid(*2 * [np.linspace(-8, 8, 321)])
    inside = signed_distance(figure, across, up) < 0
    assert np.hypot(across - x, up - y)[inside].max() <= radius


def test_places_are_to_the_right_and_up() -> None:
    """A disc in the upper right quarter, in a group that is turned by a quarter into the left."""
    x, y = places()
    small = DISC | {"radius_mm": 1.0, "at": at({"x_mm": 8.0, "y_mm": 5.0})}
    assert np.array_equal(grating(small)[..., 3] >= 0.5, np.hypot(x - 8, y - 5) <= 1)
    group = {"kind": "group", "figures": [small], "at": at({"turn_deg": 90.0, "scale": 0.5})}
    assert np.array_equal(grating(group)[..., 3] >= 0.5, np.hypot(x + 2.5, y - 4) <= 0.5)


def test_what_leaves_a_tile_comes_in_again() -> None:
    """Moved by half a tile, a design is the same tile seen from another place."""
    star = STAR | {"orientation": {"kind": "ramp", "to_mm": 5.0, "values": [0, 90]}}
    band = {"kind": "rectangle", "width_mm": 24.0, "height_mm": 2.0, "orientation": 45}
    group = {"kind": "group", "figures": [star, band]}
    here = grating(group | {"at": at({"x_mm": 1.0, "y_mm": 2.0})})
    there = grating(group | {"at": at({"x_mm": 13.0, "y_mm": -10.0})})
    here = np.roll(here, (120, 120), axis=(0, 1))
    assert there[..., 3] == pytest.approx(here[..., 3], abs=1e-9)
    lit = here[..., 3] > 1e-9  # an edge that texels touch may cover 1e-16 of them
    assert np.abs(there - here)[lit].max() < 1e-9


def test_copies_in_a_ring_are_rotations_of_one_another() -> None:
    """Four of them: a quarter turn of the map is the map, its orientations 90° on."""
    stroke = FIGURES["stroke"] | {"orientation": 20, "period": 1.2}
    ring = {"kind": "ring", "count": 4, "radius_mm": 2.0, "start_deg": 10.0}
    values = grating(stroke | {"at": ring})
    quarter = np.rot90(values)
    assert quarter[..., 2:] == pytest.approx(values[..., 2:], abs=1e-9)
    lit = values[..., 3] > 0
    assert turned(degrees(quarter)[lit] + 90, degrees(values)[lit]).max() < 1e-6
    x, y = places()
    first = lit & (np.abs(np.arctan2(y, x) - np.deg2rad(10)) < 0.1) & (np.hypot(x, y) > 4)
    assert degrees(values)[first] == pytest.approx(30)


def test_a_row_has_equal_steps_about_its_middle() -> None:
    x, y = places()
    dot = DISC | {"radius_mm": 0.5, "at": {"kind": "row", "count": 4, "step_mm": [3.0, -2.0]}}
    middles = [(-4.5, 3), (-1.5, 1), (1.5, -1), (4.5, -3)]
    expected = np.min([np.hypot(x - a, y - b) for a, b in middles], axis=0) <= 0.5
    assert np.array_equal(grating(dot)[..., 3] >= 0.5, expected)


@pytest.mark.parametrize("kind", ["ring", "strewn"])
def test_scales_of_copies_share_out_their_range(kind: str) -> None:
    """Discs that keep clear of one another: their areas add up, on the repeating tile too."""
    scales = np.linspace(0.25, 0.75, 9)
    where = {"ring": {"radius_mm": 9.0}, "strewn": {"radius_mm": 4.0}}[kind]
    values = grating(DISC | {"at": {"kind": kind, "count": 9, "scale": [0.25, 0.75], **where}})
    area = np.pi * 16 * np.sum(scales**2)
    assert values[..., 3].mean() * TILE**2 == pytest.approx(area, rel=0.004)
    parts, count = parted(np.tile(values[..., 3], (2, 2)) > 0)
    assert count >= 9
    areas = np.bincount(parts.ravel())[1:] * 0.1**2
    for scale in scales:
        assert np.abs(areas / (np.pi * 16 * scale**2) - 1).min() < 0.2


def test_seeds_strew_and_shuffle() -> None:
    dots = DISC | {"at": {"kind": "strewn", "count": 5, "radius_mm": 4.0, "scale": [0.1, 0.5]}}
    assert np.array_equal(grating(dots), grating(dots))
    assert not np.array_equal(grating(dots), grating(dots, seed=2))


def test_orientations_and_periods_vary_as_stated() -> None:
    x, y = places()
    r = np.hypot(x, y)

    def shown(orientation: Any, period: Any = 1.5) -> tuple[Array, Array, NDArray[np.bool_]]:
        disc = {"kind": "disc", "radius_mm": 11.0, "orientation": orientation, "period": period}
        values = grating(disc)
        lit = values[..., 3] > 0
        return degrees(values), np.divide(1.0, values[..., 2], where=lit, out=np.ones_like(r)), lit

    ramp = {"kind": "ramp", "over": "x", "from_mm": -5.0, "to_mm": 5.0, "values": [10, 20, 80]}
    rings = {"kind": "bands", "width_mm": 0.7, "values": [1.2, 1.5, 2.0]}
    θ, period, lit = shown(ramp, rings)
    expected = np.where(x < 0, 20 + 2 * np.maximum(x, -5), 20 + 12 * np.minimum(x, 5))
    assert turned(θ, expected)[lit].max() < 1e-6
    assert period[lit] == pytest.approx(np.array([1.2, 1.5, 2.0])[(r[lit] // 0.7).astype(int) % 3])
    bands = {"kind": "bands", "over": "y", "width_mm": 2.0, "values": [0, 40, 80]}
    widens = {"kind": "ramp", "from_mm": 2.0, "to_mm": 10.0, "values": [1.0, 2.0]}
    θ, period, lit = shown(bands, widens)
    assert turned(θ, 40 * ((y // 2) % 3))[lit].max() < 1e-6
    assert period[lit] == pytest.approx(1 + np.clip((r[lit] - 2) / 8, 0, 1))
    around = {"kind": "around", "half_turns": -3, "start_deg": 15.0, "twist_deg": 7.0}
    θ, _, lit = shown(around)
    assert turned(θ, 15 - 1.5 * np.rad2deg(np.arctan2(y, x)) + 7 * r)[lit].max() < 1e-6


def test_what_lies_on_top_hides_what_lies_beneath() -> None:
    x, y = places()
    ground = {"kind": "rectangle", "width_mm": TILE, "height_mm": TILE, "orientation": 90}
    star = STAR | {"orientation": 30, "period": 1.2, "seam_mm": 0.5}
    hole = DISC | {"radius_mm": 1.0, "orientation": None}
    values = grating(ground, star, hole)
    assert grating(ground)[..., 3].min() == pytest.approx(1, abs=1e-9)
    distance = signed_distance(figure_of(STAR), x, y)
    # By the width of a texel beside each edge a texel may have a share of both.
    bare = ((distance > -0.45) & (distance < -0.05)) | (np.hypot(x, y) < 0.95)
    within = (distance < -0.55) & (np.hypot(x, y) > 1.05)
    assert np.all(values[bare][:, 3] == 0)
    for where, θ, period in ((within, 30, 1.2), (distance > 0.05, 90, 1.66)):
        assert values[where][:, 3].min() == pytest.approx(1, abs=1e-9)
        assert turned(degrees(values)[where], θ).max() < 1e-6
        assert values[where][:, 2] == pytest.approx(1 / period)


def test_texels_on_an_edge_have_the_grating_of_which_there_is_more() -> None:
    """Edges at ¼ of a texel's width: ¾ of it are the upper figure's, or ¼ is."""
    ground = {"kind": "rectangle", "width_mm": TILE, "height_mm": TILE, "orientation": 90}
    for width, strength, θ in ((10.15, 0.75, 30.0), (10.05, 0.75, 90.0)):
        upper = {"kind": "rectangle", "width_mm": width, "height_mm": 8.0, "orientation": 30}
        texel = grating(ground, upper)[120, 170]  # from 5 to 5.1 mm
        assert texel[3] == pytest.approx(strength)
        assert turned(degrees(texel), θ) == pytest.approx(0, abs=1e-6)
        alone = grating(upper)[120, 170]
        assert alone[3] == pytest.approx(0.75 if θ == 30 else 0.25)


# The designs that are shipped.


def shipped(name: str, size: int) -> tuple[Array, float]:
    """A design at a size, and its tile's side, mm."""
    recipe = read_recipe(ROOT / "maps" / "recipes" / f"foil-{name}.json")
    assert isinstance(recipe, FiguresFoilRecipe)
    made = figures_foil(recipe.model_copy(update={"size": size}))
    return made.tables["grating"].values, recipe.tile_mm


@pytest.mark.parametrize(
    ("x", "y", "radius", "turns"),
    [(0, 0, 9, 10), (0, 0, 5, 10), (0, 0, 10.35, -10), (12.5, 12.5, 4, 10)],
)
def test_kinematic_discs_turn_by_ten_times_pi(
    x: float, y: float, radius: float, turns: int
) -> None:
    """Once around the middle, and around the corner, which lies on four tiles."""
    values, tile = shipped("kinematic-discs", 512)
    φ = np.linspace(0, 2 * np.pi, 4001)
    column = np.floor(((x + radius * np.cos(φ)) / tile + 0.5) * 512).astype(int) % 512
    row = np.floor((0.5 - (y + radius * np.sin(φ)) / tile) * 512).astype(int) % 512
    along = values[row, column]
    assert np.all(along[:, 3] == 1)
    θ = np.unwrap(np.arctan2(along[:, 1], along[:, 0])) / 2
    assert θ[-1] - θ[0] == pytest.approx(turns * np.pi, abs=1e-9)


@pytest.mark.parametrize("name", ["kinematic-discs", "gradient-stars", "fireworks"])
def test_shipped_tiles_repeat(name: str) -> None:
    """From the last line to the first, gratings change no more than between others; of lines that
    do not belong together all of what is lit changes."""
    values, _ = shipped(name, 512)

    def steps(part: Array) -> Array:
        here = part[..., 3] * (part[..., 0] + 1j * part[..., 1])
        following = np.roll(here, -1, axis=0)
        lit = np.maximum(np.abs(here), np.abs(following)).sum(axis=1)
        return np.abs(following - here).sum(axis=1) / lit

    for tile in (values, values.swapaxes(0, 1)):
        whole, cut = steps(tile), steps(tile[:340, :340])
        assert whole[-1] <= whole[:-1].max()
        assert cut[-1] > max(0.85, 1.2 * whole[-1])


@pytest.mark.parametrize("name", ["emblem", "logo"])
def test_what_does_not_repeat_has_a_bare_border(name: str) -> None:
    values, tile = shipped(name, 256)
    edge = round(0.5 / tile * 256)
    lit = values[..., 3] > 0
    assert lit[edge:-edge, edge:-edge].sum() == lit.sum() > 0.15 * lit.size


def test_each_polygon_of_the_logo_has_a_grating_of_its_own() -> None:
    values, _ = shipped("logo", 512)
    parts, count = parted(values[..., 3] > 0)
    assert count == 24 + 22 + 3
    for part in range(1, count + 1):
        assert np.ptp(turned(degrees(values)[parts == part], 45.0)) < 1e-6


def test_the_emblem_has_bands_above_and_rings_of_period() -> None:
    """Along a circle in its sky the period stays while orientations change with height alone."""
    values, tile = shipped("emblem", 640)
    x = tile * ((np.arange(640) + 0.5) / 640 - 0.5)
    radius, height = np.hypot(x, x[::-1, None]), np.broadcast_to(x[::-1, None], (640, 640))
    sky = (radius > 5.7) & (radius < 6.9) & (height > 1)
    θ, period = degrees(values), 1 / np.where(sky, values[..., 2], 1.0)
    found = []
    for band in range(2, 9):
        in_band = sky & (height > 0.7 * band) & (height < 0.7 * (band + 1))
        assert np.ptp(turned(θ[in_band], θ[in_band][0])) < 1e-6
        found.append(θ[in_band][0])
    assert turned(np.diff(found), 0.0).min() > 20
    assert period[sky] == pytest.approx(
        np.array([1.2, 1.4, 1.6, 1.8])[(radius[sky] // 0.2).astype(int) % 4]
    )


RAMP = {"kind": "ramp", "to_mm": 3.0, "values": [0, 90]}


@pytest.mark.parametrize(
    ("figures", "field", "value", "expected"),
    [
        ([], "figures", [], "at least 1"),
        ([DISC | {"colour": 1}], "figures.0.colour", 1, "no such field"),
        ([DISC | {"radius_mm": 0.0}], "figures.0.radius_mm", 0.0, "greater than 0"),
        ([DISC | {"kind": "heart"}], "figures.0.kind", "heart", "'disc'"),
        ([DISC | {"inner_mm": 4.0}], "figures.0.inner_mm", 4.0, "below radius_mm, 4"),
        ([DISC | {"period": -1.2}], "figures.0.period", -1.2, "greater than 0"),
        ([DISC | {"period": {"kind": "around"}}], "figures.0.period.kind", "around", "'ramp'"),
        ([DISC | {"orientation": "up"}], "figures.0.orientation", "up", ""),
        ([DISC | {"orientation": RAMP | {"by": 2}}], "figures.0.orientation.by", 2, "no such"),
        (
            [DISC | {"orientation": RAMP | {"from_mm": 3.0}}],
            "figures.0.orientation.to_mm", 3.0, "above from_mm, 3",
        ),
        (
            [DISC | {"orientation": RAMP | {"values": [0]}}],
            "figures.0.orientation.values", [0], "at least 2",
        ),
        (
            [DISC | {"orientation": {"kind": "around", "half_turns": 2.5}}],
            "figures.0.orientation.half_turns", 2.5, "integer",
        ),
        (
            [{"kind": "group", "figures": [DISC, STAR | {"points": 2}]}],
            "figures.0.figures.1.points", 2, "greater than or equal to 3",
        ),
        ([{"kind": "group", "figures": []}], "figures.0.figures", [], "at least 1"),
        (
            [{"kind": "polygon", "corners_mm": [[0, 0], [1, 1], [2, 2]]}],
            "figures.0.corners_mm", [[0, 0], [1, 1], [2, 2]], "not in one line",
        ),
        (
            [FIGURES["stroke"] | {"to_mm": 2.0}], "figures.0.to_mm", 2.0, "above 2.1",
        ),
        ([FIGURES["flower"] | {"amplitude_mm": 4.0}], "figures.0.amplitude_mm", 4.0, "below"),
        (
            [DISC | {"at": {"kind": "ring", "count": 3, "scale": [2.0, 1.0]}}],
            "figures.0.at.scale", [2.0, 1.0], "up to the largest",
        ),
        ([DISC | {"at": at({"x": 3.0})}], "figures.0.at.points.0.x", 3.0, "no such field"),
    ],
)  # fmt: skip
def test_what_is_no_figure_is_refused(
    tmp_path: Path, figures: list[Any], field: str, value: object, expected: str
) -> None:
    file = tmp_path / "foil-drawn.json"
    file.write_text(json.dumps({"kind": "foil", "design": "figures", "figures": figures}))
    with refused(file, field, value, expected):
        read_recipe(file)


def test_a_tile_on_which_nothing_diffracts_is_refused() -> None:
    with refused("foil map", "strength", 0.0, "above 0 somewhere"):
        grating(DISC, DISC | {"radius_mm": 5.0, "orientation": None})
