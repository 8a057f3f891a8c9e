"""The reference for height fields under an environment: every line, at every wavelength."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.special import ndtri

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

STRONG = 3e-3
"""Lines that take this share of the light or more are evaluated at every wavelength."""

COARSE = 0.02
"""Widest step of the other lines' wavelengths, µm; neighbouring lines take other ones."""

TILTS = 1600
"""Of a rough surface's normals, for each strong line over all wavelengths; fewer for the others."""


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
    environment's RGB becomes a spectrum through `tint_basis`. Roughness moves (ω_jl)_xy by w δ
    times a standard normal pair, as for gratings.

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
    largest = powers.max(axis=0)
    shown = largest > NEGLIGIBLE
    power = CubicSpline(np.linspace(0, LONGEST, SAMPLES), powers[:, shown])
    step = WAVELENGTH_STEP * len(WAVELENGTHS) / len(wavelengths)
    line, index, band = _wavelengths_of_lines(largest[shown], len(wavelengths), step)
    per_wavelength = TILTS / len(wavelengths) if optics.roughness > 0 else 1
    counts = np.ceil(per_wavelength * np.sqrt(np.minimum(largest[shown] / STRONG, 1)))
    repeated = np.repeat(np.arange(len(line)), counts[line].astype(np.intp))
    line, index, band = line[repeated], index[repeated], band[repeated]
    # A line's tilts follow one another.
    tilts = np.empty((len(line), 2))
    tilts[np.argsort(line, kind="stable")] = optics.roughness * _normal_pairs(len(line))
    f, λ = frequencies[shown][line], wavelengths[index]
    every = np.searchsorted(WAVELENGTHS, wavelengths - WAVELENGTH_STEP / 2)[index]
    weights = (band / counts[line])[:, None] * colour_weights(light.observer, light.illuminant)[
        every
    ]
    basis = tint_basis()[every]
    result = np.zeros((len(wo), 3))
    for row, o in enumerate(wo):
        wi, raised = _middle_of_band(o, f, λ, band)
        open_ = np.flatnonzero(raised)
        wi, λ_open = wi[open_], λ[open_]
        # `scale` has the s² of a density over (u, v); a line's whole lobe has none.
        scale = λ_open**2 * optics.scale(wi, np.broadcast_to(o, wi.shape), λ_open)
        w = o[2] + wi[:, 2]
        e = scale * raised[open_] * _each(power, w / λ_open, line[open_])
        moved = _held_above(wi[:, :2] + w[:, None] * tilts[open_])
        seen = environment(moved if frame is None else moved @ frame[row])
        result[row] = (e * np.sum(seen * basis[open_], axis=1)) @ weights[open_]
    return result


def _wavelengths_of_lines(
    largest: Array, count: int, step: float
) -> tuple[NDArray[np.intp], NDArray[np.intp], Array]:
    """Which lines are evaluated at which of `count` wavelengths, and the bands these stand for, µm.

    Strong lines take all of them, fainter ones each second, third and so on, at most `COARSE`
    apart.
    """
    strides = np.clip(np.sqrt(STRONG / largest), 1, max(1, COARSE / step)).astype(np.intp)
    lines = np.arange(len(largest))
    index, line = np.nonzero((np.arange(count)[:, None] + lines) % strides == 0)
    return line, index, np.float64(step) * strides[line]


def _middle_of_band(o: Array, f: Array, λ: Array, band: Array) -> tuple[Array, Array]:
    """Where light of a band of wavelengths comes from, and cosθ_i · the mean of 1/cosθ_i over it.

    cosθ_i² is a parabola over wavelength, A² − |f|²(λ − λ_0)². 1/cosθ_i is unbounded where a line
    meets the horizon, but its integral is an arcsine.

    Args:
        o: ω_o, shape (3,).
        f: Spatial frequencies, 1/µm, shape (n, 2).
        λ: Middles of the bands, µm, shape (n,).
        band: Their widths, µm, shape (n,).

    Returns:
        ω_i in the middle of what is above the horizon, shape (n, 3), and the factor, shape (n,):
        but for the variation of cosθ_i, the share of the band above the horizon.
    """
    length = np.maximum(np.linalg.norm(f, axis=1), 1e-9)  # order 0 stays where it is
    λ_0 = f @ o[:2] / length**2
    A = np.sqrt(1 - o[:2] @ o[:2] + (length * λ_0) ** 2)
    ends = [np.clip(λ + h * band, λ_0 - A / length, λ_0 + A / length) for h in (-0.5, 0.5)]
    xy = np.mean(ends, axis=0)[:, None] * f - o[:2]
    z = np.sqrt(np.maximum(1 - np.sum(xy**2, axis=1), 0))
    turns = [np.arcsin(np.clip(length * (end - λ_0) / A, -1, 1)) for end in ends]
    return np.column_stack([xy, z]), z * (turns[1] - turns[0]) / (length * band)


def _held_above(xy: Array) -> Array:
    """Unit vectors of these tangential parts, held at the horizon; (n, 2) to (n, 3)."""
    xy = xy / np.maximum(np.linalg.norm(xy, axis=1, keepdims=True), 1)
    return np.column_stack([xy, np.sqrt(np.maximum(0, 1 - np.sum(xy**2, axis=1)))])


def _normal_pairs(count: int) -> Array:
    """Standard normal pairs, every stretch of which covers the plane evenly; shape (count, 2)."""
    # Multiples of the inverse powers of the plastic number, ρ³ = ρ + 1, modulo 1 leave no gaps.
    ρ = 1.32471795724474602596
    return ndtri((0.5 + np.arange(1, count + 1)[:, None] / np.array([ρ, ρ**2])) % 1)


def _each(power: CubicSpline, p: Array, lines: NDArray[np.intp]) -> Array:
    """The spline of each line at its own p."""
    interval = np.clip(np.searchsorted(power.x, p, side="right") - 1, 0, len(power.x) - 2)
    offset = p - power.x[interval]
    c = power.c[:, interval, lines]
    return ((c[0] * offset + c[1]) * offset + c[2]) * offset + c[3]
