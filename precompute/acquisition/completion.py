"""From what was fitted to a whole map: what to believe, what is dark, and what stayed hidden."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from precompute.acquisition.lobe_fit import Fit
from precompute.acquisition.pattern import Gratings

Array = NDArray[np.float64]

DOUBT = 0.2
"""Margin below which another orientation would do nearly as well."""


WHOLE = 0.6
"""Strength, over what most texels have, from which all of a texel diffracts: bumps and tiles that
are not quite in place dim one by as much."""


@dataclass(frozen=True)
class Completed:
    """A map with nothing left open, arrays of shape (rows, columns).

    Attributes:
        gratings: At each texel.
        confidence: No unit, 0 where it was not seen, towards 1 where it is bright and unambiguous.
        seen: Lit somewhere, and unambiguous.
        dark: Would have been lit somewhere if it diffracted: a texel without grating.
        unsure: Lit, but another orientation would do nearly as well.
        hidden: Dark, but some orientation would have been: the one that would have shown least.
    """

    gratings: Gratings
    confidence: Array
    seen: NDArray[np.bool_]
    dark: NDArray[np.bool_]
    unsure: NDArray[np.bool_]
    hidden: NDArray[np.bool_]


def completed(fit: Fit, size: tuple[int, int], lit_gain: float) -> Completed:
    """Judge each texel, and fill in what was not seen.

    A texel that is dark everywhere is one that does not diffract if every orientation would have
    been seen. Else it may have the one that would have shown least: its neighbours' would have
    shown, or it would be lit.

    Args:
        fit: Of all texels, row by row.
        size: Columns and rows.
        lit_gain: Gain, no unit, from which a texel counts as lit.
    """
    columns, rows = size
    parts = {name: values.reshape(rows, columns) for name, values in vars(fit).items()}
    gain, margin = parts["gain"], parts["margin"]
    lit = gain > lit_gain
    seen, unsure = lit & (margin > DOUBT), lit & (margin <= DOUBT)
    dark = ~lit & (parts["least"] > lit_gain)
    hidden = ~lit & ~dark
    common = float(np.median(parts["frequency"][lit])) if lit.any() else 1.0
    strength = np.where(lit, np.clip(parts["strength"] / WHOLE, 0, 1), hidden)
    return Completed(
        Gratings(
            np.where(hidden, parts["least_seen"], parts["orientation"]),
            np.where(hidden, common, parts["frequency"]),
            strength,
        ),
        np.where(lit, margin * gain / (gain + lit_gain), 0),
        seen,
        dark,
        unsure,
        hidden,
    )
