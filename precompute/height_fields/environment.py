"""The reference for height fields under an environment: every line, at every wavelength."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from precompute.gratings import Light
from precompute.height_fields.cells import LONGEST, line_powers
from precompute.height_fields.field import HeightField
from precompute.height_fields.optics import HeightFieldOptics
from precompute.reference import Environment
from precompute.spectra import WAVELENGTH_STEP, WAVELENGTHS, colour_weights, tint_basis

Array = NDArray[np.float64]

SAMPLES = 257
"""Of |A_jl|² over p = w/λ, between which a cubic spline is exact to 1e-6 for reliefs up to 1 µm."""

NEGLIGIBLE = 1e-8
"""Lines that never take more than this share of the light are left out."""


def environment_radiance(
    field: HeightField,
    optics: HeightFieldOptics,
    wo: Array,
    environment: Environment,
    light: Light,
    wavelengths: Array = WAVELENGTHS,
    frame: Array | None = None,
) -> Array:
    """L_o = Σ_jl ∫ S R (1 + ω_jl·ω_o)²/(cosθ_jl cosθ_o w²) |A_jl|² L_env(ω_jl) dλ.

    (ω_jl)_xy = −(ω_o)_xy + λ f_jl: a line carries a plane wave's radiance over, like an order. The
    environment's RGB becomes a spectrum through `tint_basis`. The relief is taken as smooth: no
    roughness.

    Args:
        field: The relief.
        optics: Its material; energy ``kirchhoff``.
        wo: ω_o, shape (n, 3), above the horizon.
        environment: Radiance by direction.
        light: Illuminant of the environment and observer.
        wavelengths: A subset of `WAVELENGTHS` at equal steps, µm.
        frame: Rows x, y, normal of each point's frame in the environment's axes, shape (n, 3, 3);
            without it the environment takes directions in the surface's frame.

    Returns:
        XYZ radiance, shape (n, 3).
    """
    frequencies, powers = line_powers(field, SAMPLES)
    shown = powers.max(axis=0) > NEGLIGIBLE
    frequencies = frequencies[shown]
    power = CubicSpline(np.linspace(0, LONGEST, SAMPLES), powers[:, shown])
    lines = np.arange(len(frequencies))
    weights = colour_weights(light.observer, light.illuminant)
    basis = tint_basis()
    indices = np.searchsorted(WAVELENGTHS, wavelengths - WAVELENGTH_STEP / 2)
    step = WAVELENGTH_STEP * len(WAVELENGTHS) / len(wavelengths)
    result = np.zeros((len(wo), 3))
    for row, o in enumerate(wo):
        for index in indices:
            λ = WAVELENGTHS[index]
            xy = λ * frequencies - o[:2]
            z2 = 1 - np.sum(xy**2, axis=1)
            open_ = z2 > 0
            wi = np.column_stack([xy[open_], np.sqrt(z2[open_])])
            p = (o[2] + wi[:, 2]) / λ
            seen = environment(wi if frame is None else wi @ frame[row])
            facing = np.broadcast_to(o, wi.shape)
            # `scale` has the s² of a density over (u, v); a line's whole lobe has none.
            scale = λ**2 * optics.scale(wi, facing, np.full(len(wi), λ))
            e = scale * _each(power, p, lines[open_])
            result[row] += step * (e @ seen @ basis[index]) * weights[index]
    return result


def _each(power: CubicSpline, p: Array, lines: NDArray[np.intp]) -> Array:
    """The spline of each line at its own p."""
    interval = np.clip(np.searchsorted(power.x, p, side="right") - 1, 0, len(power.x) - 2)
    offset = p - power.x[interval]
    c = power.c[:, interval, lines]
    return ((c[0] * offset + c[1]) * offset + c[2]) * offset + c[3]
