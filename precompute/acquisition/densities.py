"""From how bright a foil is on average in each direction to how often which gratings occur on it.

Averaged over many gratings a foil shows at (u, v) = ρ (cos ψ, sin ψ), over irradiance,

    I(ρ, ψ) = b + Σ_θf q(θ, f) V_f(ρ) exp(−(ρ sin(ψ − θ))²/2c²),

q the share of the area that gratings of θ and 1/a = f cover, V_f the profile of their lobes of all
orders (`precompute.acquisition.lobes`), b what is matt. I has the period π in ψ, so that directions
on both sides of the highlight are one.

q is found by the multiplicative steps of Richardson 1972 and Lucy 1974, which keep it above 0 and
raise the likelihood of counts: how many shapes are lit in a direction is one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d
from scipy.stats import norm

from precompute.acquisition.lobes import ORDERS, RADIUS_MAX, RADIUS_STEP, LobeTable

Array = NDArray[np.float64]

RADII = round(RADIUS_MAX / RADIUS_STEP)


@dataclass(frozen=True)
class MeanLight:
    """What a sample shows in each direction.

    Attributes:
        total: Sum of intensities, shape (angles, radii): cells over ψ from 0 to π, and about
            ρ = i · `RADIUS_STEP`.
        count: Of points that look there, of the same shape.
    """

    total: Array
    count: Array

    def __add__(self, other: MeanLight) -> MeanLight:
        return MeanLight(self.total + other.total, self.count + other.count)

    @staticmethod
    def of(u: Array, v: Array, intensity: Array, angles: int) -> MeanLight:
        """Sort observations, arrays of shape (n,), by direction.

        Args:
            u: (ω_i + ω_o)_x, shape (n,).
            v: (ω_i + ω_o)_y, shape (n,).
            intensity: Radiance over irradiance, shape (n,).
            angles: How many cells there are over ψ.
        """
        turn = np.mod(np.arctan2(v, u), np.pi) * (angles / np.pi)
        row = np.minimum(turn.astype(np.intp), angles - 1)
        column = np.round(np.hypot(u, v) / RADIUS_STEP).astype(np.intp)
        inside = column < RADII
        place = (row * RADII + column)[inside]
        size = angles * RADII
        total, count = (
            np.bincount(place, weights, size).astype(np.float64).reshape(angles, RADII)
            for weights in (intensity[inside], None)
        )
        return MeanLight(total, count)


class Lobes:
    """I of q, linear, and its transpose; angles are cells over [0, π).

    Args:
        weights: Light times sensitivity of one channel on `WAVELENGTHS`, shape (401,).
        deviation: c.
        frequencies: Middles of cells over 1/a, 1/µm.
        height: h0, µm.
        angles: How many cells.
    """

    def __init__(
        self, weights: Array, deviation: float, frequencies: Array, height: float, angles: int
    ) -> None:
        self.angles = angles
        self._first, self._higher = (
            LobeTable.of(weights[:, None], deviation, frequencies, height, orders)
            .values[:, :, 0]
            .astype(np.float64)
            for orders in (range(1, 2), range(2, ORDERS + 1))
        )
        σ = deviation / (np.maximum(np.arange(RADII), 1) * RADIUS_STEP)
        step = np.pi / angles
        apart = np.linspace(0, np.pi, angles, endpoint=False)[:, None]
        # Half a turn and more off the kernel begins anew; next to the highlight it is even.
        kernel = np.zeros((angles, RADII))
        for turn in range(-3, 3):
            kernel += _boxed_normal(apart + turn * np.pi, σ, step)
        self._spread = np.fft.rfft(np.sqrt(2 * np.pi) * σ * step * kernel, axis=0)

    def shown(self, shares: Array) -> Array:
        """I, radiance over irradiance, shape (angles, radii), of q, shape (angles, frequencies).

        Args:
            shares: q, shape (angles, frequencies).
        """
        return self._turned(shares @ (self._first + self._higher))

    def gathered(self, light: Array) -> Array:
        """The transpose: what radiance of I each grating sends, shape (angles, frequencies).

        Args:
            light: I, radiance over irradiance, shape (angles, radii).
        """
        return self._turned(light) @ (self._first + self._higher).T

    def by_order(self, shares: Array, count: Array) -> tuple[Array, Array]:
        """Of what is seen in a grating's first order, the light of first orders and the rest.

        Args:
            shares: q, shape (angles, frequencies).
            count: Of points that look in each direction, shape (angles, radii).

        Returns:
            Sums of radiance over irradiance, shape (angles, frequencies) each.
        """
        first, higher = (
            self._turned(count * self._turned(shares @ profiles)) @ self._first.T
            for profiles in (self._first, self._higher)
        )
        return first, higher

    def _turned(self, light: Array) -> Array:
        spectrum = np.fft.rfft(light, axis=0) * self._spread
        return np.maximum(np.fft.irfft(spectrum, self.angles, axis=0), 0)


def _boxed_normal(x: Array, σ: Array, width: float) -> Array:
    """The mean of a normal's density over pairs of points in two cells x apart, both so wide."""

    def twice_integrated(at: Array) -> Array:
        return at * norm.cdf(at / σ) + σ * norm.pdf(at / σ)

    ahead, here, behind = (twice_integrated(x + offset) for offset in (width, 0.0, -width))
    return np.maximum(ahead - 2 * here + behind, 0) / width**2


def seen_shares(lobes: list[Lobes], lights: list[MeanLight]) -> Array:
    """Which share of the light that gratings send is where it was looked for.

    Returns:
        0 to 1, shape (angles, frequencies).
    """
    seen = [
        one.gathered((light.count > 0).astype(np.float64))
        for one, light in zip(lobes, lights, strict=True)
    ]
    sent = [one.gathered(np.ones((one.angles, RADII))) for one in lobes]
    return np.sum(seen, axis=0) / np.maximum(np.sum(sent, axis=0), 1e-30)


def deconvolved(
    lobes: list[Lobes],
    lights: list[MeanLight],
    noise: list[float],
    usable: NDArray[np.bool_],
    steps: int,
    blur: float,
) -> Array:
    """The shares q under which what was seen is likely.

    Each step is followed by a slight blur (Silverman and others 1990), without which the steps go
    on to explain every single lit shape by a grating of its own. Where most light is of higher
    orders of what half the steps have found, the rest is chance, other shapes being lit there, and
    no grating is left.

    Args:
        lobes: Of each photograph.
        lights: What each shows beyond b.
        noise: Of each photograph's points, radiance over irradiance: dimmer light counts little.
        usable: Gratings that may occur, shape (angles, frequencies).
        steps: Number of iterations.
        blur: Standard deviation of the blur, a number of cells over θ, half as much over 1/a.

    Returns:
        q up to the factor between I and shares of area, of that shape.
    """
    photographs = list(zip(lobes, lights, noise, strict=True))
    sensitivity = np.sum([one.gathered(light.count) for one, light, _ in photographs], axis=0)
    shares = usable.astype(np.float64)
    for step in range(steps):
        if step == steps // 2:
            parts = [one.by_order(shares, light.count) for one, light, _ in photographs]
            first, higher = np.sum(parts, axis=0)
            usable = usable & (first >= higher)
        gain = np.zeros_like(shares)
        for one, light, dark in photographs:
            raised = np.maximum(light.total + dark * light.count, 0)
            gain += one.gathered(raised / (one.shown(shares) + dark))
        shares = _smooth(shares * gain / np.maximum(sensitivity, 1e-30), usable, blur)
    return shares


def log_likelihood(
    lobes: list[Lobes], lights: list[MeanLight], noise: list[float], shares: Array
) -> float:
    """How well q foretells other light, as counts: that of points that q was not found from.

    Args:
        lobes: Of each photograph.
        lights: What each shows beyond b, at those points.
        noise: Of each photograph's points, in radiance over irradiance.
        shares: q, shape (angles, frequencies).

    Returns:
        No unit, up to a constant.
    """
    total = 0.0
    for one, light, dark in zip(lobes, lights, noise, strict=True):
        expected = one.shown(shares) + dark
        raised = light.total + dark * light.count
        total += float(np.sum(raised * np.log(expected) - light.count * expected))
    return total


def _smooth(shares: Array, usable: NDArray[np.bool_], blur: float) -> Array:
    """A slight blur among what is usable."""
    known, blurred = (
        gaussian_filter1d(gaussian_filter1d(part, blur, 0, mode="wrap"), blur / 2, 1)
        for part in (usable.astype(np.float64), shares * usable)
    )
    return np.where(usable, blurred / np.maximum(known, 1e-30), 0)
