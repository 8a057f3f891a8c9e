"""Whether each photograph shows what the others foretell.

One of a symmetric foil upside down, or at another angle than stated, has edges where the others
have them, so that it is registered; but no cosine goes through it and them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from precompute.acquisition.polarization_fit import HarmonicFit, Harmonics, Pixels

Array = NDArray[np.float64]

FEWEST = 5
"""Photographs, from which one may be told from the others: of four all are off by as much."""

FLOOR = 0.002
"""Of the mean light: what resampling a picture changes, whoever took it."""


def misfits(photographs: Pixels, harmonics: Harmonics, fit: HarmonicFit) -> Array:
    """How far each photograph is off what the others foretell, over how far these are themselves.

    The externally studentised residual, of all pixels together: with e_k² the mean square of
    photograph k's residuals and h_k its leverage, e_k²/(1 − h_k) = d_k² is the squared error of
    foretelling it by the others, and (Σ e² − d_k²)/(n − 4) their own variance.

    Args:
        photographs: Shape (photographs, …), NaN where light is unknown.
        harmonics: What they were fitted by.
        fit: What was fitted, of the shape of one photograph.

    Returns:
        No unit, shape (photographs,): about 1 each, 0 for fewer than `FEWEST`.
    """
    count = len(photographs)
    if count < FEWEST:
        return np.zeros(count)
    along = fit.amplitude * np.exp(1j * fit.phase)
    columns = harmonics.columns + harmonics.middles[:, None]
    squares = np.empty(count)
    for k, photograph in enumerate(photographs):
        u, v = columns[:, k]
        foretold = fit.mean + u * along.real + v * along.imag
        off = photograph / harmonics.means[k] - foretold
        squares[k] = np.nanmean(off**2, dtype=np.float64)
    inverse = np.linalg.inv(harmonics.columns @ harmonics.columns.T)
    leverage = 1 / count + np.einsum("ik,ij,jk->k", harmonics.columns, inverse, harmonics.columns)
    deleted = squares / (1 - leverage)
    others = np.maximum(squares.sum() - deleted, 0) / (count - 4)
    return np.sqrt(deleted / (others + FLOOR**2))
