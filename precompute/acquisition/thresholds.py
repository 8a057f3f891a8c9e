"""The seed's way to orientations: what is brightest decides (2018 paper, 4.3 and 4.4).

Observations are taken from the brightest down; the first that shows a texel gives its orientation,
the direction to the highlight, and its period, nλ/√(u² + v²) with n = 1.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from precompute.acquisition.observations import Strip

Array = NDArray[np.float64]

THRESHOLDS = 32
"""Steps from the brightest down, each 0.8 of the one before: the last is 1/1000."""


def brightest(strip: Strip, wavelength: float) -> tuple[Array, Array, Array]:
    """Orientation and period of each texel by thresholds that fall step by step.

    Observations that pass the same threshold count by their brightness.

    Args:
        strip: Observations of n texels.
        wavelength: λ that the channels see, µm.

    Returns:
        θ in [0, π), a in µm, and the threshold that was passed over the brightest observation, 0
        where none was; shape (n,) each.
    """
    brightness = np.where(strip.usable, strip.intensity.sum(axis=2), 0)
    steps = 0.8 ** np.arange(THRESHOLDS)
    best = brightness.max(axis=1)
    passed = np.searchsorted(-steps, -best / max(float(best.max(initial=0)), 1e-30))
    threshold = np.where(passed < THRESHOLDS, steps[np.minimum(passed, THRESHOLDS - 1)], 0)
    above = np.where(brightness >= (threshold * best.max(initial=0))[:, None], brightness, 0)
    above = np.where(threshold[:, None] > 0, above, 0)
    double = 2 * np.arctan2(strip.v, strip.u)
    θ = np.arctan2((above * np.sin(double)).sum(axis=1), (above * np.cos(double)).sum(axis=1)) / 2
    total = np.maximum(above.sum(axis=1), 1e-30)
    period = (above * wavelength / np.hypot(strip.u, strip.v)).sum(axis=1) / total
    return np.mod(θ, np.pi), period, threshold
