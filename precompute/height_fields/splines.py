"""Splines on the texels of a table: the projection of Gaussians onto them.

A spline of degree d is Σ_i c_i β(x/Δ − i) with texels i at the step Δ and β the bell of d + 1 boxes
convolved, the central difference δ^(d+1) of x₊^d/d!: a hat over two intervals for d = 1, a smooth
bell over four for d = 3, of variance (d + 1)Δ²/12. Coefficients that make it the closest to f in
the mean square solve G c = b, b_i = ∫ f β_i dx, G_ij = ∫ β_i β_j dx. Such a spline has the integral
of f, however narrow f may be.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solveh_banded
from scipy.special import ndtr

from precompute.axes import Axis

Array = NDArray[np.float64]

Degree = Literal[1, 3]

GRAM: dict[Degree, Array] = {
    1: np.array([4, 1]) / 6,
    3: np.array([2416, 1191, 120, 1]) / 5040,
}
"""∫ β_i β_j dx/Δ for |i − j| = 0 to d, by degree: β of degree 2d + 1 at the integers."""

REACH = 5.5
"""Deviations beyond which a Gaussian is taken as zero: 3e-7 of its peak."""


def gaussian_moments(centres: Array, deviation: float, axis: Axis, degree: Degree) -> Array:
    """b_i = ∫ N(x − m; τ²) β_i(x) dx/Δ for each m.

    By the central difference δ^(d+1) of N's integral so many times over, E[(x − X)₊^d]/d!, X
    normal.

    Args:
        centres: m, shape (n,); those out of the axis' reach give zeros.
        deviation: τ, above 0, no unit of its own: the axis'.
        axis: Linear.
        degree: d.

    Returns:
        No unit, shape (n, axis.size).
    """
    step = (axis.last - axis.first) / (axis.size - 1)
    position = (centres - axis.first) / step
    τ = deviation / step
    half = (degree + 1) // 2
    reach = int(np.ceil(REACH * τ)) + half
    nearest = np.rint(position).astype(int)
    texels = nearest[:, None] + np.arange(-reach, reach + 1)
    x = (nearest - position)[:, None] + np.arange(-reach - half, reach + half + 1)
    below, density = ndtr(x / τ), np.exp(-((x / τ) ** 2) / 2) / np.sqrt(2 * np.pi)
    if degree == 1:
        integral = x * below + τ * density
    else:
        integral = ((x**3 + 3 * x * τ**2) * below + (x**2 + 2 * τ**2) * τ * density) / 6
    moments = np.diff(integral, degree + 1, axis=1) / step
    inside = (texels >= 0) & (texels < axis.size)
    result = np.zeros((len(centres), axis.size))
    result[np.nonzero(inside)[0], texels[inside]] = moments[inside]
    return result


def coefficients(moments: Array, axis: int, degree: Degree) -> Array:
    """c of G c = b along an axis of `moments`, in their unit, no splines beyond its ends.

    Args:
        moments: b, shape (..., n, ...), of any unit.
        axis: The index of the axis.
        degree: d of the splines.
    """
    b = np.moveaxis(moments, axis, 0)
    banded = np.repeat(GRAM[degree][:, None], len(b), axis=1)
    c = solveh_banded(banded, b.reshape(len(b), -1), lower=True)
    return np.moveaxis(c.reshape(b.shape), 0, axis)


def evaluated(texels: Array, cubic: Array, linear: Array) -> Array:
    """The splines of coefficients at texel indices, which may be fractional.

    Beyond their ends the outermost coefficients go on, as in a texture that is clamped to its edge.

    Args:
        texels: c, shape (rows, columns, …): splines of degree 3 down the rows, of degree 1 along
            the columns.
        cubic: Row indices, shape (n,).
        linear: Column indices, likewise.

    Returns:
        Shape (n, …).
    """
    row, column = np.floor(cubic).astype(int), np.floor(linear).astype(int)
    t = cubic - row
    s = linear - column
    down = np.stack([(1 - t) ** 3, 4 - 3 * t**2 * (2 - t), 1 + 3 * t * (1 + t - t**2), t**3]) / 6
    rows = np.clip(row[:, None] + np.arange(-1, 3), 0, texels.shape[0] - 1)
    columns = np.clip(column[:, None] + np.arange(2), 0, texels.shape[1] - 1)
    near = texels[rows[:, :, None], columns[:, None, :]]
    return np.einsum("an,nb,nab...->n...", down, np.stack([1 - s, s], axis=-1), near)
