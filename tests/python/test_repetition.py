"""The tile of a repeating pattern, from pictures that light little of it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import KDTree

from precompute.acquisition.agreement import Look, agreements, lit_points
from precompute.acquisition.repetition import find_tile
from precompute.errors import InputError

PITCH = 0.4
EXTENT = (120.0, 90.0)
SCALE = 0.007
"""(u, v) over mm from the mirror image, of a lamp at 200 mm and a camera at 500 mm."""

Size = tuple[float, float]


def looks(
    seed: int,
    tile: Size,
    extent: Size = EXTENT,
    count: int = 2,
    jitter: float = 0.0,
    noise: float = 0.0,
    middles: np.ndarray | None = None,
    shuffled: bool = False,
    spread: float = np.pi,
) -> list[Look]:
    """Photographs of a pattern of polygons with dark seams, some 3 mm wide each.

    A polygon is lit where the direction to the lamp's mirror image is its own, within a lobe that
    is as wide everywhere, as a grating's is in (u, v).

    Args:
        seed: Of polygons, their directions, mirror images and noise.
        tile: Width and height of what repeats, mm; with the extent itself nothing does.
        extent: Of the pictures, mm.
        count: Of pictures.
        jitter: Distance by which each tile is off its place, mm.
        noise: Standard deviation; what is lit is as bright as 1.
        middles: Of the polygons, in tiles; scattered if left out.
        shuffled: Whether each tile deals the directions out among its polygons in its own way.
        spread: Range of directions.
    """
    rng = np.random.default_rng(seed)
    size = np.array(tile)
    x, y = np.meshgrid(*(np.arange(PITCH / 2, length, PITCH) for length in extent))
    points = np.stack([x.ravel(), y.ravel()], axis=1)
    turn = rng.uniform(0, 2 * np.pi, np.ceil(np.array(extent) / size).astype(int))
    index = np.floor(points / size).astype(int)
    shift = jitter * np.stack([np.cos(turn), np.sin(turn)], axis=-1)[*index.T]
    if middles is None:
        middles = rng.random((int(size.prod() / 9), 2))
    around = np.stack(np.meshgrid([-1, 0, 1], [-1, 0, 1]), axis=-1).reshape(9, 1, 2)
    tree = KDTree(((middles + around) * size).reshape(-1, 2))
    distances, nearest = map(np.asarray, tree.query(np.mod(points - shift, size), k=2))
    seam = distances[:, 1] - distances[:, 0] < 0.4
    directions = np.tile(rng.uniform(0, spread, len(middles)), (*turn.shape, 1))
    if shuffled:
        directions = rng.permuted(directions, axis=-1)
    direction = directions[*index.T, nearest[:, 0] % len(middles)]
    found = []
    for _ in range(count):
        away = points - rng.uniform(0.3, 0.7, 2) * extent
        distance = np.linalg.norm(away, axis=1)
        off = np.angle(np.exp(2j * (np.arctan2(away[:, 1], away[:, 0]) - direction))) / 2
        shine = np.where(seam | (distance < 12), 0, np.exp(-((off * distance / 3) ** 2) / 2))
        values = 0.002 + shine + 20 * np.exp(-(distance**2) / 18)
        values += noise * rng.standard_normal(len(values))
        u, v = (SCALE * away.T).reshape(2, *x.shape)
        usable = (distance > 12).reshape(x.shape)
        found.append(Look(lit_points(values.reshape(x.shape)), usable, u, v))
    return found


def rows_of_shapes(columns: int, rows: int) -> np.ndarray:
    x, y = np.meshgrid((np.arange(columns) + 0.5) / columns, (np.arange(rows) + 0.5) / rows)
    return np.stack([x.ravel(), y.ravel()], axis=1)


@pytest.mark.parametrize(
    ("tile", "count"), [((20.0, 15.0), 1), ((17.3, 22.1), 2), ((20.0, 25.0), 1)]
)
def test_the_tile_is_found_to_a_tenth_of_a_pixel(tile: Size, count: int) -> None:
    assert find_tile(looks(1, tile, count=count), PITCH) == pytest.approx(tile, abs=0.04)


@pytest.mark.parametrize("count", [1, 3])
def test_noise_and_tiles_off_their_places_leave_it_to_be_found(count: int) -> None:
    shaken = looks(2, (20.0, 15.0), count=count, jitter=0.4, noise=0.1)
    assert find_tile(shaken, PITCH) == pytest.approx((20.0, 15.0), abs=0.15)


@pytest.mark.parametrize("extent", [(75.0, 60.0), (75.0, 40.0)])
def test_few_tiles_are_enough(extent: Size) -> None:
    few = looks(3, (25.0, 20.0), extent, count=3)
    assert find_tile(few, PITCH) == pytest.approx((25.0, 20.0), abs=0.15)


def test_like_shapes_in_rows_have_the_tile_of_their_gratings() -> None:
    """20 squares of 5 mm, one beside the other: shapes repeat each 5 mm, gratings do not."""
    rows = looks(4, (25.0, 20.0), count=1, middles=rows_of_shapes(5, 4))
    assert find_tile(rows, PITCH) == pytest.approx((25.0, 20.0), abs=0.04)


def test_parts_that_repeat_twice_in_a_tile_are_not_the_tile() -> None:
    """A few polygons come again half a tile further, the others do not."""
    rng = np.random.default_rng(4)
    some, others = rng.random((4, 2)) * [0.5, 1], rng.random((44, 2))
    again = some + np.array([0.5, 0])
    near = np.asarray(KDTree(np.concatenate([some, again])).query(others)[0])
    middles = np.concatenate([some, again, others[near > 0.05]])
    found = find_tile(looks(4, (24.0, 20.0), count=3, middles=middles), PITCH)
    assert found == pytest.approx((24.0, 20.0), abs=0.04)


@pytest.mark.parametrize("count", [1, 3])
@pytest.mark.parametrize("seed", range(2))
def test_polygons_that_do_not_repeat_are_refused(seed: int, count: int) -> None:
    with pytest.raises(InputError, match="a pattern that repeats") as caught:
        find_tile(looks(10 + seed, EXTENT, EXTENT, count), PITCH)
    assert caught.value.field == "sample.tile_mm"


@pytest.mark.parametrize("count", [1, 3])
def test_shapes_that_repeat_without_their_gratings_are_refused(count: int) -> None:
    with pytest.raises(InputError, match="a pattern that repeats"):
        find_tile(looks(20, (20.0, 15.0), count=count, shuffled=True), PITCH)


def test_one_direction_that_does_not_repeat_is_refused() -> None:
    with pytest.raises(InputError, match="a pattern that repeats"):
        find_tile(looks(20, (20.0, 90.0), count=3), PITCH)


def test_a_sheet_of_one_grating_is_refused() -> None:
    brushed = looks(21, EXTENT, middles=np.array([[0.5, 0.5]]))
    with pytest.raises(InputError, match="a pattern that repeats"):
        find_tile(brushed, PITCH)


@pytest.mark.parametrize("spread", [0.3, 1.0])
def test_directions_that_are_commoner_than_others_do_not_make_a_tile(spread: float) -> None:
    with pytest.raises(InputError, match="a pattern that repeats"):
        find_tile(looks(23, EXTENT, EXTENT, spread=spread), PITCH)


def test_a_tile_with_some_directions_only_is_found() -> None:
    found = find_tile(looks(24, (20.0, 15.0), spread=1.0), PITCH)
    assert found == pytest.approx((20.0, 15.0), abs=0.06)


def test_directions_that_change_slowly_over_the_sheet_are_refused() -> None:
    """Lit is where the direction to the mirror image is one that turns by 180° along x."""
    found = []
    for look in looks(22, EXTENT, count=2):
        turn = np.linspace(0, np.pi, look.u.shape[1])
        off = np.angle(np.exp(2j * (np.arctan2(look.v, look.u) - turn))) / 2
        found.append(Look(np.abs(off) < 0.1, look.usable, look.u, look.v))
    with pytest.raises(InputError, match="a pattern that repeats"):
        find_tile(found, PITCH)


def test_pictures_without_anything_lit_are_refused() -> None:
    dark = [Look(np.zeros_like(look.lit), look.usable, look.u, look.v) for look in looks(1, EXTENT)]
    with pytest.raises(InputError, match="lit points that are alike all over, or none"):
        find_tile(dark, PITCH)


def test_pairs_agree_where_one_grating_would_light_both() -> None:
    """Four points on a cross about the mirror image, each the brightest of none other.

    Left and right have the same direction, above and below too; at a turn of 90° one of each.
    """
    y, x = np.mgrid[-10:11, -10:11]
    lit = ((np.abs(x) == 6) & (y == 0)) | ((np.abs(y) == 6) & (x == 0))
    look = Look(lit, np.hypot(x, y) > 2, SCALE * x, SCALE * y)
    same, across = agreements([look], [0, 18])
    down, right = same.reach
    assert same.seen[down, right] == pytest.approx(4, abs=1e-4)  # each with itself
    for step in (-12, 12):
        assert same.seen[down, right + step] == pytest.approx(1, abs=1e-4)
        assert same.seen[down + step, right] == pytest.approx(1, abs=1e-4)
    assert same.seen.sum() == pytest.approx(8, abs=1e-3)
    assert across.seen.sum() == pytest.approx(8, abs=1e-3)
    assert across.seen[down + 6, right + 6] == pytest.approx(2, abs=1e-4)
