"""What has to be known of photographs before gratings are fitted, estimated from them.

How bright a lobe is, how wide surface and lamp make it, which periods there are, how dark darkness.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from os import cpu_count

import numpy as np
from numpy.typing import NDArray

from precompute.acquisition.lobe_fit import Fit, Model, fit_strip
from precompute.acquisition.lobes import RADIUS_STEP, Array32, LobeTable, lobe_deviation
from precompute.acquisition.observations import Shot, Strip, observed, strips
from precompute.acquisition.periods import (
    FEWEST,
    MeanProfile,
    explained,
    frequency_shares,
    one_frequency,
)
from precompute.acquisition.tiling import Tiling
from precompute.progress import tracked

Array = NDArray[np.float64]

FREQUENCIES: Array = np.geomspace(0.3, 2.2, 101)
"""1/a of 3.3 to 0.45 µm by 2 %: coarser shows no order outside the highlight, finer no first one."""

ROUGHNESSES = np.radians([0, 0.1, 0.2, 0.35, 0.5, 0.7, 1.0, 1.4, 2.0])
"""Of the normal; foils have some tenths of a degree."""

ROUGHNESS = np.radians(0.2)
"""Taken until it is known."""

HIGHLIGHT = 5.5
"""Deviations of order 0 in (u, v) beyond which 3e-7 of its peak is left."""

SAMPLE = 1_500_000
"""Observations from which all is estimated: a second's work each time."""

MODEL_ERROR = 0.1
"""Share of a lobe's peak by which it is not as the model says: what noise is weighed against."""

ALMOST = 0.97
"""Share of what many periods explain that one has to explain to be the only one."""

APART = 0.04
"""Relative difference in period between photographs that cannot be chance."""


@dataclass(frozen=True)
class Calibration:
    """What photographs say of themselves.

    Attributes:
        shots: The photographs, their background known.
        model: What gratings show in them.
        highlight: ρ below which nothing is observed.
        roughness: Of the normal, rad.
        shares: Of the area that diffracts, by `FREQUENCIES`.
        is_one_period: Whether all gratings have the same.
        apparent: Period in each photograph over that in all.
        noise: Of the darkest channel weights allow, over a lobe's peak.
    """

    shots: list[Shot]
    model: Model
    highlight: float
    roughness: float
    shares: Array
    is_one_period: bool
    apparent: Array
    noise: float


def calibrated(
    shots: list[Shot], tiling: Tiling, places: Array, height: float, one: bool | None
) -> Calibration:
    """Estimate all of it.

    Args:
        shots: The photographs.
        tiling: Where the tiles are.
        places: Texels of the pattern, in tiles, shape (n, 2).
        height: h0 of the gratings, µm.
        one: Whether there is one period; found out, if None.

    Raises:
        ValueError: Nothing is lit beyond the highlight.
    """
    highlight = HIGHLIGHT * max(lobe_deviation(shot.radius, ROUGHNESS) for shot in shots)
    count = len(tiling.tiles()) * len(shots)
    some = places[:: max(1, len(places) * count // SAMPLE)]
    shots, noise = _darkened(shots, tiling, some, highlight)
    profile = MeanProfile.of(_look(shots, tiling, some, highlight), len(shots))
    weights = _channel_weights(profile, noise)
    tables = _tables(shots, ROUGHNESS, FREQUENCIES, height)
    shares = frequency_shares(profile, tables, weights)
    if not shares.any():
        raise ValueError("nothing is lit beyond the highlight")
    tables, scales = _balanced(profile, tables, weights, shares)
    shares = frequency_shares(profile, tables, weights)
    frequency = one_frequency(profile, tables, weights)
    alone = LobeTables(shots, scales, height).at(ROUGHNESS, np.array([frequency]))
    if one is None:
        one = explained(profile, alone, weights, np.ones(1)) > ALMOST * explained(
            profile, tables, weights, shares
        )
    return Calibration(
        shots,
        Model(tables, shares / shares.sum(), float(shares.sum()), weights),
        highlight,
        float(ROUGHNESS),
        shares,
        one,
        np.ones(len(shots)),
        0.0,
    )
