"""Whether a spot of light is the lamp's mirror image, by its colour."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import jv

from precompute.acquisition.lobes import MEAN_W
from precompute.spectra import WAVELENGTHS

Array = NDArray[np.float64]

HEIGHTS = np.linspace(0, 0.16, 9)
"""Of gratings, µm, up to that from which order 0 misses a colour: at 0.17, πwh/λ of violet,
0.42 µm, comes to 2.4, where J0 is 0."""

SHARES = (0.25, 0.5, 0.75, 1.0)
"""Of the light of order 0 that comes from gratings; the rest is from what is smooth."""

PERIODS = (0.8, 1.2, 1.8, 2.6)
"""µm: a lobe of gratings with longer ones takes in more wavelengths."""

BANDS = np.arange(0.4, 0.721, 0.01)
"""Middles of the wavelengths that first orders show, µm."""

APART = np.radians(5.0)
"""Between the colours of orders 0 and those of first orders, that they can be told apart: white
lamps' are 7 degrees or more, those behind a filter of 60 nm under 4."""


@dataclass(frozen=True)
class LampColour:
    """The colours that a lamp's mirror image may have in a foil, and those that facets have.

    Order 0 of a sinusoid of height h has J0²(πwh/λ) of the light (docs/theory/profiles.md), so that
    the mirror image does not quite have the lamp's colour: it is redder the higher the relief,
    which is not known. A first order is narrow: it shows wavelengths within a lobe's width times
    the period.

    Attributes:
        white: What channels make of the whole spectrum, shape (channels,).
        mirrored: Orders 0, over white, of length 1, shape (colours, channels).
        facets: First orders, the same.
    """

    white: Array
    mirrored: Array
    facets: Array

    @staticmethod
    def of(weights: Array, deviation: float) -> LampColour | None:
        """The colours under a lamp, or None where they cannot be told apart.

        Args:
            weights: Its spectrum times the channels' sensitivity, shape (401, channels).
            deviation: Standard deviation of a lobe in (u, v), no unit.
        """
        white = weights.sum(axis=0)
        zeroth = jv(0, np.pi * MEAN_W * HEIGHTS[:, None] / WAVELENGTHS) ** 2
        mixed = np.concatenate([1 - share + share * zeroth for share in SHARES])
        λ, width = BANDS[:, None], deviation * np.repeat(PERIODS, len(BANDS))[:, None]
        bands = np.exp(-((WAVELENGTHS - np.tile(λ, (len(PERIODS), 1))) ** 2) / (2 * width**2))
        shown = bands @ weights
        lit = shown.sum(axis=1) > 1e-3 * shown.sum(axis=1).max()  # the lamp may lack some
        colours = LampColour(white, _unit(mixed @ weights / white), _unit(shown[lit] / white))
        apart = _angles(colours.mirrored, colours.facets).min()
        return colours if apart > APART else None

    def shows(self, colour: Array) -> bool:
        """Whether light, shape (channels,), has rather a mirror image's colour than a facet's."""
        spot = _unit(np.maximum(colour, 0)[None] / self.white)
        return bool(_angles(spot, self.mirrored).min() < _angles(spot, self.facets).min())


def _unit(colours: Array) -> Array:
    return colours / np.maximum(np.linalg.norm(colours, axis=1, keepdims=True), 1e-30)


def _angles(these: Array, those: Array) -> Array:
    """Between directions, rad, shape (these, those)."""
    return np.arccos(np.clip(these @ those.T, -1, 1))
