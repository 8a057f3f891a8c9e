"""Grating profiles p(ξ), ξ in [0, 1) along one period, p in [0, 1], and their diffraction orders.

The height is h(x) = h0·p(x/a) and φ = 2π w h0/λ the depth of the phase it imprints. The order whose
lobe lies at u = +mλ/a has the amplitude

    c_m(φ) = ∫_0^1 exp(iφ p(ξ)) exp(+2πi m ξ) dξ,        η_m(φ) = |c_m(φ)|²,        Σ_m η_m = 1.

The sign of the second exponent follows from the phase exp(ik(ux + wh)): a sawtooth that rises along
+t has its normal tilted towards −t and throws its light there, into negative m.
"""

from __future__ import annotations

from typing import Annotated, Literal, Protocol, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BaseModel, ConfigDict, Field
from scipy.special import jv

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]


class _Profile(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Sinusoidal(_Profile):
    """p = (1 + cos 2πξ)/2, the printed foils' profile."""

    kind: Literal["sinusoidal"] = "sinusoidal"

    def height(self, position: ArrayLike) -> Array:
        """p, a share of the height, at positions over the period.

        Args:
            position: ξ, no unit, any shape.
        """
        return (1 + np.cos(2 * np.pi * np.asarray(position))) / 2

    def amplitude(self, order: int, phase: ArrayLike) -> ComplexArray:
        """The amplitude c_m(φ) of an order, no unit.

        Args:
            order: m, an order.
            phase: φ, rad, any shape.
        """
        φ = np.asarray(phase, dtype=np.float64)
        return np.exp(0.5j * φ) * 1j**order * jv(order, φ / 2)


class Rectangular(_Profile):
    """p = 1 over the share `duty` of the period, else 0."""

    kind: Literal["rectangular"] = "rectangular"
    duty: Annotated[float, Field(gt=0, lt=1)] = 0.5

    def height(self, position: ArrayLike) -> Array:
        """p, a share of the height, at positions over the period.

        Args:
            position: ξ, no unit, any shape.
        """
        return np.where(np.mod(position, 1) < self.duty, 1.0, 0.0)

    def amplitude(self, order: int, phase: ArrayLike) -> ComplexArray:
        """The amplitude c_m(φ) of an order, no unit.

        Args:
            order: m, an order.
            phase: φ, rad, any shape.
        """
        step: ComplexArray = np.exp(1j * np.asarray(phase, dtype=np.float64)) - 1
        if order == 0:
            return 1 + self.duty * step
        return step * (np.exp(2j * np.pi * order * self.duty) - 1) / (2j * np.pi * order)


class _PiecewiseLinear(_Profile):
    """A profile of straight segments, each of which has its integral in closed form."""

    def corners(self) -> tuple[Array, Array]:
        """Positions, rising, and heights at the segments' ends: shares of the period and of h0."""
        raise NotImplementedError

    def height(self, position: ArrayLike) -> Array:
        ξ, p = self.corners()
        return np.interp(np.mod(position, 1), ξ, p)

    def amplitude(self, order: int, phase: ArrayLike) -> ComplexArray:
        # Over a segment the exponent is linear: its integral is the width times the phasor at the
        # middle times sinc of half the phase difference between its ends.
        ξ, p = self.corners()
        φ = np.asarray(phase, dtype=np.float64)[..., None]
        middle = φ * (p[1:] + p[:-1]) / 2 + np.pi * order * (ξ[1:] + ξ[:-1])
        difference = φ * np.diff(p) + 2 * np.pi * order * np.diff(ξ)
        segments = np.diff(ξ) * np.exp(1j * middle) * np.sinc(difference / (2 * np.pi))
        return segments.sum(axis=-1)


class Blazed(_PiecewiseLinear):
    """p = ξ: a sawtooth that rises along the grating vector."""

    kind: Literal["blazed"] = "blazed"

    def corners(self) -> tuple[Array, Array]:
        return np.array([0.0, 1.0]), np.array([0.0, 1.0])


class Triangular(_PiecewiseLinear):
    """p rises to 1 at `apex` and falls back to 0."""

    kind: Literal["triangular"] = "triangular"
    apex: Annotated[float, Field(gt=0, lt=1)] = 0.5

    def corners(self) -> tuple[Array, Array]:
        return np.array([0.0, self.apex, 1.0]), np.array([0.0, 1.0, 0.0])


class Sampled(_PiecewiseLinear):
    """p given at equal steps along one period, joined by straight lines, repeating."""

    kind: Literal["sampled"] = "sampled"
    heights: Annotated[tuple[Annotated[float, Field(ge=0, le=1)], ...], Field(min_length=2)]

    def corners(self) -> tuple[Array, Array]:
        closed = np.array([*self.heights, self.heights[0]])
        return np.linspace(0, 1, len(closed)), closed


Profile: TypeAlias = Annotated[
    Sinusoidal | Rectangular | Blazed | Triangular | Sampled, Field(discriminator="kind")
]


class HeightProfile(Protocol):
    """What a table needs of a profile: its height, no closed form."""

    def height(self, position: ArrayLike) -> Array:
        """p, a share of the height, at positions over the period.

        Args:
            position: ξ, no unit, any shape.
        """
        ...


def efficiency(profile: Profile, order: int, phase: ArrayLike) -> Array:
    """η_m(φ), the scalar efficiency of an order, from the closed form.

    Args:
        profile: The profile.
        order: The order m; its lobe lies at u = mλ/a.
        phase: φ = 2π w h0/λ, rad, any shape.

    Returns:
        A share of the light, of the shape of `phase`.

    >>> blazed = Blazed()
    >>> bool(np.isclose(efficiency(blazed, -2, 4 * np.pi), 1))  # all light in one order
    True
    """
    return np.abs(profile.amplitude(order, phase)) ** 2


def efficiency_table(
    profile: HeightProfile, phase: ArrayLike, max_order: int, samples: int = 16384
) -> Array:
    """η_m(φ) of any profile by one FFT per phase.

    Args:
        profile: The profile; only its `height` is used.
        phase: φ, rad, shape (n,).
        max_order: The largest order |m| kept.
        samples: Samples along a period, at the middles of their cells.

    Returns:
        Shares of the light, shape (2·max_order + 1, n), row m + max_order.

    >>> table = efficiency_table(Triangular(), [0.0, 2.0], 3)
    >>> bool(np.allclose(table[:, 0], [0, 0, 0, 1, 0, 0, 0]))
    True
    """
    ξ = (np.arange(samples) + 0.5) / samples
    height = profile.height(ξ)
    orders = np.arange(-max_order, max_order + 1)
    columns = [
        # ifft has the exponent +2πi m ξ and the factor 1/samples.
        np.abs(np.fft.ifft(np.exp(1j * φ * height))[orders]) ** 2
        for φ in np.atleast_1d(np.asarray(phase, dtype=np.float64))
    ]
    return np.stack(columns, axis=-1)
