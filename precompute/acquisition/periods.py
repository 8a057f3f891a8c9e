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
from scipy.optimize import nnls

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
        """Average strips of all tiles.

        Args:
            strips: Observations.
            photographs: How many there are.
        """
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
        No unit, shape (F,), not below 0.
    """
    left, right = _equations(profile, tables, weights)
    light = np.linalg.norm(left, axis=0)
    visible = light > VISIBLE * light.max(initial=0)
    shares = np.zeros(left.shape[1])
    if visible.any():
        shares[visible], _ = nnls(left[:, visible], right)
    return shares


def brightness(
    profile: MeanProfile, tables: list[LobeTable], weights: Array32, shares: Array
) -> Array:
    """How many times as bright as `shares` say each photograph is, shape (photographs,).

    Args:
        profile: What was seen.
        tables: What gratings of each photograph show.
        weights: Of the channels, no unit, shape (photographs, channels).
        shares: Of each frequency, shape (frequencies,).
    """
    factors = []
    for number in range(len(tables)):
        part = MeanProfile(profile.mean[number, None], profile.count[number, None])
        left, right = _equations(part, tables[number : number + 1], weights[number : number + 1])
        shown = left @ shares
        factors.append((shown @ right) / (shown @ shown))
    return np.array(factors)


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
