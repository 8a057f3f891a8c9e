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
Indices = NDArray[np.intp]

SOME = 200_000
"""Observations that are compared."""

DEALS = 8
"""How often tiles change places: what is lit in blotches of many texels is explained well by chance
now and then."""


def over_chance(calibration: Calibration, tiling: Tiling, places: Array) -> float:
    """How many times as much gratings explain as where tiles change places, at the best.

    What photographs show of the tiles is dealt out among their places at random: a grating then has
    no place where it should be lit, and its neighbours none where it should be dark. Of anything
    else that repeats in no tile one order is as good as another.

    Args:
        calibration: The photographs, and what gratings show in them.
        tiling: Where the tiles are.
        places: Texels of the pattern, in tiles, shape (n, 2).
    """
    count = len(tiling.tiles()) * len(calibration.shots)
    some = places[:: max(1, len(places) * count // SOME)]
    rng = np.random.default_rng(1)
    look = [
        observed(calibration.shots, tiling, some[part], calibration.highlight)
        for part in strips(len(some), count)
    ]

    def explained(order: Indices) -> float:
        fits = (fit_strip(dealt(strip, order), calibration.model) for strip in look)
        return float(sum(fit.gain.sum() for fit in fits))

    shot = look[0].shot
    # By photographs first, so that each is dealt out among its own places.
    chance = max(explained(np.lexsort([rng.random(count), shot])) for _ in range(DEALS))
    return explained(np.arange(count)) / max(chance, 1e-30)


def dealt(strip: Strip, order: Indices) -> Strip:
    """A strip whose column j has the place of column j and shows what another, order[j], did.

    Usable is what was so in both: in the highlight all gratings would be lit.
    """
    return replace(
        strip,
        intensity=strip.intensity[:, order],
        usable=strip.usable & strip.usable[:, order],
    )
