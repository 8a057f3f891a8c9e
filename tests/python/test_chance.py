"""What chance explains of a picture."""

from __future__ import annotations

import numpy as np

from precompute.acquisition.chance import dealt
from precompute.acquisition.observations import Strip


def test_observations_change_places_within_a_photograph() -> None:
    """Each texel's usable ones among themselves, each photograph's among its own, all kept."""
    rng = np.random.default_rng(1)
    n, shot = 30, np.repeat([0, 1], [20, 12])
    intensity = rng.random((n, 32, 3)).astype(np.float32)
    usable = rng.random((n, 32)) < 0.7
    where = rng.random((n, 32)).astype(np.float32)
    strip = Strip(intensity, where, where + 1, usable, shot)
    after = dealt(strip, np.random.default_rng(2))
    assert after.u is strip.u and after.v is strip.v and after.usable is strip.usable
    moved = 0
    for row in range(n):
        for number in (0, 1):
            for kind in (usable[row], ~usable[row]):
                group = kind & (shot == number)
                before, now = intensity[row, group], after.intensity[row, group]
                assert sorted(map(tuple, before)) == sorted(map(tuple, now))
                moved += int(np.any(before != now, axis=1).sum())
    assert moved > 0.8 * n * 32
