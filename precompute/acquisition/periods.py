"""Which periods a sample has, from how bright it is on average at each distance from the highlight.

Over many tiles every orientation is met as often, so that the mean of what is seen at ρ is the
sum over frequencies of their share times the lobe's profile, over πρ: as many equations as there
are radii, photographs and channels, solved with no share below zero.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar, nnls

from precompute.acquisition.lobes import RADIUS_MAX, RADIUS_STEP, Array32, LobeTable
from precompute.acquisition.observations import Strip

Array = NDArray[np.float64]

FEWEST = 50
"""Observations that make a mean."""

VISIBLE = 0.05
"""Of the most visible frequency's light, from which one is looked for: others, whose lobes lie
beyond the sample but for their tails, could have any share."""


@dataclass(frozen=True)
class MeanProfile:
    """What a sample shows on average at each distance from the highlight.

    Attributes:
        mean: Intensity at ρ = i · `RADIUS_STEP`, shape (photographs, radii, channels).
        count: Of observations, shape (photographs, radii).
    """

    mean: Array
    count: Array

    @staticmethod
    def of(strips: Iterable[Strip], photographs: int) -> MeanProfile:
        """Average strips of all tiles."""
        radii = round(RADIUS_MAX / RADIUS_STEP)
        count = np.zeros(photographs * radii)
        total: list[Array] = []
        for strip in strips:
            radius = np.hypot(strip.u, strip.v)
            index = np.minimum(np.round(radius / RADIUS_STEP).astype(np.intp), radii - 1)
            key = (strip.shot * radii + index)[strip.usable]
            seen = strip.intensity[strip.usable]
            count += np.bincount(key, minlength=len(count))
            summed = [np.bincount(key, c, len(count)).astype(np.float64) for c in seen.T]
            total = [a + b for a, b in zip(total, summed, strict=True)] if total else summed
        mean = np.stack(total, axis=-1) / np.maximum(count, 1)[:, None]
        shape = (photographs, radii)
        return MeanProfile(mean.reshape(*shape, -1), count.reshape(shape))


def frequency_shares(profile: MeanProfile, tables: list[LobeTable], weights: Array32) -> Array:
    """The area that gratings of each frequency cover, up to a scale.

    Args:
        profile: What the sample shows on average.
        tables: Of each photograph.
        weights: Of each photograph's channels, shape (photographs, channels).

    Returns:
        Shape (F,), not below 0.
    """
    left, right = _equations(profile, tables, weights)
    light = np.linalg.norm(left, axis=0)
    visible = light > VISIBLE * light.max(initial=0)
    shares = np.zeros(left.shape[1])
    if visible.any():
        shares[visible], _ = nnls(left[:, visible], right)
    return shares


def one_frequency(profile: MeanProfile, tables: list[LobeTable], weights: Array32) -> float:
    """The one frequency that explains the mean best, between those of the tables."""
    left, right = _equations(profile, tables, weights)
    places = np.arange(left.shape[1])

    def left_over(place: float) -> float:
        i = min(int(place), len(places) - 2)
        column = left[:, i] * (i + 1 - place) + left[:, i + 1] * (place - i)
        return -float(column @ right) / max(float(np.linalg.norm(column)), 1e-30)

    start = int(np.argmin([left_over(float(place)) for place in places[:-1]]))
    bounds = (max(start - 1, 0), min(start + 1, len(places) - 1))
    best = minimize_scalar(left_over, bounds=bounds, method="bounded").x
    return float(np.exp(np.interp(best, places, np.log(tables[0].frequencies))))


def explained(
    profile: MeanProfile, tables: list[LobeTable], weights: Array32, shares: Array
) -> float:
    """Which part of the squared mean is explained by shares at their best scale, 0 to 1."""
    left, right = _equations(profile, tables, weights)
    shown = left @ shares
    return float((shown @ right) ** 2 / ((shown @ shown) * (right @ right)))


def brightness(
    profile: MeanProfile, tables: list[LobeTable], weights: Array32, shares: Array
) -> Array:
    """How many times as bright as `shares` say each photograph is, shape (photographs,)."""
    factors = []
    for number in range(len(tables)):
        part = MeanProfile(profile.mean[number, None], profile.count[number, None])
        left, right = _equations(part, tables[number : number + 1], weights[number : number + 1])
        shown = left @ shares
        factors.append((shown @ right) / (shown @ shown))
    return np.array(factors)


def apparent_frequency(
    profile: MeanProfile, tables: list[LobeTable], weights: Array32, shares: Array
) -> Array:
    """By which factor all frequencies would suit each photograph best, shape (photographs,)."""
    frequencies = np.log(tables[0].frequencies)
    factors = np.linspace(-0.25, 0.25, 101)
    best = []
    for number in range(len(tables)):
        part = MeanProfile(profile.mean[number, None], profile.count[number, None])
        scores = [
            explained(
                part,
                tables[number : number + 1],
                weights[number : number + 1],
                np.interp(frequencies - factor, frequencies, shares),
            )
            for factor in factors
        ]
        best.append(factors[int(np.argmax(scores))])
    return np.exp(best)


def _equations(
    profile: MeanProfile, tables: list[LobeTable], weights: Array32
) -> tuple[Array, Array]:
    """Rows: radii of each photograph's channels, in proportion to how well they are known."""
    left, right = [], []
    ρ = np.arange(profile.mean.shape[1]) * RADIUS_STEP
    for number, table in enumerate(tables):
        known = (profile.count[number] >= FEWEST) & (ρ > 0)
        trust = np.sqrt(profile.count[number, known]) / ρ[known]
        across = np.sqrt(2 * np.pi) * table.deviation / np.pi  # ∫ of a lobe over angle, times ρ / π
        for channel, weight in enumerate(weights[number]):
            right.append(weight * trust * ρ[known] * profile.mean[number, known, channel])
            left.append(weight * trust[:, None] * across * table.values[:, known, channel].T)
    return np.concatenate(left), np.concatenate(right)
