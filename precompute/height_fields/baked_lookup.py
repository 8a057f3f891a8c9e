"""The baked colour of a height field in numpy: what the shader computes, from the same tables.

With d = (u, v) = (ω_i + ω_o)_xy, w = (ω_i + ω_o)_z and g = 1 + ω_i·ω_o,

    f_r = g²/max(cosθ_i cosθ_o w², 1e-6) · max(0, Σ_r ψ_r(w) B_r(u, v) + E(r, w)/(2π √det C))

in XYZ, each channel for itself. The last term is order 0, C the covariance of
docs/theory/gratings.md at the longest wavelength, and r² = dᵀC⁻¹d.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from precompute.errors import InputError
from precompute.gratings import Light
from precompute.height_fields.recipe import HeightFieldRecipe
from precompute.height_fields.splines import Degree, evaluated
from precompute.maps import Map, Table
from precompute.spectra import WAVELENGTH_MAX, Observer, xyz_to_linear_srgb

Array = NDArray[np.float64]

OBSERVER: Observer = "1931-2"
"""Whose colours are baked."""

ALONG_U: Degree = 1
ALONG_V: Degree = 3
"""Degrees of the modes' splines."""

FLOOR = 1e-6
"""Of cosθ_i cosθ_o w², as in the shaders' Kirchhoff factor."""


class BakedLookup:
    """A height field whose colour is looked up in its baked map.

    Args:
        baked: The map of kind ``height-field-baked``, as baked or as read.
    """

    def __init__(self, baked: Map) -> None:
        stored = {key: _as_stored(table) for key, table in baked.tables.items()}
        self.modes, self.weights = stored["modes"], stored["weights"]
        self.coherent = stored["coherent"]
        self.recipe = HeightFieldRecipe.model_validate(baked.recipe)
        self.window = 1 / (8 * np.pi**2 * self.recipe.coherence**2)

    def colour_brdf(self, wi: Array, wo: Array, light: Light) -> Array:
        """∫ S (x̄, ȳ, z̄) f_r dλ, XYZ in 1/sr, shape (n, 3), for directions of shape (n, 3).

        The light's spectrum is baked in, so that a tint multiplies the colour in linear sRGB: exact
        for greys.

        Args:
            wi: ω_i, shape (n, 3), above the horizon.
            wo: ω_o, shape (n, 3), above the horizon.
            light: Whose spectrum and size were baked in.


        Raises:
            InputError: The map was baked for another light or observer.
        """
        self._check(light)
        result = np.zeros((len(wi), 3))
        rows = np.flatnonzero((wi[:, 2] > 0) & (wo[:, 2] > 0))
        i, o = wi[rows], wo[rows]
        u, v, w = (i + o).T
        g = 1 + np.sum(i * o, axis=1)
        factor = g**2 / np.maximum(i[:, 2] * o[:, 2] * w**2, FLOOR)
        # Splines ring by some thousandths, which the factor blows up where directions graze.
        xyz = np.maximum(self.pattern(u, v, w) + self.order_0(i, o), 0)
        to_rgb = xyz_to_linear_srgb(OBSERVER, light.illuminant)
        tint = np.linalg.solve(to_rgb, np.diag(light.tint) @ to_rgb)
        result[rows] = factor[:, None] * (xyz @ tint.T)
        return result

    def pattern(self, u: Array, v: Array, w: Array) -> Array:
        """I(u, v, w) without order 0, XYZ, shape (n, 3), zero beyond the table.

        A shader reads each layer's splines by two bilinear lookups.
        """
        _, v_axis, u_axis = self.modes.axes
        inside = (np.abs(u) <= u_axis.last) & (np.abs(v) <= v_axis.last)
        at = v_axis.texel_from_parameter(v), u_axis.texel_from_parameter(u)
        result = np.zeros((len(u), 3))
        for number, layer in enumerate(self.modes.values):
            group, colour = divmod(number, 3)
            ψ = self.weights.sample(np.full(len(w), float(group)), w)
            texel = evaluated(layer, *at)
            result += ψ[:, colour, None] * texel[:, :3]
            # The last channels of a group's layers are X, Y, Z of its fourth mode.
            result[:, colour] += ψ[:, 3] * texel[:, 3]
        return np.where(inside[:, None], result, 0)

    def order_0(self, wi: Array, wo: Array) -> Array:
        """The coherent mean, XYZ, shape (n, 3); zero beyond the table.

        Args:
            wi: ω_i, shape (n, 3), above the horizon.
            wo: ω_o, shape (n, 3), above the horizon.
        """
        x, y, _ = wi.T
        u, v, w = (wi + wo).T
        source = self.recipe.angular_radius**2
        same = WAVELENGTH_MAX**2 * self.window + (w * self.recipe.roughness) ** 2
        c_uu, c_vv, c_uv = same + source * (1 - x**2), same + source * (1 - y**2), -source * x * y
        determinant = c_uu * c_vv - c_uv**2
        r = np.sqrt((c_vv * u**2 - 2 * c_uv * u * v + c_uu * v**2) / determinant)
        lobe = self.coherent.sample(r, w)[:, :3] / (2 * np.pi * np.sqrt(determinant))[:, None]
        return np.where((r <= self.coherent.axes[0].last)[:, None], lobe, 0)

    def _check(self, light: Light) -> None:
        recipe = self.recipe
        asked = {
            "illuminant": (Path(light.illuminant).name, Path(recipe.illuminant).name),
            "angular_radius": (light.angular_radius, recipe.angular_radius),
            "observer": (light.observer, OBSERVER),
        }
        for name, (found, baked) in asked.items():
            if found != baked:
                raise InputError("light", name, found, f"{baked}, which is baked in")


def _as_stored(table: Table) -> Table:
    values = table.values.astype(table.dtype).astype(np.float64)
    return Table(values, table.axes, table.channels, table.dtype)
