"""How far an acquired foil is from the foil that was photographed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from precompute.acquisition.observations import texel_places
from precompute.acquisition.pattern import Gratings, gratings_of, texel_indices
from precompute.maps import Map

Array = NDArray[np.float64]


@dataclass(frozen=True)
class MapErrors:
    """A map against the truth, over the texels that diffract in truth.

    Attributes:
        diffracts: Which texels of the map these are, shape (rows · columns,).
        orientation: Distance in degrees, shape (texels,).
        period: Relative difference.
        periods: What was found, µm.
    """

    diffracts: NDArray[np.bool_]
    orientation: Array
    period: Array
    periods: Array

    @staticmethod
    def of(foil: Map, truth: Map) -> MapErrors:
        """Texels are compared with the truth's at their middles."""
        found, texels = gratings_of(foil), gratings_of(truth)
        rows, columns = found.orientation.shape
        place = texel_places((columns, rows)) * [1, -1]
        flat = Gratings(*(part.ravel() for part in vars(texels).values()))
        true = flat[texel_indices(texels.orientation.shape, place)]
        diffracts = true.strength > 0.5
        apart = np.mod(found.orientation.ravel() - true.orientation + np.pi / 2, np.pi) - np.pi / 2
        period = 1 / np.maximum(found.frequency.ravel(), 1e-3)
        return MapErrors(
            diffracts,
            np.degrees(np.abs(apart))[diffracts],
            np.abs(period * true.frequency - 1)[diffracts],
            period[diffracts],
        )
