"""The shipped method in numpy: what shaders/grating.glsl computes, from the same tables.

For asking the method directly, without a browser, and for finding where it departs from the
reference. It shares the tables with the shaders and nothing with `precompute.reference`.
"""

from __future__ import annotations

import functools
import itertools
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from precompute.efficiencies import profile_map
from precompute.errors import InputError
from precompute.gratings import Grating, Light
from precompute.lobes import (
    BAND_DEVIATION,
    EXPONENT_CUT,
    WAVENUMBER_MAX,
    WAVENUMBER_MIN,
    WIDE_LOBE_NODES,
    WIDTH_MAX,
    WIDTH_MIN,
    lobe_position,
    lobes_map,
)
from precompute.maps import Table
from precompute.recipes import LobesRecipe, ProfileRecipe
from precompute.spectra import Observer, metal_reflectance

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Node:
    """A band of the spectrum: its middle and its width, µm, and the light's XYZ in it."""

    wavelength: float
    bandwidth: float
    xyz: Array


class ClosedForm:
    """Point and directional light on a grating, in closed form over wavelength.

    Args:
        grating: The grating.
        light: The light.

    Raises:
        InputError: The relief is higher than its profile's table covers, or the light is unknown.
    """

    def __init__(self, grating: Grating, light: Light) -> None:
        self.grating = grating
        self.light = light
        recipe = ProfileRecipe(kind="profile", profile=grating.profile)
        highest = recipe.max_phase * WAVENUMBER_MAX**-1 / (4 * np.pi)
        if grating.height > highest:
            raise InputError("grating", "height", grating.height, f"at most {highest:.4f} um")
        self.efficiencies = _profile_tables(recipe.model_dump_json())["efficiency"]
        lobes = _lobe_tables(light.illuminant, light.observer)
        self.lobe = lobes["lobe"]
        self.weights = lobes["weights"]
        self.nodes = weighted_nodes(self.weights, np.asarray(light.tint))
        self.max_order = min(recipe.max_order, int(2 * grating.period * WAVENUMBER_MAX))
        self.window = 1 / (8 * np.pi**2 * grating.coherence**2)

    def colour_brdf(self, wi: Array, wo: Array) -> Array:
        """∫ S (x̄, ȳ, z̄) f_r dλ, XYZ in 1/sr, shape (n, 3), for directions of shape (n, 3).

        Args:
            wi: ω_i, shape (n, 3), above the horizon.
            wo: ω_o, shape (n, 3), above the horizon.
        """
        u, v, w = (wi + wo).T
        above = (wi[:, 2] > 0) & (wo[:, 2] > 0)
        widest = self.blur(wi, wo[:, 2] + 1)[1]
        near = above & (v**2 <= 2 * EXPONENT_CUT * (self.window / WAVENUMBER_MIN**2 + widest))
        wide = self.spread(w) > WIDTH_MAX * np.hypot(u, v)
        result = np.zeros((len(wi), 3))
        rows = np.flatnonzero(near & ~wide)
        for m in range(-self.max_order, self.max_order + 1):
            if m != 0:
                result[rows] += self._narrow(m, wi[rows], wo[rows])
        rows = np.flatnonzero(near & wide)
        for node in self.nodes:
            seen = self.at_node(node, wi[rows], wo[rows])
            result[rows] += node.xyz * seen[:, None]
        return result

    def blur(self, wi: Array, w: Array) -> Array:
        """Covariance (uu, vv, uv) of a lobe from tilted normals and the source.

        No unit, shape (3, n).

        Args:
            wi: ω_i, shape (n, 3), above the horizon.
            w: w = cosθ_i + cosθ_o, no unit, shape (n,).
        """
        α = self.light.angular_radius
        tilt = (w * self.grating.roughness) ** 2
        return np.stack(
            [
                tilt + α**2 * (1 - wi[:, 0] ** 2),
                tilt + α**2 * (1 - wi[:, 1] ** 2),
                -(α**2) * wi[:, 0] * wi[:, 1],
            ]
        )

    def spread(self, w: Array) -> Array:
        """The largest standard deviation of a lobe in spatial frequency, 1/µm, shape (n,).

        Args:
            w: w = cosθ_i + cosθ_o, no unit, shape (n,).
        """
        widest = (w * self.grating.roughness) ** 2 + self.light.angular_radius**2
        return np.sqrt(self.window + WAVENUMBER_MAX**2 * widest)

    def order_depth(self, wi: Array, wo: Array, offset: Array | float) -> Array:
        """w of an order at offset = mλ/a, no unit, shape (n,).

        Args:
            wi: ω_i, shape (n, 3), above the horizon.
            wo: ω_o, shape (n, 3), above the horizon.
            offset: mλ/a, no unit, shape (n,) or one for all.
        """
        if self.grating.energy != "conserving":
            return wi[:, 2] + wo[:, 2]
        return wo[:, 2] + np.sqrt(np.maximum(_squared_cosine(wo, offset), 0))

    def _narrow(self, m: int, wi: Array, wo: Array) -> Array:
        u, v, _ = (wi + wo).T
        g = m / self.grating.period
        s = np.clip(g * u / (u**2 + v**2), WAVENUMBER_MIN, WAVENUMBER_MAX)
        w = self.order_depth(wi, wo, g / s)
        c_uu, c_vv, c_uv = self.window * np.array([[1], [1], [0]]) + s**2 * self.blur(wi, w)
        determinant = c_uu * c_vv - c_uv**2
        adjugate = c_vv * u**2 - 2 * c_uv * u * v + c_uu * v**2
        q = np.sqrt(determinant / adjugate)
        middle = g * (c_vv * u - c_uv * v) / adjugate
        exponent = 0.5 * g**2 * v**2 / adjugate
        density = q * np.exp(-exponent) / np.sqrt(2 * np.pi * determinant)
        # A blurred lobe is a Gaussian in wavelength: docs/theory/lights.md.
        skew = (1 - self.window / c_uu) * q**2 / np.maximum(middle**2, 0.25)
        middle, q = middle * (1 + skew), q * (1 + 4 * skew)
        position = lobe_position(middle, q)
        seen = (position >= 0) & (position <= 1) & (exponent <= EXPONENT_CUT)
        xyz, mean = self._lobe_colour(position, np.clip(q, WIDTH_MIN, WIDTH_MAX))
        scale = np.where(seen, density, 0) * self.efficiency(m, w, mean)
        scale *= self._reflectance(mean) * self._energy_factor(wi, wo, mean, q)
        return scale[:, None] * xyz

    def at_node(self, node: Node, wi: Array, wo: Array) -> Array:
        """f_r of all orders at a node's wavelength, 1/sr, shape (n,).

        Args:
            node: One band of the spectrum.
            wi: ω_i, shape (n, 3), above the horizon.
            wo: ω_o, shape (n, 3), above the horizon.
        """
        u, v, _ = (wi + wo).T
        s = np.full(len(u), 1 / node.wavelength)
        width = s**2 * node.bandwidth * BAND_DEVIATION
        total = np.zeros(len(u))
        for m in range(-self.max_order, self.max_order + 1):
            offset = m / self.grating.period
            w = self.order_depth(wi, wo, offset / s)
            c_uu, c_vv, c_uv = self.window * np.array([[1], [1], [0]]) + s**2 * self.blur(wi, w)
            determinant = c_uu * c_vv - c_uv**2
            du, dv = s * u - offset, s * v
            exponent = (c_vv * du**2 - 2 * c_uv * du * dv + c_uu * dv**2) / (2 * determinant)
            total += np.exp(-exponent) * self.efficiency(m, w, s) / np.sqrt(determinant)
        density = s**2 * total / (2 * np.pi)
        return density * self._reflectance(s) * self._energy_factor(wi, wo, s, width)

    def _lobe_colour(self, position: Array, width: Array) -> tuple[Array, Array]:
        layers = [
            self.lobe.sample(np.full(len(width), float(i)), width, position) for i in range(3)
        ]
        white, red, green = (layer[:, :3] for layer in layers)
        moments = [layer[:, 3] * layer[:, :3].sum(axis=1) for layer in layers]
        tint = self.light.tint
        colours = (red, green, white - red - green)
        moment = (
            tint[0] * moments[1] + tint[1] * moments[2]
            + tint[2] * (moments[0] - moments[1] - moments[2])
        )  # fmt: skip
        xyz = sum(t * c for t, c in zip(tint, colours, strict=True))
        energy = np.asarray(xyz).sum(axis=1)
        lit = energy > 1e-3
        mean = np.where(lit, moment / np.where(lit, energy, 1), layers[0][:, 3])
        return np.asarray(xyz), np.clip(mean, WAVENUMBER_MIN, WAVENUMBER_MAX)

    def efficiency(self, m: int, w: Array, wavenumber: Array) -> Array:
        """η_m at w = cosθ_i + cosθ_o and at a wavenumber in 1/µm, from the profile's table.

        Args:
            m: The order.
            w: w = cosθ_i + cosθ_o, no unit, shape (n,).
            wavenumber: 1/λ, 1/µm, shape (n,).
        """
        φ = 2 * np.pi * w * self.grating.height * wavenumber
        return self.efficiencies.sample(np.full(φ.shape, float(m)), φ)[..., 0]

    def _reflectance(self, wavenumber: Array) -> Array:
        if self.grating.metal is None:
            return np.ones_like(wavenumber)
        return metal_reflectance(self.grating.metal, 1 / wavenumber)

    def _energy_factor(self, wi: Array, wo: Array, wavenumber: Array, width: Array) -> Array:
        if self.grating.energy == "kirchhoff":
            w = wi[:, 2] + wo[:, 2]
            return (1 + np.sum(wi * wo, axis=1)) ** 2 / np.maximum(wi[:, 2] * wo[:, 2] * w**2, 1e-6)
        factor = self._reciprocal_efficiency(wo, wavenumber, width)
        if self.grating.energy == "reciprocal":
            factor = np.minimum(factor, self._reciprocal_efficiency(wi, wavenumber, width))
        return factor

    def _reciprocal_efficiency(self, direction: Array, wavenumber: Array, width: Array) -> Array:
        """The mean of 1/N(ω, s) at one standard deviation to either side of a lobe's mean."""
        total = np.zeros((2, len(direction)))
        window = self.window / wavenumber**2
        for m in range(-self.max_order, self.max_order + 1):
            offset = m / (self.grating.period * wavenumber)
            squared_cosine = _squared_cosine(direction, offset)
            w = direction[:, 2] + np.sqrt(np.maximum(squared_cosine, 0))
            deviation = np.sqrt(window + (w * self.grating.roughness) ** 2)
            drift = 2 * (offset - direction[:, 0]) * offset * width / wavenumber
            sides = np.stack([squared_cosine - drift, squared_cosine + drift])
            total += self.efficiency(m, w, wavenumber) * above_horizon(sides, deviation)
        return (1 / np.maximum(total, 1e-4)).mean(axis=0)


def _squared_cosine(direction: Array, offset: Array | float) -> Array:
    """1 − x² − y² of an order at x = offset − ω_x, y = −ω_y, below 0 under the horizon."""
    return direction[:, 2] ** 2 + offset * (2 * direction[:, 0] - offset)


def above_horizon(squared_cosine: Array, deviation: Array) -> Array:
    """The share of a lobe above the horizon, at most 0.002 more than Φ((1 − r)/c) and never less.

    Args:
        squared_cosine: 1 − r², no unit, of the lobe's middle, below 0 where that is under the
            horizon.
        deviation: c, of the sine, no unit.
    """
    # 1 − r = (1 − r²)/2 + (1 − r²)²/8 + …, and what makes it 1 at r = 0.
    rest = 0.125 * np.maximum(squared_cosine, -1) + 0.375 * np.maximum(squared_cosine, 0) ** 3
    z = squared_cosine * (0.5 + rest) / deviation
    # Φ(−|z|) to 0.00091, a fit; as much is added.
    away = -np.abs(z)
    t = np.clip(1 + away / 4.2, 0, 1)
    tail = 0.5 * t**5 * (1 - away * (0.4012 + 0.16397 * away))
    return np.where(z < 0, tail, 1 - tail) + 0.00092 * np.minimum(4 * t, 1)


@functools.lru_cache(maxsize=16)
def _profile_tables(recipe: str) -> dict[str, Table]:
    return profile_map(ProfileRecipe.model_validate_json(recipe)).tables


@functools.lru_cache(maxsize=8)
def _lobe_tables(illuminant: str, observer: Observer) -> dict[str, Table]:
    recipe = LobesRecipe.model_construct(kind="lobes", illuminant=illuminant, observer=observer)
    return lobes_map(recipe, Path()).tables


def uniform_nodes(weights: Table, tint: Array, count: int) -> list[Node]:
    """Bands of equal width over the whole spectrum, each with all of its light at its middle.

    Args:
        weights: Cumulative XYZ of the bases of tints.
        tint: Shares of the bases, shape (3,).
        count: How many bands.
    """
    (axis,) = weights.axes
    λ = axis.parameters()
    edges = np.linspace(axis.first, axis.last, count + 1)
    cumulative = np.stack([np.interp(edges, λ, column) for column in weights.values.T], axis=-1)
    bands = np.diff(cumulative, axis=0).reshape(count, 3, 3)
    return [
        Node((low + high) / 2, high - low, band.T @ tint)
        for (low, high), band in zip(itertools.pairwise(edges.tolist()), bands, strict=True)
    ]


def weighted_nodes(weights: Table, tint: Array) -> list[Node]:
    """Bands placed as web/spectrum/spectral-nodes.ts places them.

    Args:
        weights: Cumulative XYZ of the bases of tints.
        tint: Shares of the bases, shape (3,).
    """
    (edges,) = weights.axes
    λ = edges.parameters()
    energy = weights.values.sum(axis=1)
    share = 0.5 * energy / energy[-1] + 0.5 * np.linspace(0, 1, len(λ))
    ends = np.interp(np.linspace(0, 1, WIDE_LOBE_NODES + 1), share, λ)
    nodes = []
    for low, high in itertools.pairwise(ends):
        at = [np.interp([low, high], λ, column) for column in weights.values.T]
        xyz = np.diff(at, axis=1).reshape(3, 3).T @ tint
        fine = np.linspace(low, high, 65)
        cumulative = np.interp(fine, λ, energy)
        middle = np.average((fine[1:] + fine[:-1]) / 2, weights=np.diff(cumulative) + 1e-15)
        nodes.append(Node(float(middle), float(high - low), xyz))
    return nodes
