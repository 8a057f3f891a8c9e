"""What chance explains of a picture."""

from __future__ import annotations

import numpy as np

from precompute.acquisition.chance import dealt
from precompute.acquisition.observations import Strip


def test_tiles_change_places_with_all_that_they_show() -> None:
    rng = np.random.default_rng(1)
    n, shot = 30, np.repeat([0, 1], [20, 12])
    intensity = rng.random((n, 32, 3)).astype(np.float32)
    usable = rng.random((n, 32)) < 0.7
    where = rng.random((n, 32)).astype(np.float32)
    strip = Strip(intensity, where, where + 1, usable, shot)
    order = rng.permutation(32)
    after = dealt(strip, order)
    assert after.u is strip.u and after.v is strip.v and after.shot is strip.shot
    for column, other in enumerate(order):
        assert np.array_equal(after.intensity[:, column], intensity[:, other])
        assert np.array_equal(after.usable[:, column], usable[:, column] & usable[:, other])
