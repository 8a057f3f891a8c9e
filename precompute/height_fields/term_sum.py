"""The series methods in numpy: what shaders/height-field.glsl sums, from the same map.

For asking `taylor` and `jacobi-anger` directly, without a browser. It shares the map with the
shader and nothing with `precompute.height_fields.reference` but the material.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from precompute.closed_form import uniform_nodes
from precompute.gratings import Light
from precompute.height_fields.optics import HeightFieldOptics
from precompute.height_fields.window import BlurredLobes, CutWindow
from precompute.lobes import EXPONENT_CUT, lobes_map
from precompute.maps import Map, Table
from precompute.recipes import LobesRecipe
from precompute.spectra import WAVELENGTH_MAX, WAVELENGTH_MIN

Array = NDArray[np.float64]
Index = NDArray[np.intp]

CUT_TAIL = 0.005
"""Share of its peak below which a line's amplitude behind a cut window is left out, but for order
0."""


def interpolated_coefficients(table: Table, x: ArrayLike) -> NDArray[np.float32]:
    """c_n(x) from their table, in float32: linear between texels, held at the ends.

    Args:
        table: The array ``coefficients`` of a map of kind ``height-field-terms``.
        x: Phase, rad, shape (n,).

    Returns:
        No unit, shape (terms, n).
    """
    _, axis = table.axes
    texel = axis.texel_from_parameter(x)
    below = np.minimum(texel.astype(int), axis.size - 2)
    share = texel - below
    values = table.values[..., 0]
    return ((1 - share) * values[:, below] + share * values[:, below + 1]).astype(np.float32)


def even_and_odd_sums(
    terms: NDArray[np.floating], coefficients: NDArray[np.float32]
) -> tuple[NDArray[np.complex64], NDArray[np.complex64]]:
    """Σ c_n G_n over even n and over odd n, in float32, in the order of the terms.

    A_jl of a line in the stored half of the plane is their sum; that of the line opposite is the
    conjugate of their difference.

    Args:
        terms: Of a map's array ``terms``, shape (pairs, lines…, 4).
        coefficients: c_n, shape (terms, …), broadcast against the lines.

    Returns:
        Two arrays of the broadcast shape, no unit.
    """
    shape = np.broadcast_shapes(terms.shape[1:-1], coefficients.shape[1:])
    sums = np.zeros((2, *shape), np.complex64)
    for n, texels in enumerate(terms):
        both = np.ascontiguousarray(texels, np.float32).view(np.complex64)
        for total, c, g in zip(sums, coefficients[2 * n : 2 * n + 2], (0, 1), strict=False):
            total += c * both[..., g]
    return sums[0], sums[1]


class TermsMethod:
    """A point or directional light on a height field, summed over wavelengths, lines and terms.

    Args:
        terms: A map of kind ``height-field-terms``.
        optics: Material, coherence, roughness and normalisation.
        step: Between wavelengths, µm.
    """

    def __init__(self, terms: Map, optics: HeightFieldOptics, step: float = 0.005) -> None:
        self.optics = optics
        self.wavelengths = round((WAVELENGTH_MAX - WAVELENGTH_MIN) / step) + 1
        self.terms, self.coefficients = terms.tables["terms"], terms.tables["coefficients"]
        _, along_y, along_x = self.terms.axes
        self.limit = np.array([along_x.last, along_y.last], dtype=int)
        constants = {name: np.ravel(value)[0] for name, value in terms.constants.items()}
        self.period = np.array([constants["period_x"], constants["period_y"]])
        self.sides = (float(self.period[0]), float(self.period[1]))
        self.length = constants["amplitude"]

    def line_amplitude(self, line: Index, kw: Array) -> NDArray[np.complex64]:
        """A_jl(kw), but for a phase that all lines share; zero for a line beyond the table.

        Args:
            line: (j, l), shape (n, 2).
            kw: 2πw/λ, 1/µm, shape (n,).

        Returns:
            No unit, shape (n,).
        """
        result = np.zeros(len(line), np.complex64)
        known = np.flatnonzero((np.abs(line) <= self.limit).all(axis=1))
        j, l = line[known].T  # noqa: E741
        mirrored = j < 0
        sign = np.where(mirrored, -1, 1)
        stored = self.terms.values[:, sign * l + self.limit[1], sign * j]
        c = interpolated_coefficients(self.coefficients, kw[known] * self.length)
        even, odd = even_and_odd_sums(stored, c)
        result[known] = np.where(mirrored, np.conj(even - odd), even + odd)
        return result

    def colour_brdf(self, wi: Array, wo: Array, light: Light) -> Array:
        """∫ S (x̄, ȳ, z̄) f_r dλ, XYZ in 1/sr (relative: 1), shape (n, 3).

        Args:
            wi: ω_i, shape (n, 3).
            wo: ω_o, shape (n, 3).
            light: The light.
        """
        recipe = LobesRecipe.model_construct(
            kind="lobes",
            illuminant=light.illuminant,
            observer=light.observer,
            wavenumbers=8,
            widths=4,
        )
        weights = lobes_map(recipe, Path()).tables["weights"]
        result = np.zeros((len(wi), 3))
        rows = np.flatnonzero((wi[:, 2] > 0) & (wo[:, 2] > 0))
        i, o = wi[rows], wo[rows]
        for node in uniform_nodes(weights, np.asarray(light.tint), self.wavelengths):
            λ = np.full(len(rows), node.wavelength)
            density_of = self._density if self.optics.tiles is None else self._density_of_repeats
            density = density_of(i, o, λ, light.angular_radius)
            scale = self.optics.scale(i, o, λ, self.sides)
            result[rows] += node.xyz * (scale * density)[:, None]
        return result

    def _density(self, wi: Array, wo: Array, λ: Array, angular_radius: float) -> Array:
        """|P|²/A, µm²: amplitudes of the lines near s d are added, or, blurred, their powers."""
        is_blurred = angular_radius > 0 or self.optics.roughness > 0
        xx, yy, xy = self.optics.covariance(wi, wo, λ, angular_radius)
        determinant = xx * yy - xy**2
        centre = (wi + wo)[:, :2] / λ[:, None]
        kw = 2 * np.pi * (wi[:, 2] + wo[:, 2]) / λ
        reach = np.sqrt(2 * EXPONENT_CUT * np.stack([xx, yy], axis=1))
        first = np.ceil((centre - reach) * self.period).astype(int)
        count = np.floor((centre + reach) * self.period).astype(int) - first + 1
        amplitude = np.zeros(len(λ), np.complex64)
        power = np.zeros(len(λ))
        for n in range(count[:, 1].max(initial=0)):
            for m in range(count[:, 0].max(initial=0)):
                near = np.flatnonzero((m < count[:, 0]) & (n < count[:, 1]))
                line = first[near] + np.array([m, n])
                x, y = (centre[near] - line / self.period).T
                exponent = yy[near] * x**2 - 2 * xy[near] * x * y + xx[near] * y**2
                exponent /= 2 * determinant[near]
                found = self.line_amplitude(line, kw[near])
                if is_blurred:
                    power[near] += np.exp(-exponent) * np.abs(found) ** 2
                else:
                    amplitude[near] += np.exp(-exponent / 2) * found
        if not is_blurred:
            power = np.abs(amplitude).astype(np.float64) ** 2
        return power / (2 * np.pi * np.sqrt(determinant))

    def _density_of_repeats(self, wi: Array, wo: Array, λ: Array, angular_radius: float) -> Array:
        """|P|²/A behind a cut window, µm²; a blur askew to the axes shears lobes, but no tails."""
        tiles, windows = self.optics.tiles, self.optics.cut_windows(self.sides)
        assert tiles is not None and windows is not None
        is_blurred = angular_radius > 0 or self.optics.roughness > 0
        xx, yy, xy = self.optics.covariance(wi, wo, λ, angular_radius)
        cut = np.array([[window.variance - self.optics.window_variance] for window in windows])
        shear = xy / (xx + cut[0])
        variance = np.stack([xx, yy - shear * xy]) + cut
        lobes = [window.amplitude for window in windows]
        if is_blurred:
            widths = np.sqrt(variance - [[window.variance] for window in windows])
            farthest = 2 / λ.min() + self.limit / self.period
            lobes = [
                _blurred_amplitudes(window, b, float(f))
                for window, b, f in zip(windows, widths, farthest, strict=True)
            ]
        centre = (wi + wo)[:, :2].T / λ
        kw = 2 * np.pi * (wi[:, 2] + wo[:, 2]) / λ
        least = CUT_TAIL / np.sqrt(2 * np.pi * np.sqrt(variance[0] * variance[1]))
        amplitude = np.zeros(len(λ), np.complex64)
        power = np.zeros(len(λ))
        for j in range(-self.limit[0], self.limit[0] + 1):
            fx = centre[0] - j / self.period[0]
            x = lobes[0](fx)
            core = 4 * variance[0]
            middle = centre[1] - shear * fx * core / np.maximum(fx**2, core)
            for l in range(-self.limit[1], self.limit[1] + 1):  # noqa: E741
                lobe = x * lobes[1](middle - l / self.period[1])
                near = np.flatnonzero((np.abs(lobe) >= least) | (j == 0 and l == 0))
                line = np.tile([j, l], (len(near), 1))
                found = lobe[near] * self.line_amplitude(line, kw[near])
                if is_blurred:
                    power[near] += np.abs(found) ** 2
                else:
                    # The window's middle stands half as many patches from the first sample.
                    amplitude[near] += (1 - 2 * (np.dot([j, l], tiles) % 2)) * found
        return power if is_blurred else np.abs(amplitude).astype(np.float64) ** 2


def _blurred_amplitudes(
    window: CutWindow, width: Array, farthest: float
) -> Callable[[Array], Array]:
    """Roots of the window's powers, blurred by a width for each point."""
    powers = BlurredLobes(window, (float(width.min()), float(width.max())), farthest)
    return lambda f: np.sqrt(np.maximum(powers(f, width), 0))
