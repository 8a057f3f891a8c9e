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

A window cut to some repeats of the patch has other lobes: `precompute.height_fields.repeats`.

Each point (s d, kw) needs amplitudes at a kw of its own: `precompute.height_fields.lines`.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike, NDArray

from precompute.gratings import Light
from precompute.height_fields.field import HeightField
from precompute.height_fields.lines import (
    EXPONENT_CUT,
    Index,
    Interpolation,
    Lines,
    Points,
    groups,
    nodes_needed,
    product,
    sum_over_lines,
    tiles_of,
)
from precompute.height_fields.optics import HeightFieldOptics
from precompute.height_fields.repeats import (
    SplitBlur,
    blurred_density_of_repeats,
    density_of_repeats,
)
from precompute.spectra import WAVELENGTH_STEP, WAVELENGTHS, colour_weights, tint_basis

Array = NDArray[np.float64]

BAND_RATIO = 1.3
"""Of the ends of the bands of kw in which points are taken: within one, lobes are about as wide."""

BLUR_NODES = 8
"""Chebyshev nodes beyond those for the amplitudes, for a lobe's width: it is analytic in kw but for
kw = 0, seven and a half half-widths of a band away from its middle, so that its share of the error
falls by a factor 15 a node once it falls."""

SPACING = 1 / 1.8
"""Step of the grid of a blurred lobe, in its deviations: see `_blurred_density`."""


def spectral_brdf(
    field: HeightField,
    optics: HeightFieldOptics,
    wi: Array,
    wo: Array,
    wavelength: ArrayLike,
    angular_radius: float = 0.0,
) -> Array:
    """f_r(ω_i, ω_o, λ) of a height field behind a coherence window.

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
    windows = optics.cut_windows(field.period)
    density = np.zeros(len(rows))
    for band in _bands(kw):
        points = Points(kw[band], at[band], covariance[:, band])
        if windows is not None and is_blurred:
            blur = SplitBlur.of(optics, i[band], o[band], λ[band], angular_radius)
            density[band] = blurred_density_of_repeats(field, windows, blur, points)
        elif windows is not None:
            assert optics.tiles is not None
            density[band] = density_of_repeats(field, optics.tiles, windows, points)
        elif is_blurred:
            # (kw/2π)² times this is the least that blur adds to the covariance along any axis.
            least = np.min((i[band, 2] / w[band]) ** 2)
            blur = optics.roughness**2 + angular_radius**2 * float(least)
            density[band] = _blurred_density(field, optics.window_variance, blur, points)
        else:
            density[band] = _sharp_density(field, optics.window_variance, points)
    result[rows] = optics.scale(i, o, λ, field.period) * density
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


def _bands(kw: Array) -> Iterator[Index]:
    """Rows by bands of kw whose ends have at most the ratio `BAND_RATIO`."""
    if len(kw) == 0:
        return
    band = np.floor(np.log(kw / kw.min()) / np.log(BAND_RATIO)).astype(int)
    yield from groups(band)


def _sharp_density(field: HeightField, window_variance: float, points: Points) -> Array:
    """|P|²/A without blur, µm²: the squared sum of the amplitudes near s d."""
    over = Interpolation(points.kw, nodes_needed(field, points.kw, 1))
    amplitude_variance = 2 * window_variance
    radius = np.full(2, np.sqrt(2 * EXPONENT_CUT * amplitude_variance))
    lines = Lines(field, over.nodes, np.abs(points.at).max(axis=0) + radius)

    def lobes(_: Index, dx: Array, dy: Array) -> Array:
        x, y = (np.exp(-(d**2) / (2 * amplitude_variance)) for d in (dx, dy))
        return y[:, :, None] * x[:, None, :]

    total = sum_over_lines(points, lines, over, lines.amplitudes, radius, lobes)
    return np.abs(total) ** 2 / (2 * np.pi * window_variance)


def _blurred_density(
    field: HeightField, window_variance: float, blur: float, points: Points
) -> Array:
    """|P|²/A with blur, µm².

    A lobe is the convolution of two Gaussians, N(·; ½C_0) and N(·; C_f − ½C_0), where C_0(kw) =
    W + (kw/2π)² · `blur` is no wider than C_f; so the lobes are spread to a grid of step H by the
    first, at each node of kw, and gathered from there by the second:

        |P|²/A = Σ_g D_g N(s d − g; C_f − ½C_0),    D_g = H² Σ_l |A_l|² N(g − f_l; ½C_0).

    As a trapezoidal rule over a Gaussian of variance ¼C_0 or more, it changes each lobe everywhere
    by the same share of itself, at most 4 exp(−½π²C_0/H²), 5e-7 for H = `SPACING`·√C_0.
    """
    over = Interpolation(points.kw, nodes_needed(field, points.kw, 2) + BLUR_NODES)
    c0 = window_variance + (over.nodes / (2 * np.pi)) ** 2 * blur
    step = np.full(2, SPACING * np.sqrt(c0.min()))
    half = (window_variance + (points.kw / (2 * np.pi)) ** 2 * blur) / 2
    rest = points.covariance - np.stack([half, half, np.zeros_like(half)])
    radius = np.sqrt(2 * EXPONENT_CUT * rest[:2].max(axis=1))
    spread = np.sqrt(2 * EXPONENT_CUT * c0.max() / 2)
    reach = np.abs(points.at).max(axis=0) + radius + spread
    lines = Lines(field, over.nodes, reach)
    powers = np.abs(lines.amplitudes) ** 2
    fx, fy = (np.arange(-n, n + 1) * h for n, h in zip(lines.limit, lines.step, strict=True))

    determinant = rest[0] * rest[1] - rest[2] ** 2
    xx, yy, xy = rest[1] / determinant, rest[0] / determinant, -rest[2] / determinant
    total = np.zeros(len(points.kw))
    for tile in tiles_of(points.at, step, radius):
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
            values_at = product(over.weights(points.kw[part]), grid)
            total[part] = np.einsum("nk,nk->n", values_at, weights)
    return total / (2 * np.pi * np.sqrt(determinant))


def _gaussians(to: Array, of: Array, variance: Array) -> Array:
    """One-dimensional normal densities, shape (len(variance), len(to), len(of))."""
    v = variance[:, None, None]
    return np.exp(-((to[:, None] - of) ** 2) / (2 * v)) / np.sqrt(2 * np.pi * v)
