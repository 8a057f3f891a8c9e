"""From what was fitted to a whole map: what to believe, what is dark, and what stayed hidden."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from precompute.acquisition.lobe_fit import Fit
from precompute.acquisition.pattern import Gratings

Array = NDArray[np.float64]

DIM = 0.01
"""Gain, in that of a lobe at its peak, from which a texel counts as lit: seen 3 deviations off."""

NOISE = 4.0
"""Times what noise alone gains from which a texel counts as lit."""

DOUBT = 0.2
"""Margin below which another orientation would do nearly as well."""

CLOSE = 2
"""Texels over which what is not known is taken from its neighbours: an edge's width."""


@dataclass(frozen=True)
class Completed:
    """A map with nothing left open, arrays of shape (rows, columns).

    Attributes:
        gratings: At each texel.
        confidence: 0 where it was not seen, towards 1 where it is bright and unambiguous.
        seen: Lit somewhere, and unambiguous.
        dark: Would have been lit somewhere if it diffracted: a texel without grating.
        filled: Not seen; what neighbours show.
        hidden: Not seen, and no neighbour near that is: the orientation that would have shown least.
    """

    gratings: Gratings
    confidence: Array
    seen: NDArray[np.bool_]
    dark: NDArray[np.bool_]
    filled: NDArray[np.bool_]
    hidden: NDArray[np.bool_]


def completed(fit: Fit, size: tuple[int, int], noise: float) -> Completed:
    """Judge each texel, and fill in what was not seen.

    A texel that is dark everywhere is one that does not diffract if every orientation would have
    been seen. Else it may have the one that would have shown least.

    Args:
        fit: Of all texels, row by row.
        size: Columns and rows.
        noise: Gain that noise alone reaches.
    """
    columns, rows = size
    parts = {name: values.reshape(rows, columns) for name, values in vars(fit).items()}
    gain, margin = parts["gain"], parts["margin"]
    lit = max(DIM, NOISE * noise)
    seen = (gain > lit) & (margin > DOUBT)
    dark = ~seen & (gain <= lit) & (parts["least"] > lit)
    source, distance = _nearest(seen)
    unknown = ~seen & ~dark
    filled = unknown & (distance <= CLOSE)
    hidden = unknown & ~filled
    borrowed = np.where(filled, source, np.arange(rows * columns).reshape(rows, columns))
    orientation, frequency, strength = (
        parts[name].ravel()[borrowed] for name in ("orientation", "frequency", "strength")
    )
    common = float(np.median(frequency[seen])) if seen.any() else 1.0
    return Completed(
        Gratings(
            np.where(hidden, parts["least_seen"], orientation),
            np.where(hidden, common, frequency),
            np.where(dark, 0, np.where(hidden, 1, np.clip(strength, 0, 1))),
        ),
        np.where(seen, margin * gain / (gain + lit), 0),
        seen,
        dark,
        filled,
        hidden,
    )


def _nearest(seen: NDArray[np.bool_]) -> tuple[NDArray[np.intp], Array]:
    """For each texel of a tile that repeats, the nearest seen one, and how far it is, texels."""
    rows, columns = seen.shape
    if not seen.any():
        return np.zeros(seen.shape, np.intp), np.full(seen.shape, np.inf)
    distance, index = distance_transform_edt(~np.tile(seen, (3, 3)), return_indices=True)
    middle = (slice(rows, 2 * rows), slice(columns, 2 * columns))
    row, column = index[0][middle] % rows, index[1][middle] % columns
    return row * columns + column, distance[middle]
