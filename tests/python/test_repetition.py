"""The tile of a repeating pattern, from pictures that light little of it, and a marked one."""

import numpy as np
import pytest
from scipy.spatial import KDTree

from precompute.acquisition.capture import Camera, Corners
from precompute.acquisition.rectification import Rectification
from precompute.acquisition.repetition import find_tile, reference_tiling
from precompute.acquisition.view import View
from precompute.errors import InputError

PITCH = 0.3


def pictures(seed, tile, extent=(120.0, 90.0), count=2, jitter=0.0, noise=0.0, middles=None):
    """Pictures of a pattern of polygons with dark seams, some 3 mm wide each.

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
    direction = rng.uniform(0, np.pi, len(middles))[nearest[:, 0] % len(middles)]
    found = []
    for _ in range(count):
        away = points - rng.uniform(0.3, 0.7, 2) * extent
        distance = np.linalg.norm(away, axis=1)
        off = np.angle(np.exp(2j * (np.arctan2(away[:, 1], away[:, 0]) - direction))) / 2
        shine = np.where(seam | (distance < 12), 0, np.exp(-((off * distance / 3) ** 2) / 2))
        values = 0.002 + shine + 20 * np.exp(-(distance**2) / 18)
        found.append((values + noise * rng.standard_normal(len(values))).reshape(x.shape))
    return found


@pytest.mark.parametrize("tile", [(20.0, 15.0), (17.3, 22.1), (24.0, 30.0)])
def test_the_tile_is_found_to_a_tenth_of_a_pixel(tile):
    for count in (1, 2):
        found = find_tile(pictures(1, tile, count=count), PITCH)
        assert found == pytest.approx(tile, abs=0.03)


def test_noise_and_tiles_off_their_places_leave_it_to_be_found():
    shaken = pictures(2, (20.0, 15.0), count=3, jitter=0.4, noise=0.02)
    assert find_tile(shaken, PITCH) == pytest.approx((20.0, 15.0), abs=0.15)


def test_three_by_three_tiles_are_enough():
    few = pictures(3, (25.0, 20.0), extent=(75.0, 60.0), count=3)
    assert find_tile(few, PITCH) == pytest.approx((25.0, 20.0), abs=0.03)


def test_parts_that_repeat_twice_in_a_tile_are_not_the_tile():
    """A few polygons come again half a tile further, the others do not."""
    rng = np.random.default_rng(4)
    some, others = rng.random((4, 2)) * [0.5, 1], rng.random((44, 2))
    again = some + np.array([0.5, 0])
    near = np.asarray(KDTree(np.concatenate([some, again])).query(others)[0])
    middles = np.concatenate([some, again, others[near > 0.05]])
    found = find_tile(pictures(4, (24.0, 20.0), count=3, middles=middles), PITCH)
    assert found == pytest.approx((24.0, 20.0), abs=0.03)


@pytest.mark.parametrize("count", [1, 3])
@pytest.mark.parametrize("seed", range(4))
def test_polygons_that_do_not_repeat_are_refused(seed, count):
    extent = (100.0, 80.0)
    with pytest.raises(InputError, match="a pattern that repeats") as caught:
        find_tile(pictures(10 + seed, extent, extent, count), PITCH)
    assert caught.value.field == "sample.tile_mm"


def test_one_direction_that_does_not_repeat_is_refused():
    with pytest.raises(InputError, match="a pattern that repeats"):
        find_tile(pictures(20, (20.0, 90.0), count=3), PITCH)


def test_like_shapes_in_rows_are_no_tile():
    x, y = np.meshgrid((np.arange(5) + 0.5) / 5, (np.arange(4) + 0.5) / 4)
    rows = np.stack([x.ravel(), y.ravel()], axis=1)
    with pytest.raises(InputError, match="a pattern that repeats"):
        find_tile(pictures(21, (25.0, 20.0), count=2, middles=rows), PITCH)


def test_pictures_without_anything_lit_are_refused():
    with pytest.raises(InputError, match="0 lit shapes"):
        find_tile([np.full((200, 300), 0.1)], PITCH)


CAMERA = Camera(
    position_mm=(120.0, -80.0, 500.0), focal_px=900.0, distortion=(-0.1, 0.0, 0.0, 0.0, 0.0)
)
VIEW = View.of(CAMERA, (800, 600))
RECTIFICATION = Rectification.of_view(VIEW)


def marked(corners) -> Corners:
    seen = VIEW.pixels(np.array([(x, y, 0.0) for x, y in corners]))
    a, b, c, d = ((float(x), float(y)) for x, y in seen)
    return a, b, c, d


def rectangle(turn=0.0, skew=0.0, taper=1.0):
    """25 by 20 mm, its top left corner at (−40, 30) but for a turn about it, degrees."""
    right, below = 25.0, -20.0
    corners = np.array([(0, 0), (right, 0), (right + skew, below * taper), (skew, below)])
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    return corners @ np.array([[c, s], [-s, c]]) + [-40, 30]


def test_a_marked_tile_gives_its_size_and_corner():
    size, corner = reference_tiling(marked(rectangle()), RECTIFICATION, "capture.json")
    assert size == pytest.approx((25.0, 20.0), abs=1e-3)
    assert corner == pytest.approx((-40.0, 30.0), abs=1e-3)


@pytest.mark.parametrize(
    ("corners", "found"),
    [
        (rectangle(taper=1.08), "opposite sides that differ"),
        (rectangle(turn=5), "turned by 5 degrees"),
        (rectangle(skew=3), "angles that are off"),
        (np.roll(rectangle(), 1, axis=0), "turned by 90 degrees"),
        (rectangle()[::-1], "turned|angles"),
    ],
)
def test_a_marked_tile_that_is_no_upright_rectangle_is_refused(corners, found):
    with pytest.raises(InputError, match=found) as caught:
        reference_tiling(marked(corners), RECTIFICATION, "capture.json")
    assert caught.value.file == "capture.json"
    assert caught.value.field == "sample.reference_tile_px"


def test_small_errors_of_a_hand_that_marks_are_taken():
    size, corner = reference_tiling(marked(rectangle(turn=1.5)), RECTIFICATION, "capture.json")
    assert size == pytest.approx((25.0, 20.0), rel=0.01)
    assert corner == pytest.approx((-40.0, 30.0), abs=0.7)
