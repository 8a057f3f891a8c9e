"""Cubic B-splines on the texels of a table: the projection of Gaussians onto them.

A spline is Σ_i c_i β(x/Δ − i) with texels i at the step Δ and

    β(x) = δ⁴ x₊³/6 = (|x − 2|³₊ − 4|x − 1|³₊)/6,

four straight pieces convolved, a bell of variance Δ²/3 that covers four texels. Coefficients that
make it the closest to f in the mean square solve G c = b, b_i = ∫ f β_i dx, G_ij = ∫ β_i β_j dx.
Such a spline has the integral of f, however narrow f may be.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solveh_banded
from scipy.ndimage import map_coordinates
from scipy.special import ndtr

from precompute.axes import Axis

Array = NDArray[np.float64]

GRAM = np.array([2416, 1191, 120, 1]) / 5040
"""∫ β_i β_j dx/Δ for |i − j| = 0 to 3: β of twice the order at the integers."""

REACH = 5.5
"""Deviations beyond which a Gaussian is taken as zero: 3e-7 of its peak."""


def gaussian_moments(centres: Array, deviation: float, axis: Axis) -> Array:
    """b_i = ∫ N(x − m; τ²) β_i(x) dx/Δ for each m.

    By the fourth central difference of N's fourth integral, ⅙ E[(x − X)₊³], X normal.

    Args:
        centres: m, shape (n,); those out of the axis' reach give zeros.
        deviation: τ, above 0.
        axis: Linear.

    Returns:
        Shape (n, axis.size).
    """
    step = (axis.last - axis.first) / (axis.size - 1)
    position = (centres - axis.first) / step
    τ = deviation / step
    reach = int(np.ceil(REACH * τ)) + 2
    nearest = np.rint(position).astype(int)
    texels = nearest[:, None] + np.arange(-reach, reach + 1)
    x = (nearest - position)[:, None] + np.arange(-reach - 2, reach + 3)
    integral = (x**3 + 3 * x * τ**2) * ndtr(x / τ) / 6
    integral += (x**2 + 2 * τ**2) * τ * np.exp(-((x / τ) ** 2) / 2) / np.sqrt(72 * np.pi)
    moments = np.diff(integral, 4, axis=1) / step
    inside = (texels >= 0) & (texels < axis.size)
    result = np.zeros((len(centres), axis.size))
    result[np.nonzero(inside)[0], texels[inside]] = moments[inside]
    return result


def coefficients(moments: Array, axis: int) -> Array:
    """c of G c = b along an axis of `moments`, the splines beyond its ends left out."""
    b = np.moveaxis(moments, axis, 0)
    banded = np.repeat(GRAM[:, None], len(b), axis=1)
    c = solveh_banded(banded, b.reshape(len(b), -1), lower=True)
    return np.moveaxis(c.reshape(b.shape), 0, axis)


def evaluated(texels: Array, *positions: Array) -> Array:
    """The spline of coefficients at texel indices, which may be fractional.

    Args:
        texels: c, one axis a dimension; beyond its ends the outermost ones go on, as a texture
            that is clamped to its edge has them.
        positions: One array of indices for each axis, all of one shape.

    Returns:
        That shape.
    """
    return map_coordinates(texels, np.stack(positions), order=3, mode="nearest", prefilter=False)
