"""|P|²/A of a finite number of repeats of a patch, in float64.

A window cut to them (`precompute.height_fields.window`) has lobes L_x L_y in place of Gaussians. It
covers N whole patches from the first sample on, so that its middle changes the phase of line j by
πjN:

    |P|²/A = |Σ_jl (−1)^(jN_x + lN_y) A_jl L_x(s u − j/T_x) L_y(s v − l/T_y)|²/A
    |P|²/A = Σ_jl |A_jl|² ((L_x L_y)²/A ∗ N(·; C))(s d − f_jl)    with a blur of covariance C

Tails fall as slowly as 1/f: all lines that the samples resolve count.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import hermite_e
from numpy.typing import NDArray

from precompute.height_fields.field import HeightField
from precompute.height_fields.lines import (
    EXPONENT_CUT,
    Index,
    Interpolation,
    Lines,
    Points,
    nodes_needed,
    sum_over_lines,
)
from precompute.height_fields.optics import HeightFieldOptics
from precompute.height_fields.window import BlurredLobes, CutWindow

Array = NDArray[np.float64]
Windows = tuple[CutWindow, CutWindow]

TAIL = 1e-6
"""Share of its peak below which the lobe of a cut window counts as dark."""

MOST_DIRECTIONS = 24
"""Hermite nodes over a blur's excess along one direction: see `_directions`."""


def density_of_repeats(
    field: HeightField, tiles: tuple[int, int], windows: Windows, points: Points
) -> Array:
    """|P|²/A without blur behind a window cut to some repeats, µm².

    Args:
        field: The relief.
        tiles: How many patches along x and y.
        windows: Of both axes.
        points: Where.
    """
    over = Interpolation(points.kw, nodes_needed(field, points.kw, 1))
    radius = np.array([window.reach(TAIL) for window in windows])
    lines = Lines(field, over.nodes, np.abs(points.at).max(axis=0) + radius)
    # The window's middle stands N/2 patches from the first sample.
    x, y = (
        (-1.0) ** (np.arange(-n, n + 1) * count)
        for n, count in zip(lines.limit, tiles, strict=True)
    )

    def lobes(_: Index, dx: Array, dy: Array) -> Array:
        return windows[1].amplitude(dy)[:, :, None] * windows[0].amplitude(dx)[:, None, :]

    amplitudes = lines.amplitudes * (y[:, None] * x)
    total = sum_over_lines(points, lines, over, amplitudes, radius, lobes)
    return np.abs(total) ** 2


@dataclass(frozen=True)
class SplitBlur:
    """A blur of covariance b²·1 + e eᵀ in the plane of spatial frequencies.

    Attributes:
        width: b, 1/µm, shape (n,).
        excess: e, 1/µm, shape (n, 2).
    """

    width: Array
    excess: Array

    @staticmethod
    def of(
        optics: HeightFieldOptics, wi: Array, wo: Array, wavelength: Array, angular_radius: float
    ) -> SplitBlur:
        """That of `HeightFieldOptics.covariance` without the window.

        1 − tt^T = cos²θ_i·1 + t'(t')^T, t = (ω_i)_xy and t' at right angles to it, as long.

        Args:
            optics: Roughness and coherence.
            wi: ω_i, shape (n, 3), above the horizon.
            wo: ω_o, shape (n, 3), above the horizon.
            wavelength: λ, µm, shape (n,).
            angular_radius: α of the light, rad.
        """
        tilt = (wi[:, 2] + wo[:, 2]) * optics.roughness
        across = np.stack([-wi[:, 1], wi[:, 0]], axis=1)
        return SplitBlur(
            np.hypot(tilt, angular_radius * wi[:, 2]) / wavelength,
            angular_radius * across / wavelength[:, None],
        )


def _directions(blur: SplitBlur) -> tuple[Array, Array]:
    """Hermite nodes over e, in deviations, and their shares.

    What is blurred by b already has waves exp(2πifx) that are damped by exp(−2π²b²x²), of which n
    nodes miss (|e|²/2b²)^n at most: 1e-6 is aimed at.
    """
    miss = float(np.max((blur.excess**2).sum(axis=1) / (2 * blur.width**2)))
    count = 1 if miss == 0 else MOST_DIRECTIONS
    if 0 < miss < 0.5:
        count = min(count, int(np.ceil(np.log(1e-6) / np.log(miss))))
    nodes, shares = hermite_e.hermegauss(count)
    return nodes, shares / shares.sum()


def blurred_density_of_repeats(
    field: HeightField, windows: Windows, blur: SplitBlur, points: Points
) -> Array:
    """|P|²/A with blur behind a window cut to some repeats, µm²."""
    over = Interpolation(points.kw, nodes_needed(field, points.kw, 2))
    nodes, shares = _directions(blur)
    beyond = np.sqrt(2 * EXPONENT_CUT) * blur.width.max() + nodes.max() * np.abs(blur.excess).max()
    radius = beyond + np.array([window.reach(TAIL) for window in windows])
    lines = Lines(field, over.nodes, np.abs(points.at).max(axis=0) + radius)
    widths = (float(blur.width.min()), float(blur.width.max()))
    span = np.abs(points.at).max(axis=0) + lines.limit * lines.step
    farthest = np.minimum(span, 2 * radius + 2 * lines.step) + beyond
    blurred = [
        BlurredLobes(window, widths, float(f)) for window, f in zip(windows, farthest, strict=True)
    ]

    def lobes(part: Index, dx: Array, dy: Array) -> Array:
        width = blur.width[part, None, None]
        x, y = (
            lobe(d[:, None, :] - nodes[:, None] * e[:, None, None], width)
            for lobe, d, e in zip(blurred, (dx, dy), blur.excess[part].T, strict=True)
        )
        return np.einsum("q,nqj,nql->nlj", shares, x, y, optimize=True)

    return sum_over_lines(points, lines, over, np.abs(lines.amplitudes) ** 2, radius, lobes)
