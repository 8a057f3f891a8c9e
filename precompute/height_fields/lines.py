"""The lines of a relief's spectrum near many points at once, each at a kw of its own.

A_jl(kw) is one FFT of exp(ikwh), an entire function of kw of exponential type: over an interval in
which kw Δ/2 changes by 2z, interpolation between Chebyshev nodes converges as the tail of the
Bessel functions J_n(z): z + 22 nodes leave 1e-12 for z up to 10, z + 33 for z up to 40. That is
exact arithmetic for all purposes here, not a table.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.fft
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from precompute.height_fields.expansion import terms_needed
from precompute.height_fields.field import HeightField

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
Index = NDArray[np.intp]

EXPONENT_CUT = 20.0
"""Gaussian weights below e^−20 = 2e-9 are left out: of amplitudes, so 4e-18 of intensities; of one
of the two Gaussians that make up a blurred lobe, so e^−40 of the lobe."""

AMPLITUDE_ERROR = 1e-12
"""Largest error of an amplitude, or of a product of two, interpolated in kw."""

PIECE = 2**18
"""Multiplications of one matrix product: OpenBLAS spreads larger ones over threads, which at these
sizes wait for one another ten times longer than they work if the processors are busy."""

DARK = 1e-12
"""Lines whose amplitude stays below are left out, at the edges of the box of lines."""


def line_amplitudes(field: HeightField, kw: float) -> ComplexArray:
    """A_jl(kw), no unit, of all lines that the samples resolve.

    Args:
        field: The relief.
        kw: 2πw/λ, 1/µm.

    Returns:
        Shape of the heights; line (j, l) at ``[l, j]``, negative ones from the end.
    """
    return np.asarray(scipy.fft.ifft2(np.exp(1j * kw * field.heights), workers=-1))


@dataclass(frozen=True)
class Points:
    """Where |P|²/A is asked for.

    Attributes:
        kw: 2πw/λ, 1/µm, shape (n,).
        at: s d, 1/µm, shape (n, 2).
        covariance: C_f, 1/µm², (xx, yy, xy), shape (3, n).
    """

    kw: Array
    at: Array
    covariance: Array


def groups(labels: NDArray[np.int_]) -> Iterator[Index]:
    """Rows of each label.

    Args:
        labels: Whole numbers, shape (n,), one for each row.
    """
    order = np.argsort(labels, kind="stable")
    ends = np.flatnonzero(np.diff(labels[order])) + 1
    yield from np.split(order, ends)


class Interpolation:
    """Between Chebyshev nodes over the range of kw of some points.

    Args:
        kw: 1/µm.
        nodes: How many.
    """

    def __init__(self, kw: Array, nodes: int) -> None:
        self.middle = (kw.max() + kw.min()) / 2
        self.half = max(np.ptp(kw) / 2, 1e-9 * self.middle)
        x = np.cos(np.pi * (np.arange(nodes) + 0.5) / nodes)
        self.nodes = self.middle + self.half * x
        # From values at the nodes to coefficients of T_n, by discrete orthogonality.
        self._coefficients = chebyshev.chebvander(x, nodes - 1).T * (2 / nodes)
        self._coefficients[0] /= 2

    def weights(self, kw: Array) -> Array:
        """Factors of the values at the nodes, shape (len(kw), nodes)."""
        x = (kw - self.middle) / self.half
        return chebyshev.chebvander(x, len(self.nodes) - 1) @ self._coefficients


class Lines:
    """Amplitudes at some values of kw of the lines within a box about f = 0.

    Args:
        field: The relief.
        kw: 1/µm, shape (nodes,).
        reach: Half of the box's sides, 1/µm; it ends at the Nyquist frequency in any case.

    Attributes:
        step: Between lines, (1/T_x, 1/T_y), 1/µm.
        limit: (J, L): lines run from −J to J and from −L to L.
        amplitudes: Shape (nodes, 2L + 1, 2J + 1).
    """

    def __init__(self, field: HeightField, kw: Array, reach: Array) -> None:
        rows, columns = field.heights.shape
        self.step = 1 / np.array(field.period)
        nyquist = np.array([(columns - 1) // 2, (rows - 1) // 2])
        self.limit = np.minimum(np.ceil(reach / self.step).astype(int), nyquist)
        j, l = (np.arange(-n, n + 1) for n in self.limit)  # noqa: E741
        # A constant height changes the phase of all amplitudes alike; about the middle they turn
        # slowest with kw.
        middle = (field.heights.max() + field.heights.min()) / 2
        about = HeightField(field.heights - middle, field.pitch)
        amplitudes = np.stack([line_amplitudes(about, q)[np.ix_(l, j)] for q in kw])
        bright = np.abs(amplitudes).max(axis=0) > DARK
        box = [np.abs(n[bright.any(axis=a)]).max(initial=0) for a, n in enumerate((j, l))]
        columns, rows = (
            slice(n - kept, n + kept + 1) for n, kept in zip(self.limit, box, strict=True)
        )
        self.limit = np.array(box)
        self.amplitudes = amplitudes[:, rows, columns]


def nodes_needed(field: HeightField, kw: Array, factors: int) -> int:
    """Chebyshev nodes for products of so many amplitudes over the range of kw.

    Args:
        field: The relief.
        kw: k w, rad/µm, any shape; only its range counts.
        factors: How many amplitudes are multiplied.
    """
    z = factors * field.amplitude * float(np.ptp(kw)) / 2
    return 1 + terms_needed("jacobi-anger", z, AMPLITUDE_ERROR)


def sum_over_lines(
    points: Points,
    lines: Lines,
    over: Interpolation,
    values: NDArray[Any],
    reach: Array,
    weights: Callable[[Index, Array, Array], Array],
) -> NDArray[Any]:
    """Σ_jl v_jl(kw) · weight of line (j, l), at each point.

    Args:
        points: Where.
        lines: Which.
        over: Interpolation in kw.
        values: v at its nodes, shape (nodes, lines along y, lines along x).
        reach: Farthest that a line counts along x and y, 1/µm.
        weights: Of lines for some of the points' rows: from the distances along x, shape
            (rows, columns of lines), and along y, (rows, rows of lines), to (rows, lines along y,
            lines along x).

    Returns:
        In the unit of the values, shape (n,), real or complex as they are.
    """
    total = np.zeros_like(values, shape=len(points.kw))
    for tile in tiles_of(points.at, lines.step, reach):
        columns, rows = (
            slice(max(first + n, 0), max(first + n + count, 0))
            for first, count, n in zip(tile.first, tile.count, lines.limit, strict=True)
        )
        near = values[:, rows, columns]
        if near.size == 0:
            continue
        fx, fy = (
            (np.arange(s.start, s.start + size) - n) * step
            for s, size, n, step in zip(
                (columns, rows), near.shape[:0:-1], lines.limit, lines.step, strict=True
            )
        )
        # As real numbers: the real and the imaginary part of a line side by side.
        table = near.reshape(len(over.nodes), -1).view(np.float64)
        for part in tile.parts(near[0].size):
            values_at = product(over.weights(points.kw[part]), table).view(values.dtype)
            dx, dy = points.at[part, 0, None] - fx, points.at[part, 1, None] - fy
            weights_at = weights(part, dx, dy).reshape(len(part), -1)
            total[part] = np.einsum("nk,nk->n", values_at, weights_at)
    return total


def product(one: Array, other: Array) -> Array:
    """The matrix product, in the product of both units, a few rows at a time.

    Args:
        one: Numbers of any unit, shape (n, m).
        other: Likewise, shape (m, k).
    """
    result = np.empty((len(one), other.shape[1]))
    rows = max(1, PIECE // other.size)
    for k in range(0, len(one), rows):
        np.matmul(one[k : k + rows], other, out=result[k : k + rows])
    return result


@dataclass(frozen=True)
class Tile:
    """Points that lie together, and the lattice nodes within reach of any of them.

    Attributes:
        points: Their rows.
        first: Index of the first node along x and y.
        count: Number of nodes along x and y.
    """

    points: Index
    first: tuple[int, int]
    count: tuple[int, int]

    def parts(self, nodes: int) -> list[Index]:
        """The points in pieces that keep (points × nodes) arrays in some megabytes."""
        size = max(1, 2**20 // nodes)
        return [self.points[k : k + size] for k in range(0, len(self.points), size)]


def tiles_of(at: Array, step: Array, radius: Array) -> Iterator[Tile]:
    """Points by tiles of a lattice, each about as large as the reach, so that few nodes are vain.

    Args:
        at: Positions, shape (n, 2), in one unit with what follows: 1/µm.
        step: Of the lattice, whose nodes are its multiples, along x and y, 1/µm.
        radius: Farthest node that counts, along x and y, 1/µm.
    """
    reach = np.floor(radius / step + 0.5).astype(int)
    side = np.maximum(reach // 2, 1)
    tile = np.floor_divide(np.rint(at / step).astype(int), side)
    low = tile.min(axis=0)
    across = tile[:, 0].max() - low[0] + 1
    for rows in groups((tile[:, 1] - low[1]) * across + tile[:, 0] - low[0]):
        first = tile[rows[0]] * side - reach
        count = side + 2 * reach
        yield Tile(rows, (int(first[0]), int(first[1])), (int(count[0]), int(count[1])))
