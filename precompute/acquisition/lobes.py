"""What a camera sees of a grating's lobes, for fitting: orders that do not overlap, in closed form.

Near the line through the highlight along a grating's vector, the orders of a lobe of standard
deviation c show

    f(ρ, φ) = Σ_m J_m²(β) /(√2π c) exp(−(ρ sin(φ − θ))²/2c²) · ∫ W(λ) N(ρ − mλ/a; c) dλ,

with (u, v) = ρ (cos φ, sin φ), β = πwh0/λ: docs/theory/gratings.md and flash.md.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d
from scipy.special import jv

from precompute.spectra import WAVELENGTH_STEP, WAVELENGTHS

Array = NDArray[np.float64]
Array32 = NDArray[np.float32]

ORDERS = 4
"""Orders that are summed: none beyond is seen of a printed foil."""

RADIUS_STEP = 0.005
"""Of tables over ρ: under half of the narrowest lobe's standard deviation, a coherence window's."""

FINER = 5
"""Steps of a table's making in one of its own: a fifth of the narrowest lobe's deviation."""

RADIUS_MAX = 1.6
"""Largest ρ of a table: both directions would graze."""

MEAN_W = 1.9
"""w for which efficiencies are reckoned: of directions 18° from the normal."""


def lobe_deviation(radius: float, roughness: float, coherence: float = 16.25) -> float:
    """c: standard deviation of a lobe in (u, v), at 0.55 µm.

    Args:
        radius: Standard deviation of the light as seen from the sample, rad.
        roughness: Of the normal, rad.
        coherence: σ of the coherence window, µm.
    """
    window = 0.55 / (np.sqrt(8) * np.pi * coherence)
    return float(np.sqrt(radius**2 + (MEAN_W * roughness) ** 2 + window**2))


@dataclass(frozen=True)
class LobeTable:
    """Profiles of lobes over ρ, for a light and some frequencies of gratings.

    Attributes:
        frequencies: 1/a, 1/µm, rising evenly in its logarithm, shape (F,).
        values: At ρ = i · `RADIUS_STEP`, shape (F, radii, channels), at the middle of a lobe.
        deviation: c, for which they were made.
    """

    frequencies: Array
    values: Array32
    deviation: float

    @staticmethod
    def of(
        weights: Array,
        deviation: float,
        frequencies: Array,
        height: float,
        orders: range = range(1, ORDERS + 1),
    ) -> LobeTable:
        """Tabulate.

        Args:
            weights: Light times sensitivity on `WAVELENGTHS`, shape (401, channels).
            deviation: c, no unit.
            frequencies: 1/a, 1/µm.
            height: h0 of the sinusoids, µm.
        """
        lit = np.flatnonzero(weights.any(axis=1))
        λ = WAVELENGTHS[lit]
        radii = round(RADIUS_MAX / RADIUS_STEP)
        fine = np.zeros((len(frequencies), radii * FINER + 1, weights.shape[1]))
        rows = np.arange(len(frequencies))[:, None]
        for m in orders:
            efficiency = jv(m, np.pi * MEAN_W * height / λ) ** 2
            power = WAVELENGTH_STEP * weights[lit] * efficiency[:, None]
            place = np.minimum(
                m * λ * frequencies[:, None] / RADIUS_STEP * FINER, radii * FINER - 1
            )
            below = place.astype(np.intp)
            share = (place - below)[..., None]
            np.add.at(fine, (rows, below), (1 - share) * power)
            np.add.at(fine, (rows, below + 1), share * power)
        blurred = gaussian_filter1d(fine, deviation / RADIUS_STEP * FINER, axis=1, truncate=6)
        # The blur's sum over texels is 1, its integral over ρ is to be.
        values = blurred[:, :-1:FINER] * FINER / RADIUS_STEP / (np.sqrt(2 * np.pi) * deviation)
        return LobeTable(frequencies, values.astype(np.float32), deviation)

    def scaled(self, factor: float) -> LobeTable:
        """The same, so many times as bright.

        Args:
            factor: How many times.
        """
        return LobeTable(self.frequencies, self.values * np.float32(factor), self.deviation)


def at_radius(profile: Array32, radius: Array32) -> Array32:
    """A profile of shape (radii, channels) at ρ, linear between its numbers.

    Args:
        profile: At multiples of `RADIUS_STEP`, shape (radii, channels).
        radius: ρ, any shape.

    Returns:
        In the unit of `profile`, shape that of `radius`, then channels.
    """
    place = np.minimum(radius / np.float32(RADIUS_STEP), len(profile) - 1.001)
    below = place.astype(np.int32)
    share = (place - below)[..., None]
    return (profile[below] * (1 - share) + profile[below + 1] * share).astype(np.float32)
