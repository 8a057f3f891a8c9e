"""Whether what is lit are gratings: lobes explain any picture in part, by chance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from precompute.acquisition.calibration import Calibration
from precompute.acquisition.lobe_fit import fit_strip
from precompute.acquisition.observations import Strip, observed, strips
from precompute.acquisition.tiling import Tiling

Array = NDArray[np.float64]

SOME = 200_000
"""Observations that are compared."""


def over_chance(calibration: Calibration, tiling: Tiling, places: Array) -> float:
    """How many times as much gratings explain as where each texel's observations change places.

    What one photograph shows of a texel is dealt out at random among the tiles in which it was
    seen: a grating then has no place where it should be lit, and its neighbours none where it
    should be dark. Of anything else that repeats in no tile one order is as good as another.

    Args:
        calibration: The photographs, and what gratings show in them.
        tiling: Where the tiles are.
        places: Texels of the pattern, in tiles, shape (n, 2).
    """
    count = len(tiling.tiles()) * len(calibration.shots)
    some = places[:: max(1, len(places) * count // SOME)]
    rng = np.random.default_rng(1)
    gain = chance = 0.0
    for part in strips(len(some), count):
        strip = observed(calibration.shots, tiling, some[part], calibration.highlight)
        gain += float(fit_strip(strip, calibration.model).gain.sum())
        chance += float(fit_strip(dealt(strip, rng), calibration.model).gain.sum())
    return gain / max(chance, 1e-30)


def dealt(strip: Strip, rng: np.random.Generator) -> Strip:
    """A strip in which each texel's usable observations in one photograph changed places."""
    group = 2 * strip.shot + ~strip.usable  # what changes places, shape (n, J)
    places = np.argsort(group, axis=1, kind="stable")
    taken = np.argsort(group + rng.random(group.shape), axis=1)
    intensity = np.empty_like(strip.intensity)
    rows = np.arange(len(intensity))[:, None]
    intensity[rows, places] = strip.intensity[rows, taken]
    return replace(strip, intensity=intensity)
