"""How orientation and period vary within a figure."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from precompute.foils.figure_recipes import Around, Bands, Constant, Over, Ramp

Array = NDArray[np.float64]
Variation: TypeAlias = Constant[Any] | Bands[Any] | Ramp[Any] | Around


def values_at(variation: Variation, x: Array, y: Array) -> Array:
    """What a figure's recipe states at points of its frame.

    Args:
        variation: Of its orientation or its period.
        x: In its frame, mm.
        y: Likewise, of the same shape.

    Returns:
        Orientations in degrees, not reduced to a half turn, or periods in µm; of that shape.
    """
    match variation:
        case Constant():
            return np.full(x.shape, float(variation.value))
        case Bands():
            band = np.floor(_coordinate(variation.over, x, y) / variation.width_mm)
            values = np.asarray(variation.values, float)
            return values[np.mod(band, values.size).astype(np.intp)]
        case Ramp():
            ends = np.linspace(variation.from_mm, variation.to_mm, len(variation.values))
            return np.interp(_coordinate(variation.over, x, y), ends, variation.values)
        case Around():
            turned = variation.half_turns / 2 * np.rad2deg(np.arctan2(y, x))
            return variation.start_deg + turned + variation.twist_deg * np.hypot(x, y)


def _coordinate(over: Over, x: Array, y: Array) -> Array:
    match over:
        case "x":
            return x
        case "y":
            return y
        case "radius":
            return np.hypot(x, y)
