"""The reference for height fields: Kirchhoff's integral in float64, at every nanometre.

A patch that repeats has the lines f_jl = (j/T_x, l/T_y), whose amplitudes at one kw are one FFT:

    A_jl(kw) = mean over the patch of exp(ikwh) exp(+2πi (j x/T_x + l y/T_y)).

Behind one window exp(−r²/2σ²), which stands on the patch's first sample, their lobes overlap and
interfere. With s = 1/λ, d = (ω_i + ω_o)_xy and W = 1/(8π²σ²),

    |P|²/A = |Σ_l A_l exp(−|s d − f_l|²/4W)|²/(2πW).

Where normals tilt or the light has a size, what is seen comes from many windows, each with a tilt
of its own and anywhere on the patch. On average over their places lines do not interfere: with the
lobe's covariance C_f (`HeightFieldOptics.covariance`)

    |P|²/A = Σ_l |A_l|² N(s d − f_l; C_f).

The two differ where lobes overlap: for patches longer than the window is wide. Lines beyond the
samples' Nyquist frequency count as dark.

Each point (s d, kw) needs amplitudes at a kw of its own. exp(ikwh) is an entire function of kw of
exponential type: over an interval in which kw Δ/2 changes by 2z, interpolation between Chebyshev
nodes converges as the tail of the Bessel functions J_n(z): z + 22 nodes leave 1e-12 for z up to 10,
z + 33 for z up to 40. That is exact arithmetic for all purposes here, not a table.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import scipy.fft
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike, NDArray

from precompute.gratings import Light
from precompute.height_fields.expansion import terms_needed
from precompute.height_fields.field import HeightField
from precompute.height_fields.optics import HeightFieldOptics
from precompute.spectra import WAVELENGTH_STEP, WAVELENGTHS, colour_weights, tint_basis

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
Index = NDArray[np.intp]

EXPONENT_CUT = 20.0
"""Gaussian weights below e^−20 = 2e-9 are left out: of amplitudes, so 4e-18 of intensities; of one
of the two Gaussians that make up a blurred lobe, so e^−40 of the lobe."""

AMPLITUDE_ERROR = 1e-12
"""Largest error of an amplitude, or of a product of two, interpolated in kw."""

BAND_RATIO = 1.3
"""Of the ends of the bands of kw in which points are taken: within one, lobes are about as wide."""

BLUR_NODES = 8
"""Chebyshev nodes beyond those for the amplitudes, for a lobe's width: it is analytic in kw but for
kw = 0, seven and a half half-widths of a band away from its middle, so that its share of the error
falls by a factor 15 a node once it falls."""

PIECE = 2**18
"""Multiplications of one matrix product: OpenBLAS spreads larger ones over threads, which at these
sizes wait for one another ten times longer than they work if the processors are busy."""

SPACING = 1 / 1.8
"""Step of the grid of a blurred lobe, in its deviations: see `_blurred_density`."""


def line_amplitudes(field: HeightField, kw: float) -> ComplexArray:
    """A_jl(kw) of all lines that the samples resolve.

    Args:
        field: The relief.
        kw: 2πw/λ, 1/µm.

    Returns:
        Shape of the heights; line (j, l) at ``[l, j]``, negative ones from the end.
    """
    return np.asarray(scipy.fft.ifft2(np.exp(1j * kw * field.heights), workers=-1))


def spectral_brdf(
    field: HeightField,
    optics: HeightFieldOptics,
    wi: Array,
    wo: Array,
    wavelength: ArrayLike,
    angular_radius: float = 0.0,
) -> Array:
    """f_r(ω_i, ω_o, λ) of a height field behind a Gaussian coherence window.

    Args:
        field: The relief.
        optics: Material, coherence, roughness and normalisation.
        wi: ω_i, shape (n, 3).
        wo: ω_o, shape (n, 3).
        wavelength: λ, µm, shape (n,): one wavelength a row.
        angular_radius: α, standard deviation of the source, rad.

    Returns:
        Shape (n,), 1/sr (relative: 1); zero where either direction is below the horizon.
    """
    λ = np.asarray(wavelength, dtype=np.float64)
    result = np.zeros(len(λ))
    rows = np.flatnonzero((wi[:, 2] > 0) & (wo[:, 2] > 0))
    i, o, λ = wi[rows], wo[rows], λ[rows]
    d, w = (i + o)[:, :2], i[:, 2] + o[:, 2]
    kw, at = 2 * np.pi * w / λ, d / λ[:, None]
    covariance = optics.covariance(i, o, λ, angular_radius)
    is_blurred = optics.roughness > 0 or angular_radius > 0
    density = np.zeros(len(rows))
    for band in _bands(kw):
        points = _Points(kw[band], at[band], covariance[:, band])
        if is_blurred:
            # (kw/2π)² times this is the least that blur adds to the covariance along any axis.
            least = np.min((i[band, 2] / w[band]) ** 2)
            blur = optics.roughness**2 + angular_radius**2 * float(least)
            density[band] = _blurred_density(field, optics.window_variance, blur, points)
        else:
            density[band] = _sharp_density(field, optics.window_variance, points)
    result[rows] = optics.scale(i, o, λ) * density
    return result


def colour_brdf(
    field: HeightField, optics: HeightFieldOptics, wi: Array, wo: Array, light: Light
) -> Array:
    """∫ S(λ) (x̄, ȳ, z̄)(λ) f_r(ω_i, ω_o, λ) dλ by 1 nm, S scaled so that a mirror has Y = 1.

    Args:
        field: The relief.
        optics: Material, coherence, roughness and normalisation.
        wi: ω_i, shape (n, 3).
        wo: ω_o, shape (n, 3).
        light: The light; its tint multiplies its spectrum through `tint_basis`.

    Returns:
        XYZ, 1/sr (relative: 1), shape (n, 3).
    """
    spectrum = tint_basis() @ np.asarray(light.tint)
    weights = spectrum[:, None] * colour_weights(light.observer, light.illuminant)
    result = np.zeros((len(wi), 3))
    for start in range(0, len(wi), 8192):
        rows = slice(start, start + 8192)
        count = len(wi[rows])
        f = spectral_brdf(
            field,
            optics,
            np.repeat(wi[rows], len(WAVELENGTHS), axis=0),
            np.repeat(wo[rows], len(WAVELENGTHS), axis=0),
            np.tile(WAVELENGTHS, count),
            light.angular_radius,
        )
        result[rows] = WAVELENGTH_STEP * f.reshape(count, -1) @ weights
    return result


@dataclass(frozen=True)
class _Points:
    """Where |P|²/A is asked for.

    Attributes:
        kw: 2πw/λ, 1/µm, shape (n,).
        at: s d, 1/µm, shape (n, 2).
        covariance: C_f, 1/µm², (xx, yy, xy), shape (3, n).
    """

    kw: Array
    at: Array
    covariance: Array


def _bands(kw: Array) -> Iterator[Index]:
    """Rows by bands of kw whose ends have at most the ratio `BAND_RATIO`."""
    if len(kw) == 0:
        return
    band = np.floor(np.log(kw / kw.min()) / np.log(BAND_RATIO)).astype(int)
    yield from _groups(band)


def _groups(labels: NDArray[np.int_]) -> Iterator[Index]:
    """Rows of each label."""
    order = np.argsort(labels, kind="stable")
    ends = np.flatnonzero(np.diff(labels[order])) + 1
    yield from np.split(order, ends)


class _Interpolation:
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
        """What multiplies the values at the nodes, shape (len(kw), nodes)."""
        x = (kw - self.middle) / self.half
        return chebyshev.chebvander(x, len(self.nodes) - 1) @ self._coefficients


class _Lines:
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
        self.amplitudes = np.stack([line_amplitudes(about, q)[np.ix_(l, j)] for q in kw])


def _nodes(field: HeightField, kw: Array, factors: int) -> int:
    """Chebyshev nodes for products of so many amplitudes over the range of kw."""
    z = factors * field.amplitude * float(np.ptp(kw)) / 2
    return 1 + terms_needed("jacobi-anger", z, AMPLITUDE_ERROR)


def _sharp_density(field: HeightField, window_variance: float, points: _Points) -> Array:
    """|P|²/A without blur, µm²: the squared sum of the amplitudes near s d."""
    over = _Interpolation(points.kw, _nodes(field, points.kw, 1))
    amplitude_variance = 2 * window_variance
    radius = np.sqrt(2 * EXPONENT_CUT * amplitude_variance)
    lines = _Lines(field, over.nodes, np.abs(points.at).max(axis=0) + radius)
    total = np.zeros(len(points.kw), dtype=np.complex128)
    for tile in _tiles(points.at, lines.step, np.full(2, radius)):
        columns, rows = (
            slice(max(first + n, 0), max(first + n + count, 0))
            for first, count, n in zip(tile.first, tile.count, lines.limit, strict=True)
        )
        values = lines.amplitudes[:, rows, columns]
        if values.size == 0:
            continue
        fx, fy = (
            (np.arange(s.start, s.start + size) - n) * step
            for s, size, n, step in zip(
                (columns, rows), values.shape[:0:-1], lines.limit, lines.step, strict=True
            )
        )
        for part in tile.parts(values[0].size):
            # As real numbers: the real and the imaginary part of a line side by side.
            table = values.reshape(len(over.nodes), -1).view(np.float64)
            amplitudes = _product(over.weights(points.kw[part]), table).view(np.complex128)
            dx, dy = points.at[part, 0, None] - fx, points.at[part, 1, None] - fy
            weights = np.exp(-(dx**2)[:, None, :] / (2 * amplitude_variance)) * np.exp(
                -(dy**2)[:, :, None] / (2 * amplitude_variance)
            )
            total[part] = np.einsum("nk,nk->n", amplitudes, weights.reshape(len(part), -1))
    return np.abs(total) ** 2 / (2 * np.pi * window_variance)


def _blurred_density(
    field: HeightField, window_variance: float, blur: float, points: _Points
) -> Array:
    """|P|²/A with blur, µm².

    A lobe is the convolution of two Gaussians, N(·; ½C_0) and N(·; C_f − ½C_0), where C_0(kw) =
    W + (kw/2π)² · `blur` is no wider than C_f; so the lobes are spread to a grid of step H by the
    first, at each node of kw, and gathered from there by the second:

        |P|²/A = Σ_g D_g N(s d − g; C_f − ½C_0),    D_g = H² Σ_l |A_l|² N(g − f_l; ½C_0).

    As a trapezoidal rule over a Gaussian of variance ¼C_0 or more, it changes each lobe everywhere
    by the same share of itself, at most 4 exp(−½π²C_0/H²), 5e-7 for H = `SPACING`·√C_0.
    """
    over = _Interpolation(points.kw, _nodes(field, points.kw, 2) + BLUR_NODES)
    c0 = window_variance + (over.nodes / (2 * np.pi)) ** 2 * blur
    step = np.full(2, SPACING * np.sqrt(c0.min()))
    half = (window_variance + (points.kw / (2 * np.pi)) ** 2 * blur) / 2
    rest = points.covariance - np.stack([half, half, np.zeros_like(half)])
    radius = np.sqrt(2 * EXPONENT_CUT * rest[:2].max(axis=1))
    spread = np.sqrt(2 * EXPONENT_CUT * c0.max() / 2)
    reach = np.abs(points.at).max(axis=0) + radius + spread
    lines = _Lines(field, over.nodes, reach)
    powers = np.abs(lines.amplitudes) ** 2
    fx, fy = (np.arange(-n, n + 1) * h for n, h in zip(lines.limit, lines.step, strict=True))

    determinant = rest[0] * rest[1] - rest[2] ** 2
    xx, yy, xy = rest[1] / determinant, rest[0] / determinant, -rest[2] / determinant
    total = np.zeros(len(points.kw))
    for tile in _tiles(points.at, step, radius):
        gx, gy = (
            h * (first + np.arange(count))
            for h, first, count in zip(step, tile.first, tile.count, strict=True)
        )
        columns, rows = (
            slice(*np.searchsorted(f, (g[0] - spread, g[-1] + spread)))
            for f, g in zip((fx, fy), (gx, gy), strict=True)
        )
        if columns.start == columns.stop or rows.start == rows.stop:
            continue
        to_x = _gaussians(gx, fx[columns], c0 / 2)
        to_y = _gaussians(gy, fy[rows], c0 / 2)
        grid = to_y @ powers[:, rows, columns] @ to_x.transpose(0, 2, 1) * step[0] * step[1]
        grid = grid.reshape(len(over.nodes), -1)
        for part in tile.parts(grid.shape[1]):
            dx = (points.at[part, 0, None] - gx)[:, None, :]
            dy = (points.at[part, 1, None] - gy)[:, :, None]
            q_xx, q_yy, q_xy = (q[part, None, None] for q in (xx, yy, xy))
            exponent = q_xx * dx**2 / 2 + q_yy * dy**2 / 2 + q_xy * dx * dy
            weights = np.exp(-exponent).reshape(len(part), -1)
            values_at = _product(over.weights(points.kw[part]), grid)
            total[part] = np.einsum("nk,nk->n", values_at, weights)
    return total / (2 * np.pi * np.sqrt(determinant))


def _product(one: Array, other: Array) -> Array:
    """The matrix product, a few rows at a time."""
    result = np.empty((len(one), other.shape[1]))
    rows = max(1, PIECE // other.size)
    for k in range(0, len(one), rows):
        np.matmul(one[k : k + rows], other, out=result[k : k + rows])
    return result


def _gaussians(to: Array, of: Array, variance: Array) -> Array:
    """One-dimensional normal densities, shape (len(variance), len(to), len(of))."""
    v = variance[:, None, None]
    return np.exp(-((to[:, None] - of) ** 2) / (2 * v)) / np.sqrt(2 * np.pi * v)


@dataclass(frozen=True)
class _Tile:
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


def _tiles(at: Array, step: Array, radius: Array) -> Iterator[_Tile]:
    """Points by tiles of a lattice, each about as large as the reach, so that few nodes are vain.

    Args:
        at: Positions, shape (n, 2).
        step: Of the lattice, whose nodes are its multiples, along x and y.
        radius: Farthest node that counts, along x and y.
    """
    reach = np.floor(radius / step + 0.5).astype(int)
    side = np.maximum(reach // 2, 1)
    tile = np.floor_divide(np.rint(at / step).astype(int), side)
    low = tile.min(axis=0)
    across = tile[:, 0].max() - low[0] + 1
    for rows in _groups((tile[:, 1] - low[1]) * across + tile[:, 0] - low[0]):
        first = tile[rows[0]] * side - reach
        count = side + 2 * reach
        yield _Tile(rows, (int(first[0]), int(first[1])), (int(count[0]), int(count[1])))
