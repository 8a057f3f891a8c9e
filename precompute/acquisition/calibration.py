"""What has to be known of photographs before gratings are fitted, estimated from them.

How dark darkness is, which periods there are, how bright each photograph is, and how wide lamp and
surface make a lobe.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from os import cpu_count

import numpy as np
from numpy.typing import NDArray

from precompute.acquisition.lobe_fit import Fit, Model, fit_strip, fit_texels, peak_energy
from precompute.acquisition.lobes import RADIUS_STEP, Array32, LobeTable, lobe_deviation
from precompute.acquisition.observations import Shot, Strip, observed, strips
from precompute.acquisition.periods import (
    MeanProfile,
    brightness,
    frequency_shares,
)
from precompute.acquisition.shots import ROUGHNESS
from precompute.acquisition.tiling import Tiling

Array = NDArray[np.float64]

FREQUENCIES: Array = np.geomspace(0.3, 2.2, 101)
"""1/a of 3.3 to 0.45 µm, by 2 %: of longer periods the highlight hides the first orders."""

ROUGHNESSES = tuple(np.radians([0.05, 0.2, 0.35, 0.5, 0.8, 1.2, 2.0]).tolist())
"""Of the normal, rad; foils have some tenths of a degree."""

USUAL = 1
"""Which of them is tried first."""

HIGHLIGHT = 5.5
"""Deviations of order 0 in (u, v) beyond which 3e-7 of its peak is left."""

SOME = 400_000
"""Observations from which all is estimated: half a second's work each time."""

MODEL_ERROR = 0.1
"""Share of a lobe's peak by which it is not as the model says; what noise is weighed against."""

DIM = 0.2
"""Share of the brightest channel's peak below which another counts for no more."""

RARE = 0.01
"""Share of the commonest period's area from which a period is looked for at all."""

ONE_PERIOD = 0.015
"""Median relative distance of periods from their median up to which they count as one: that of a
sample of one period is 0.004 without noise."""

WIDE = np.linspace(-0.1, 0.1, 21)
CLOSE = np.linspace(-0.03, 0.03, 25)
"""Logarithms of frequencies about the only one, among which it is found more closely."""

COMMON = 0.2
"""Share of the commonest period's area from which a period counts as common."""

CHANCE = 9.0
"""Squared deviations that noise reaches at the best of a hundred orientations: 2 ln 100."""

NOISE = 4.0
"""Times what noise alone gains at its best orientation from which a texel counts as lit."""

FAINTEST = 3e-4
"""Gain, in that of a lobe at its peak, below which no texel counts as lit: 1.7 % of its intensity,
as it is seen 3 deviations off."""

MANY, MOST = 1000, 0.2
"""Observations at a distance from the highlight whose mean is little noise, and the share of what
the commonest distance has that is enough where all have few."""

FREE = 4.0
"""Largest strength, over its estimate by the mean, while it is not known: without a bound a lobe's
far tail would explain whatever is lit but once."""


@dataclass(frozen=True)
class Calibration:
    """What photographs say of themselves.

    Attributes:
        shots: The photographs, their background known.
        model: What gratings show in them.
        highlight: ρ, no unit, below which nothing is observed.
        roughness: Of the normal, rad.
        is_one_period: Whether all gratings have the same.
        apparent: Period in each photograph over that in all, shape (photographs,).
        lit_gain: Gain, no unit, from which a texel counts as lit, and not as noise.
    """

    shots: list[Shot]
    model: Model
    highlight: float
    roughness: float
    is_one_period: bool
    apparent: Array
    lit_gain: float

    def fit(self, tiling: Tiling, places: Array, name: str) -> Fit:
        """Fit a grating to each of many texels (`fit_texels`).

        Args:
            tiling: Where the tiles are.
            places: Of the texels in a tile, shape (n, 2).
            name: What the progress bar says.
        """
        return fit_texels(self.shots, tiling, places, self.highlight, self.model, name)


def calibrated(
    shots: list[Shot], tiling: Tiling, places: Array, height: float, is_one: bool | None
) -> Calibration | None:
    """Estimate all of it; None where nothing is lit beyond the highlight.

    Args:
        shots: The photographs.
        tiling: Where the tiles are.
        places: Texels of the pattern, in tiles, shape (n, 2).
        height: h0 of the gratings, µm.
        is_one: Whether there is one period; found out, if None.
    """
    highlight = HIGHLIGHT * max(lobe_deviation(shot.radius, ROUGHNESS) for shot in shots)
    count = len(tiling.tiles()) * len(shots)
    some = places[:: max(1, len(places) * count // SOME)]
    shots, noise = _darkened(shots, tiling, some, highlight)
    look = [observed(shots, tiling, some[part], highlight) for part in strips(len(some), count)]
    profile = MeanProfile.of(look, len(shots))
    weights = _channel_weights(profile, noise, shots)
    found = _Periods.of(shots, profile, weights, height)
    if found is None:
        return None
    trial = _Trial(shots, look, weights, found.brightness, height, found.strength)
    if not np.any(_trust(trial.free(ROUGHNESS, found.frequencies, found.shares)[1])):
        return None
    common = found.shares > COMMON * found.shares.max()
    roughness = trial.roughness(found.frequencies[common], found.shares[common])
    model, fit = trial.settled(roughness, found.frequencies, found.shares)
    logarithm = np.log(fit.frequency)
    middle = _weighted_median(logarithm, _trust(fit))
    if is_one is None:
        is_one = _weighted_median(np.abs(logarithm - middle), _trust(fit)) < ONE_PERIOD
    if is_one:
        model = trial.one_period(roughness, middle)
        logarithm = np.log(model.tables[0].frequencies)
        frequencies = np.exp(logarithm + WIDE)
        shares = np.ones(len(WIDE))
    else:
        # Many texels are seen more than once, which says better than the mean what there is.
        frequencies = found.frequencies
        shares = _shares(fit, frequencies)
        model, fit = trial.settled(roughness, frequencies, shares)
        logarithm = np.log(fit.frequency)
    apparent = trial.apparent(roughness, frequencies, shares, logarithm)
    chance = CHANCE * max(np.max((w * dark) ** 2) for w, dark in zip(weights, noise, strict=True))
    return Calibration(
        *(shots, model, highlight, roughness, is_one, apparent),
        lit_gain=max(FAINTEST, NOISE * float(chance / peak_energy(model))),
    )


@dataclass(frozen=True)
class _Periods:
    """What mean brightness says of periods and photographs.

    Attributes:
        frequencies: Those that occur, and some around, 1/µm.
        shares: Their areas, times the strength of a point all of which diffracts.
        brightness: Of each photograph over the first.
    """

    frequencies: Array
    shares: Array
    brightness: Array

    @property
    def strength(self) -> float:
        """Of a point all of which diffracts, were that true of all."""
        return float(self.shares.sum())

    @staticmethod
    def of(
        shots: list[Shot], profile: MeanProfile, weights: Array32, height: float
    ) -> _Periods | None:
        """None where nothing is lit."""
        tables = _tables(shots, ROUGHNESS, FREQUENCIES, height)
        shares = frequency_shares(profile, tables, weights)
        if not shares.any():
            return None
        factors = brightness(profile, tables, weights, shares)
        factors /= factors[0]
        tables = [table.scaled(factor) for table, factor in zip(tables, factors, strict=True)]
        shares = frequency_shares(profile, tables, weights)
        # A period that few have is likelier an order mistaken for another.
        kept = np.flatnonzero(shares > RARE * shares.max())
        around = slice(max(kept[0] - 2, 0), kept[-1] + 3)
        return _Periods(FREQUENCIES[around], shares[around], factors)


@dataclass(frozen=True)
class _Trial:
    """Some texels, to which models are fitted until one suits.

    Attributes:
        shots: The photographs.
        look: What they show of the texels.
        weights: Of their channels.
        brightness: Of each over the first.
        height: h0, µm.
        strength: A guess at that of a point all of which diffracts.
    """

    shots: list[Shot]
    look: list[Strip]
    weights: Array32
    brightness: Array
    height: float
    strength: float

    def free(self, roughness: float, frequencies: Array, shares: Array) -> tuple[Model, Fit]:
        """A model that leaves texels their strength, and what it fits."""
        tables = [
            table.scaled(factor)
            for table, factor in zip(
                _tables(self.shots, roughness, frequencies, self.height),
                self.brightness,
                strict=True,
            )
        ]
        model = Model(tables, shares / shares.sum(), self.strength, self.weights, FREE)
        return model, _fitted(self.look, model)

    def settled(self, roughness: float, frequencies: Array, shares: Array) -> tuple[Model, Fit]:
        """The model with the strength that most sure texels have, and what it fits."""
        free, fit = self.free(roughness, frequencies, shares)
        typical = _weighted_median(fit.strength, _trust(fit))
        bound = replace(free, strength=free.strength * typical, strongest=1.0)
        return bound, _fitted(self.look, bound)

    def roughness(self, frequencies: Array, shares: Array) -> float:
        """The roughness that explains most at one strength.

        With strengths that texels choose, wide lobes explain whatever is lit but once.
        """
        gains: dict[int, float] = {}

        def gain(index: int) -> float:
            if index not in gains:
                model, fit = self.settled(ROUGHNESSES[index], frequencies, shares)
                gains[index] = float(np.sum(fit.gain) * peak_energy(model))
            return gains[index]

        # The gain has one maximum, so that neither side of it need be tried to its end.
        last = len(ROUGHNESSES) - 1
        best, tried = USUAL, -1
        while best != tried:
            tried = best
            best = max((tried, max(tried - 1, 0), min(tried + 1, last)), key=gain)
        if best in (0, last):
            return ROUGHNESSES[best]
        around = range(best - 1, best + 2)
        tried_there = [ROUGHNESSES[index] for index in around]
        square, slope, _ = np.polyfit(tried_there, [gain(index) for index in around], 2)
        return float(-slope / (2 * square))

    def one_period(self, roughness: float, middle: float) -> Model:
        """The model of the only frequency, near one whose logarithm is `middle`."""
        for around in (WIDE, CLOSE):  # texels between the steps of the search pull it off
            near = np.exp(middle + around)
            _, fit = self.settled(roughness, near, np.ones(len(near)))
            middle = _weighted_median(np.log(fit.frequency), _trust(fit))
        model, _ = self.settled(roughness, np.exp([middle]), np.ones(1))
        return model

    def apparent(
        self, roughness: float, frequencies: Array, shares: Array, logarithm: Array
    ) -> Array:
        """The period that each photograph alone shows of a texel, over that which all show.

        Args:
            roughness: Of the normal, rad.
            frequencies: Among which it is looked for.
            shares: Of them.
            logarithm: Of each texel's frequency by all photographs, shape (n,) or (1,).
        """
        ratios = []
        for number, shot in enumerate(self.shots):
            alone = replace(
                self,
                shots=[shot],
                look=[strip.of_shot(number) for strip in self.look],
                weights=self.weights[number, None],
                brightness=self.brightness[number, None],
            )
            _, fit = alone.settled(roughness, frequencies, shares)
            ratios.append(_weighted_median(logarithm - np.log(fit.frequency), _trust(fit)))
        return np.exp(ratios)


def _fitted(look: list[Strip], model: Model) -> Fit:
    with ThreadPoolExecutor(cpu_count()) as pool:
        return Fit.joined(pool.map(lambda strip: fit_strip(strip, model), look))


def _shares(fit: Fit, frequencies: Array) -> Array:
    """How common each frequency is by what was fitted, summing to 1, shape (F,)."""
    place = np.interp(np.log(fit.frequency), np.log(frequencies), np.arange(len(frequencies)))
    index = np.round(place).astype(np.intp)
    common = np.bincount(index, _trust(fit), len(frequencies))
    return common / common.sum()


def _trust(fit: Fit) -> Array:
    """What each texel's fit counts for: the brighter and the less ambiguous, the more."""
    return fit.gain * fit.margin**2


def _weighted_median(values: Array, weights: Array) -> float:
    order = np.argsort(values)
    total = np.cumsum(weights[order])
    return float(values[order[np.searchsorted(total, total[-1] / 2)]])


def _tables(
    shots: list[Shot], roughness: float, frequencies: Array, height: float
) -> list[LobeTable]:
    return [
        LobeTable.of(shot.weights, lobe_deviation(shot.radius, roughness), frequencies, height)
        for shot in shots
    ]


def _darkened(
    shots: list[Shot], tiling: Tiling, places: Array, highlight: float
) -> tuple[list[Shot], list[Array32]]:
    """The shots with what most of the sample shows as their background, and the noise about it.

    Most points are dark in each photograph, so that medians are of dark ones.
    """
    darkened, noise = [], []
    for shot in shots:
        look = [
            observed([shot], tiling, places[part], highlight)
            for part in strips(len(places), len(tiling.tiles()))
        ]
        seen = np.concatenate([strip.intensity[strip.usable] for strip in look])
        background = np.median(seen, axis=0)
        below = seen[:, :] < background
        deviation = [
            1.48 * np.median(background[c] - seen[below[:, c], c]) if below[:, c].any() else 0.0
            for c in range(seen.shape[1])
        ]
        darkened.append(replace(shot, background=background.astype(np.float32)))
        noise.append(np.array(deviation, np.float32))
    return darkened, noise


def _channel_weights(profile: MeanProfile, noise: list[Array32], shots: list[Shot]) -> Array32:
    """1 over the error of each channel at a lobe's peak, shape (photographs, channels)."""
    weights = []
    ρ = np.arange(profile.mean.shape[1])[:, None] * RADIUS_STEP
    for mean, count, dark, shot in zip(profile.mean, profile.count, noise, shots, strict=True):
        # A lobe's peak is ρπ/(√2π c) times the mean over orientations.
        many = min(MANY, MOST * count.max())
        brightest = np.max(np.where(count[:, None] >= many, ρ * mean, 0), axis=0)
        peak = brightest * np.sqrt(np.pi / 2) / lobe_deviation(shot.radius, ROUGHNESS)
        error = MODEL_ERROR * np.maximum(peak, DIM * peak.max())
        weights.append(1 / np.hypot(error, dark))
    return np.array(weights, np.float32)
