"""The reference: diffraction by gratings evaluated directly, in float64, at every nanometre.

No table, no closed form over wavelength, nothing that the shipped path computes. Directions are
unit vectors (t, b, n) away from the surface, arrays of shape (..., 3). docs/theory derives the
formulas.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtr

from precompute.gratings import Grating, Light
from precompute.profiles import ComplexArray, efficiency
from precompute.spectra import (
    WAVELENGTH_STEP,
    WAVELENGTHS,
    colour_weights,
    metal_reflectance,
    tint_basis,
)

Array = NDArray[np.float64]

EXPONENT_CUT = 45.0
"""A lobe is taken as zero where its exponent is below −45: e^−45 = 3e-20 of the peak."""

EVALUATED_AT_ONCE = 16384
"""Directions times wavelengths of one evaluation: some MB, and no loop for a few directions."""

Environment = Callable[[Array], Array]
"""Linear sRGB radiance (n, 3) for unit directions (n, 3)."""


def propagating_orders(direction: Array, wavelength: ArrayLike, period: float) -> NDArray[np.int_]:
    """The orders that leave the surface above the horizon: |−ω_xy + (mλ/a) t| < 1.

    Args:
        direction: ω_i (or ω_o: the relation is symmetric), shape (3,).
        wavelength: λ, µm, scalar.
        period: a, µm.

    Returns:
        m, rising, shape (orders,).

    >>> propagating_orders(np.array([0.0, 0.0, 1.0]), 0.55, 1.66).tolist()
    [-3, -2, -1, 0, 1, 2, 3]
    """
    λ = float(np.asarray(wavelength))
    limit = int(np.ceil(2 * period / λ))
    orders = np.arange(-limit, limit + 1)
    return orders[_squared_cosine(direction, orders * λ / period) > 0]


def order_direction(
    direction: Array, order: ArrayLike, wavelength: ArrayLike, period: float
) -> Array:
    """Direction of order m for light from (or to) `direction`: the conical grating equation.

    (ω_m)_xy = −ω_xy + (mλ/a) t.

    Args:
        direction: ω, shape (..., 3).
        order: m, broadcast against the leading shape.
        wavelength: λ, µm, likewise.
        period: a, µm.

    Returns:
        Unit vectors, shape (..., 3); NaN where the order does not propagate.

    >>> order_direction(np.array([0.0, -0.5, 0.866]), 1, 0.5, 1.0).round(3).tolist()
    [0.5, 0.5, 0.707]
    """
    offset = np.asarray(order) * np.asarray(wavelength) / period
    x = offset - direction[..., 0]
    y = np.broadcast_to(-direction[..., 1], x.shape)
    z_squared = _squared_cosine(direction, offset)
    z = np.sqrt(np.where(z_squared > 0, z_squared, np.nan))
    return np.stack([x, y, z], axis=-1)


def _squared_cosine(direction: Array, offset: NDArray[np.floating]) -> NDArray[np.floating]:
    """1 − x² − y² of an order at x = offset − ω_x, y = −ω_y, below 0 where it does not propagate.

    Written from ω_z, so that order 0 keeps its cosine however close it is to the horizon: below
    1e-8 nothing of its square is left in 1 − x² − y².
    """
    return direction[..., 2] ** 2 + offset * (2 * direction[..., 0] - offset)


def propagating_efficiency(grating: Grating, direction: Array, wavelength: ArrayLike) -> Array:
    """N(ω, λ) = Σ η_j over the orders that propagate, each at its own phase depth.

    Order j between ω and ω_j has φ_j = 2π (cosθ + cosθ_j) h0/λ.

    Args:
        grating: The grating.
        direction: ω, shape (..., 3).
        wavelength: λ, µm, broadcast against the leading shape.

    Returns:
        N, a share, of the leading shape; near 1 where few orders are cut off.
    """
    λ = np.asarray(wavelength, dtype=np.float64)
    shape = np.broadcast_shapes(direction.shape[:-1], λ.shape)
    total = np.zeros(shape)
    if total.size == 0:
        return total
    limit = int(np.ceil(2 * grating.period / λ.min()))
    for order in range(-limit, limit + 1):
        other = order_direction(direction, order, λ, grating.period)[..., 2]
        if np.isnan(other).all():
            continue
        φ = 2 * np.pi * (direction[..., 2] + other) * grating.height / λ
        total += np.where(np.isnan(other), 0, efficiency(grating.profile, order, np.nan_to_num(φ)))
    return total


def efficiency_above_horizon(grating: Grating, direction: Array, wavelength: ArrayLike) -> Array:
    """N(ω, λ) = Σ η_j H_j over all orders, H_j the part of order j's lobe above the horizon.

    With r the length of (ω_j)_xy and c the lobe's standard deviation, H_j = Φ((1 − r)/c): the
    horizon is taken as straight across the lobe, which is a little more than the disc holds. An
    order that does not propagate has cosθ_j = 0.

    Args:
        grating: The grating.
        direction: ω, shape (..., 3).
        wavelength: λ, µm, broadcast against the leading shape.

    Returns:
        N, a share, of the leading shape.
    """
    λ = np.asarray(wavelength, dtype=np.float64)
    shape = np.broadcast_shapes(direction.shape[:-1], λ.shape)
    total = np.zeros(shape)
    if total.size == 0:
        return total
    limit = _last_order(grating, λ)
    for order in range(-limit, limit + 1):
        squared_cosine = _squared_cosine(direction, order * λ / grating.period)
        w = direction[..., 2] + np.sqrt(np.maximum(squared_cosine, 0))
        deviation = np.sqrt(_window_variance(grating, λ) + (w * grating.roughness) ** 2)
        r = np.sqrt(np.maximum(1 - squared_cosine, 0))
        above = ndtr(squared_cosine / (1 + r) / deviation)  # 1 − r² keeps the digits of 1 − r
        φ = 2 * np.pi * w * grating.height / λ
        total += above * efficiency(grating.profile, order, φ)
    return total


def energy_factor(
    grating: Grating,
    wi: Array,
    wo: Array,
    wavelength: ArrayLike,
    total: Callable[[Grating, Array, ArrayLike], Array] = propagating_efficiency,
) -> Array:
    """What multiplies R·η_m to make it the efficiency e_m.

    - ``kirchhoff``: (1 + ω_i·ω_o)²/(cosθ_i cosθ_o w²), Stam's obliquity; unbounded at grazing.
    - ``conserving``: 1/N(ω_o, λ): a white furnace returns R at every angle.
    - ``reciprocal``: 1/max(N(ω_i, λ), N(ω_o, λ)): symmetric, never gains.

    Args:
        grating: The grating.
        wi: ω_i, shape (..., 3), above the horizon.
        wo: ω_o, likewise.
        wavelength: λ, µm, broadcast against the leading shape.
        total: N, a share, of plane waves or of lobes (`efficiency_above_horizon`).

    Returns:
        The factor, of the broadcast leading shape.
    """
    if grating.energy == "kirchhoff":
        w = wi[..., 2] + wo[..., 2]
        cosine = np.sum(wi * wo, axis=-1)
        factor = (1 + cosine) ** 2 / (wi[..., 2] * wo[..., 2] * w**2)
        return np.broadcast_to(factor, np.broadcast_shapes(factor.shape, np.shape(wavelength)))
    n = total(grating, wo, wavelength)
    if grating.energy == "reciprocal":
        n = np.maximum(n, total(grating, wi, wavelength))
    return 1 / n


def reflectance(grating: Grating, wavelength: ArrayLike) -> Array:
    """R(λ) of the grating's metal, a share of the light, 1 for a perfect mirror.

    Args:
        grating: The grating.
        wavelength: λ, µm, any shape.
    """
    if grating.metal is None:
        return np.ones_like(np.asarray(wavelength, dtype=np.float64))
    return metal_reflectance(grating.metal, wavelength)


def order_efficiency(
    grating: Grating, wi: Array, order: int, wavelength: float
) -> tuple[float, float]:
    """η_m and e_m of one propagating order for a plane wave from `wi`.

    Args:
        grating: The grating.
        wi: ω_i, shape (3,).
        order: The order m, propagating.
        wavelength: λ, µm.

    Returns:
        The scalar efficiency η_m(φ), a share, and e_m, with the metal and the energy choice.
    """
    wo = order_direction(wi, order, wavelength, grating.period)
    φ = 2 * np.pi * (wi[2] + wo[2]) * grating.height / wavelength
    η = float(efficiency(grating.profile, order, φ))
    factor = float(energy_factor(grating, wi, wo, wavelength))
    return η, float(reflectance(grating, wavelength)) * factor * η


def spectral_brdf(
    grating: Grating,
    wi: Array,
    wo: Array,
    wavelength: ArrayLike,
    angular_radius: float = 0.0,
) -> Array:
    """f_r(ω_i, ω_o, λ) of a grating behind a Gaussian coherence window, 1/sr.

    The complex amplitudes of all orders are added before they are squared, so that orders that
    overlap interfere. In the plane of (u, v) the squared lobe is a Gaussian of covariance

        C = λ²/(8π²σ²)·1 + (wδ)²·1 + α²(1 − ddᵀ),    d = (ω_i)_xy,

    from the window, from normals tilted by δ (a tilt ε moves (u, v) by wε) and from a source of
    standard deviation α, whose directions project onto the surface. With the energy ``conserving``
    w is that of the order, cosθ_o + cosθ_m, so that ∫ f_r cosθ_i dω_i is R Σ η_m H_m/N; with the
    others it is cosθ_o + cosθ_i, as in Kirchhoff's integral and as reciprocity asks.

    Args:
        grating: The grating.
        wi: ω_i, shape (n, 3).
        wo: ω_o, shape (n, 3).
        wavelength: λ, µm, shape (n,): one wavelength a row.
        angular_radius: α, rad.

    Returns:
        Shape (n,); zero where either direction is below the horizon.
    """
    λ = np.asarray(wavelength, dtype=np.float64)
    result = np.zeros(λ.shape)
    above = (wi[:, 2] > 0) & (wo[:, 2] > 0)
    for chosen in _near_a_lobe(grating, wi, wo, λ, angular_radius, above):
        lobes = _lobe_sum(grating, wi[chosen], wo[chosen], λ[chosen], angular_radius)
        factor = energy_factor(grating, wi[chosen], wo[chosen], λ[chosen], efficiency_above_horizon)
        result[chosen] = reflectance(grating, λ[chosen]) * factor * lobes
    return result


def colour_brdf(grating: Grating, wi: Array, wo: Array, light: Light) -> Array:
    """∫ S(λ) (x̄, ȳ, z̄)(λ) f_r(ω_i, ω_o, λ) dλ by 1 nm, S scaled so that a mirror has Y = 1.

    Args:
        grating: The grating.
        wi: ω_i, shape (n, 3).
        wo: ω_o, shape (n, 3).
        light: The light; its tint multiplies its spectrum through `tint_basis`.

    Returns:
        XYZ, 1/sr, shape (n, 3).
    """
    spectrum = tint_basis() @ np.asarray(light.tint)
    weights = spectrum[:, None] * colour_weights(light.observer, light.illuminant)
    return weighted_brdf(grating, wi, wo, weights, light.angular_radius)


def weighted_brdf(
    grating: Grating,
    wi: Array,
    wo: Array,
    weights: Array,
    angular_radius: float,
    step: int = 1,
) -> Array:
    """∫ W(λ) f_r(ω_i, ω_o, λ) dλ for the channels of an observer or a sensor.

    Args:
        grating: The grating.
        wi: ω_i, shape (n, 3).
        wo: ω_o, shape (n, 3).
        weights: W on `WAVELENGTHS`, light times sensitivity, shape (401, channels).
        angular_radius: α, rad.
        step: Every so-many-th wavelength is evaluated.

    Returns:
        1/sr times the unit of W dλ, shape (n, channels).
    """
    result = np.zeros((len(wi), weights.shape[1]))
    lit = np.arange(0, len(WAVELENGTHS), step)
    lit = lit[weights[lit].any(axis=1)]
    at_once = max(1, EVALUATED_AT_ONCE // max(len(wi), 1))
    for start in range(0, len(lit), at_once):
        some = lit[start : start + at_once]
        pairs = (len(some), len(wi))
        f = spectral_brdf(
            grating,
            np.broadcast_to(wi, (*pairs, 3)).reshape(-1, 3),
            np.broadcast_to(wo, (*pairs, 3)).reshape(-1, 3),
            np.repeat(WAVELENGTHS[some], len(wi)),
            angular_radius,
        )
        # One after the other: the sum does not depend on how many are evaluated at once.
        for values, weight in zip(f.reshape(pairs), weights[some], strict=True):
            result += step * WAVELENGTH_STEP * values[:, None] * weight
    return result


def environment_radiance(
    grating: Grating,
    wo: Array,
    environment: Environment,
    light: Light,
    wavelengths: Array = WAVELENGTHS,
    tilts: int = 1,
    frame: Array | None = None,
) -> Array:
    """L_o = Σ_m ∫ S(λ) e_m(λ) L_env(ω_m(λ), λ) dλ, an arc of the environment per order.

    The environment's RGB becomes a spectrum through `tint_basis`. Roughness moves (ω_m)_xy by
    w δ times a standard normal pair, integrated on a grid of `tilts` × `tilts` nodes.

    Args:
        grating: The grating.
        wo: ω_o, shape (n, 3), above the horizon.
        environment: Radiance by direction.
        light: Illuminant of the environment and observer.
        wavelengths: A subset of `WAVELENGTHS` at equal steps, two or more, µm.
        tilts: Nodes per axis over ±3 standard deviations; 1 for a flat grating.
        frame: Rows t, b, n of each grating's frame in the environment's axes, shape (n, 3, 3);
            without it the environment takes directions in the grating's frame.

    Returns:
        XYZ radiance, shape (n, 3).
    """
    weights = colour_weights(light.observer, light.illuminant)
    indices = np.searchsorted(WAVELENGTHS, wavelengths - WAVELENGTH_STEP / 2)
    step = wavelengths[1] - wavelengths[0]
    offsets, shares = _tilt_nodes(tilts if grating.roughness > 0 else 1)
    basis = tint_basis()
    result = np.zeros((len(wo), 3))
    for index in indices:
        λ = WAVELENGTHS[index]
        rgb = np.zeros((len(wo), 3))
        limit = int(np.ceil(2 * grating.period / λ))
        for order in range(-limit, limit + 1):
            wi = order_direction(wo, order, λ, grating.period)
            open_ = ~np.isnan(wi[:, 2])
            if not open_.any():
                continue
            wi, w_o = wi[open_], wo[open_]
            w = wi[:, 2] + w_o[:, 2]
            η = efficiency(grating.profile, order, 2 * np.pi * w * grating.height / λ)
            seen = np.zeros_like(wi)
            for offset, share in zip(offsets, shares, strict=True):
                moved = _moved(wi, w[:, None] * grating.roughness * offset)
                if frame is not None:
                    moved = np.einsum("ni,nij->nj", moved, frame[open_])
                seen += share * environment(moved)
            e = reflectance(grating, λ) * energy_factor(grating, wi, w_o, λ) * η
            rgb[open_] += e[:, None] * seen
        result += step * (rgb @ basis[index])[:, None] * weights[index]
    return result


def _near_a_lobe(
    grating: Grating,
    wi: Array,
    wo: Array,
    λ: Array,
    angular_radius: float,
    above: NDArray[np.bool_],
) -> list[NDArray[np.intp]]:
    """Rows whose |v| is within a lobe's reach, in pieces that keep memory small."""
    v = wi[:, 1] + wo[:, 1]
    w = wo[:, 2] + 1  # at most
    variance = _window_variance(grating, λ) + (w * grating.roughness) ** 2 + angular_radius**2
    rows = np.flatnonzero(above & (v**2 < 2 * EXPONENT_CUT * variance))
    return [rows[i : i + 65536] for i in range(0, len(rows), 65536)]


def _last_order(grating: Grating, λ: Array) -> int:
    """One more than can propagate for any direction: of that one a lobe may reach above."""
    return int(np.ceil(2 * grating.period / λ.min())) + 1


def _window_variance(grating: Grating, λ: Array) -> Array:
    return λ**2 / (8 * np.pi**2 * grating.coherence**2)


def _lobe_sum(grating: Grating, wi: Array, wo: Array, λ: Array, angular_radius: float) -> Array:
    """Σ_{m,n} c_m c̄_n κ_{m−n} √(N_m N_n), N_m = N((u, v) − (mλ/a, 0); C_m).

    With one C, √(N_m N_n) is the Gaussian half-way between both orders, as far down as their
    distance Δ = (m − n) λ/a takes it: exp(−Δ²(C⁻¹)_uu/8). Blurs take the light of every tilt and
    of every point of the source by itself, so what interferes goes down with the window alone,

        κ_{m−n} √(N_m N_n) = exp(−π²σ²(m−n)²/a²) N((u, v) − ((m+n)/2·λ/a, 0); C).

    Where each order has a C of its own, κ has that of cosθ_o + cosθ_i, whatever the orders: as a
    Gaussian in m − n it is positive definite, and the sum never negative.
    """
    u, v, w = (wi + wo).T
    d = wi[:, :2]
    source = angular_radius**2 * np.stack([1 - d[:, 0] ** 2, 1 - d[:, 1] ** 2, -d[:, 0] * d[:, 1]])

    def covariance(w: Array) -> tuple[Array, Array]:
        """C_uu, C_vv, C_uv, shape (3, n), and det C."""
        blur = _window_variance(grating, λ) + (w * grating.roughness) ** 2
        c = source + blur * np.array([[1], [1], [0]])
        return c, c[0] * c[1] - c[2] ** 2

    limit = _last_order(grating, λ)
    apart = int(np.sqrt(EXPONENT_CUT) * grating.period / (np.pi * grating.coherence))
    (_, c_vv, _), determinant = covariance(w)
    Δ = λ / grating.period
    coherence = Δ**2 / 8 * (1 / _window_variance(grating, λ) - c_vv / determinant)
    amplitudes: deque[ComplexArray] = deque(maxlen=apart + 1)  # c_m √N_m, the latest order first
    total = np.zeros(λ.shape)
    for order in range(-limit, limit + 1):
        if grating.energy == "conserving":
            w = wo[:, 2] + np.sqrt(np.maximum(_squared_cosine(wo, order * Δ), 0))
        (c_uu, c_vv, c_uv), determinant = covariance(w)
        du = u - order * Δ
        exponent = (c_vv * du**2 - 2 * c_uv * du * v + c_uu * v**2) / (2 * determinant)
        near = np.flatnonzero(exponent < EXPONENT_CUT)
        gaussian = np.exp(-exponent[near]) / (2 * np.pi * np.sqrt(determinant[near]))
        φ = 2 * np.pi * w[near] * grating.height / λ[near]
        amplitude = np.zeros(λ.shape, np.complex128)
        amplitude[near] = grating.profile.amplitude(order, φ) * np.sqrt(gaussian)
        amplitudes.appendleft(amplitude)
        for difference, other in enumerate(amplitudes):
            pairs = 1 if difference == 0 else 2
            κ = pairs * np.exp(-coherence[near] * difference**2)
            total[near] += κ * np.real(amplitude[near] * np.conj(other[near]))
    return total


def _tilt_nodes(count: int) -> tuple[Array, Array]:
    """Nodes (count², 2) in standard deviations, and shares that sum to 1, of a 2-D normal."""
    if count == 1:
        return np.zeros((1, 2)), np.ones(1)
    x = np.linspace(-3, 3, count)
    nodes = np.stack(np.meshgrid(x, x), axis=-1).reshape(-1, 2)
    shares = np.exp(-np.sum(nodes**2, axis=-1) / 2)
    return nodes, shares / shares.sum()


def _moved(direction: Array, offset: Array) -> Array:
    """The direction with `offset` added to its tangential part, held at the horizon."""
    xy = direction[:, :2] + offset
    length = np.linalg.norm(xy, axis=-1, keepdims=True)
    xy = xy / np.maximum(length, 1)
    z = np.sqrt(np.maximum(0, 1 - np.sum(xy**2, axis=-1)))
    return np.concatenate([xy, z[:, None]], axis=-1)
