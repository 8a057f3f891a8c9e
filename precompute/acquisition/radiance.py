"""What a foil under a small lamp sends to a camera, by the float64 reference."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from os import cpu_count

import numpy as np
from numpy.typing import NDArray

from precompute.acquisition.pattern import Gratings
from precompute.gratings import Grating
from precompute.profiles import Profile
from precompute.reference import weighted_brdf

Array = NDArray[np.float64]

FLAT = 1e-6
"""Height, µm, of a grating that is but a mirror: 1e-11 of the light leaves order 0."""

MANY, ALIKE = 64, 0.002
"""More frequencies than so many are rounded by so much of themselves, a tenth of how far a narrow
filter's band spreads an order."""


@dataclass(frozen=True)
class Relief:
    """What all gratings of a foil share.

    Attributes:
        height: h0, µm.
        profile: Of one period.
        coherence: σ, µm.
        roughness: Standard deviation of the normal's tilt within a point, rad.
    """

    height: float
    profile: Profile
    coherence: float
    roughness: float

    def grating(self, frequency: float) -> Grating:
        """The grating of a frequency 1/a, 1/µm; where nothing diffracts, a mirror."""
        return Grating(
            period=1 / frequency if frequency > 0 else 1.0,
            height=self.height if frequency > 0 else FLAT,
            profile=self.profile,
            coherence=self.coherence,
            roughness=self.roughness,
        )


@dataclass(frozen=True)
class Lamp:
    """A lamp as the channels of a camera see it.

    Attributes:
        position: In the sample's frame, mm, shape (3,).
        radius: Standard deviation of the source as seen from the sample, rad.
        weights: Its spectrum times the channels' sensitivity, shape (401, channels).
    """

    position: Array
    radius: float
    weights: Array


def foil_radiance(
    points: Array,
    tilts: Array,
    gratings: Gratings,
    relief: Relief,
    eye: Array,
    lamp: Lamp,
    step: int,
) -> Array:
    """Radiance at points of a foil, for an irradiance of 1 facing the lamp at its distance from 0.

    The share of a point that does not diffract is a mirror of the same metal.

    Args:
        points: x, y in mm on the plane z = 0, shape (n, 2).
        tilts: Slopes ∂z/∂x, ∂z/∂y of the surface there, shape (n, 2).
        gratings: Of each point, arrays of shape (n,).
        relief: What they share.
        eye: The camera's centre of projection, mm, shape (3,).
        lamp: The light.
        step: Every so-many-th nanometre is evaluated.

    Returns:
        Shape (n, channels).
    """
    result = np.zeros((len(points), lamp.weights.shape[1]))
    frequency = np.where(gratings.strength > 0, _few(gratings.frequency), 0.0)
    parts = [
        (piece, relief.grating(value), gratings.strength if value > 0 else 1 - gratings.strength)
        for value in {0.0, *np.unique(frequency).tolist()}
        for piece in _pieces(np.flatnonzero(_shows(value, frequency, gratings.strength)))
    ]

    def evaluated(part: tuple[NDArray[np.intp], Grating, Array]) -> Array:
        rows, grating, share = part
        wi, wo, irradiance = _directions(
            points[rows], tilts[rows], gratings.orientation[rows], eye, lamp.position
        )
        brdf = weighted_brdf(grating, wi, wo, lamp.weights, lamp.radius, step)
        return (share[rows] * irradiance)[:, None] * brdf

    with ThreadPoolExecutor(cpu_count()) as pool:
        for (rows, _, _), values in zip(parts, pool.map(evaluated, parts), strict=True):
            result[rows] += values
    return result


def _few(frequency: Array) -> Array:
    """Frequencies, or, where there are too many to go through, what they are to `ALIKE`."""
    if len(np.unique(frequency)) <= MANY:
        return frequency
    with np.errstate(divide="ignore"):
        return np.exp(ALIKE * np.round(np.log(frequency) / ALIKE))


def _shows(value: float, frequency: Array, strength: Array) -> NDArray[np.bool_]:
    return strength < 1 if value == 0 else frequency == value


def _pieces(rows: NDArray[np.intp]) -> list[NDArray[np.intp]]:
    return [rows[i : i + 16384] for i in range(0, len(rows), 16384)]


def _directions(
    points: Array, tilts: Array, orientation: Array, eye: Array, lamp: Array
) -> tuple[Array, Array, Array]:
    """ω_i and ω_o in each grating's frame, and the irradiance on the tilted surface."""
    position = np.concatenate([points, np.zeros((len(points), 1))], axis=1)
    n = np.concatenate([-tilts, np.ones((len(points), 1))], axis=1)
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    t = np.stack([np.cos(orientation), np.sin(orientation), np.zeros(len(points))], axis=1)
    t -= np.sum(t * n, axis=1, keepdims=True) * n
    t /= np.linalg.norm(t, axis=1, keepdims=True)
    frame = np.stack([t, np.cross(n, t), n], axis=1)
    towards = [lamp - position, eye - position]
    distances = [np.linalg.norm(direction, axis=1, keepdims=True) for direction in towards]
    wi, wo = (
        np.einsum("nij,nj->ni", frame, direction / distance)
        for direction, distance in zip(towards, distances, strict=True)
    )
    nearer = np.sum(lamp**2) / distances[0][:, 0] ** 2
    return wi, wo, np.maximum(wi[:, 2], 0) * nearer
