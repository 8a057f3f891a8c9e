"""Where a capture's tiles are, by what it says and which of its photographs can be used."""

from __future__ import annotations

import numpy as np
import pytest

from precompute.acquisition.capture import Camera, Capture
from precompute.acquisition.layout import tiling_of
from precompute.acquisition.observations import Shot
from precompute.acquisition.rectification import Rectification
from precompute.acquisition.shots import Taken
from precompute.acquisition.view import View
from precompute.errors import InputError

WIDTH, HEIGHT = 400, 300
CORNER = np.array([-20.0, 10.0])
TILE = (30.0, 20.0)


def rectification(x: float) -> Rectification:
    """Of a camera so far to the right, looking at the sample's middle."""
    camera = Camera(position_mm=(x, 0.0, 400.0), focal_px=900.0)
    return Rectification.of_view(View.of(camera, (WIDTH, HEIGHT)))


def shot(at: Rectification) -> Shot:
    values = np.zeros((HEIGHT, WIDTH, 3), np.float32)
    usable = np.ones((HEIGHT, WIDTH), bool)
    light, spectrum = np.array([0.0, 0.0, 200.0]), np.ones((401, 3))
    return Shot("second.tif", values, usable, at, light, 0.01, spectrum, np.zeros(3, np.float32))


def test_the_reference_is_marked_in_the_first_photograph_even_if_it_is_left_out() -> None:
    first, second = rectification(-60), rectification(60)
    right, below = TILE
    corners = CORNER + np.array([(0, 0), (right, 0), (right, -below), (0, -below)])
    marked = first.pixels(corners).tolist()
    light = {"position_mm": [0, 0, 200], "radius_deg": 0.7, "spectrum": "inverse-A"}
    capture = Capture.model_validate(
        {
            "format": "capture",
            "version": 1,
            "method": "flash",
            "sample": {"size_mm": [150, 100], "reference_tile_px": marked},
            "photographs": [
                {"file": file, "exposure_s": 1, "light": light}
                for file in ("first.tif", "second.tif")
            ],
        }
    )
    why = InputError("first.tif", "highlight", "none", "one")
    taken = Taken([shot(second)], [], {"first.tif": why}, [first, second])
    tiling, (row, column) = tiling_of(capture, taken, "capture.json", pytest.fail)
    assert tiling.size == pytest.approx(TILE, abs=0.01)
    found = tiling.corner + [column, -row] * tiling.size
    assert found == pytest.approx(CORNER, abs=0.01)
