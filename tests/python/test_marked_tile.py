"""The tile that is marked in a photograph, as its corners on the sample."""

from __future__ import annotations

import numpy as np
import pytest

from precompute.acquisition.capture import Camera, Corners
from precompute.acquisition.marked_tile import reference_tiling
from precompute.acquisition.rectification import Rectification
from precompute.acquisition.view import View
from precompute.errors import InputError

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
