"""The gratings that explain what a strip of texels shows: a lobe fitted to lit and dark alike.

For a grating (θ, 1/a) of strength s the photographs should show s·M. With equal noise everywhere
the best one has the largest gain 2s Σ I M − s² Σ M² over showing nothing: bright observations pull
the lobe towards them, dark ones push it away, which one bright observation alone cannot tell.
"""

from __future__ import annotations

from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from os import cpu_count

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from precompute.acquisition.lobes import RADIUS_STEP, Array32, LobeTable, at_radius
from precompute.acquisition.observations import Shot, Strip, observed, strips
from precompute.acquisition.tiling import Tiling
from precompute.progress import tracked

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

REACH = 3.5
"""Half width of a lobe in standard deviations: beyond it is 0.2 % of its peak."""

WIDER = 1.3
"""How much further than a lobe reaches refinement looks, since the lobe moves."""

CANDIDATES = 4
"""Orientations of which a strip looks for periods and refines the best."""

SPACING = 0.5
"""Between orientations that are tried, standard deviations of the narrowest first orders."""

MIDDLE_UM = 0.55
"""Wavelength at which first orders are brightest, about."""

SHORT = 0.95
"""Share of the sample whose periods are no shorter than those that steps are made for."""

APART = np.radians(6)
"""Least distance between candidates: two to three standard deviations of a lobe."""

GAP = np.radians(5)
"""Standard deviation with which orientations that show nothing are blurred to find their middle."""

DARK = 0.01
"""Share of a lobe's peak below which an observation counts as dark: 3 standard deviations off."""

LIT = 1.0
"""Errors, as `Model.channel_weights` count them, from which an observation is certainly lit."""

RAREST = 1e-3
"""How common a period is at least taken to be, over the commonest."""

STEPS = 4
"""Of refinement; each about halves or better the distance to the best orientation."""


@dataclass(frozen=True)
class Model:
    """What gratings are expected to show in each photograph.

    Attributes:
        tables: A lobe's profiles for each photograph, all for the same frequencies.
        shares: How common each frequency is on the sample, summing to 1, shape (F,).
        strength: s of a point all of which diffracts.
        channel_weights: 1 over the error of each channel at a lobe's peak, shape
            (photographs, channels).
        strongest: The largest s that may be found, over `strength`.
    """

    tables: list[LobeTable]
    shares: Array
    strength: float
    channel_weights: Array32
    strongest: float = 1.0


@dataclass(frozen=True)
class Fit:
    """What was found at each texel, arrays of shape (n,).

    Attributes:
        orientation: θ in [0, π).
        frequency: 1/a, 1/µm.
        strength: s over that of a point all of which diffracts.
        gain: How much better than showing nothing, over a lobe's whole energy at its peak.
        margin: 1 − the gain of the next best orientation over the best.
        least_seen: The orientation about which least would have been shown.
        least: The least that any would have shown: its energy over that of a lobe at its peak.
        shown: The energy of all that is lit, over that.
    """

    orientation: Array
    frequency: Array
    strength: Array
    gain: Array
    margin: Array
    least_seen: Array
    least: Array
    shown: Array

    @staticmethod
    def joined(parts: Iterable[Fit]) -> Fit:
        """The fits of strips one after the other."""
        columns = zip(*(vars(part).values() for part in parts), strict=True)
        return Fit(*(np.concatenate(column) for column in columns))


def fit_strip(strip: Strip, model: Model) -> Fit:
    """Fit a grating to each texel.

    Args:
        strip: Observations of n texels.
        model: What gratings show.

    Returns:
        The best grating of each; where nothing is lit, gain 0.
    """
    whitened = _Whitened.of(strip, model)
    scores, energy, angles = _scan(whitened, model)
    # Several orientations show nothing where one does: the middle one is meant.
    blurred = gaussian_filter1d(energy, GAP / (np.pi / len(angles)), axis=1, mode="wrap")
    hidden = np.argmin(blurred, axis=1)
    lit = np.abs(whitened.intensity) > LIT
    candidates, gains = _peaks(scores, angles)
    index = np.zeros(candidates.shape, np.intp)
    if len(model.shares) > 1:
        for number, θ in enumerate(candidates):
            index[number], gains[number] = _with_period(whitened, model, θ)
    order = np.argsort(-gains, axis=0)
    orientation, index, second = (
        np.take_along_axis(values, order, axis=0)[rank]
        for values, rank in ((candidates, 0), (index, 0), (gains, 1))
    )
    orientation, place, strength, gain = _refined(whitened, model, orientation, index)
    frequencies = model.tables[0].frequencies
    return Fit(
        np.mod(orientation, np.pi),
        np.exp(np.interp(place, np.arange(len(frequencies)), np.log(frequencies))),
        strength / model.strength,
        gain / peak_energy(model),
        np.where(gain > 0, 1 - np.clip(second / np.maximum(gain, 1e-30), 0, 1), 0),
        angles[hidden].astype(np.float64),
        energy.min(axis=1).astype(np.float64) * (model.strength**2 / peak_energy(model)),
        np.sum(np.where(lit, whitened.intensity**2, 0), axis=(1, 2)) / peak_energy(model),
    )


def fit_texels(
    shots: list[Shot], tiling: Tiling, places: Array, highlight: float, model: Model, name: str
) -> Fit:
    """Fit a grating to each of many texels, strip by strip on all cores.

    Args:
        shots: The photographs.
        tiling: Where the tiles are.
        places: Of the texels in a tile, shape (n, 2).
        highlight: ρ, no unit, below which nothing is observed.
        model: What gratings show.
        name: What the progress bar says.
    """

    def fitted(part: slice) -> Fit:
        return fit_strip(observed(shots, tiling, places[part], highlight), model)

    parts = list(strips(len(places), len(tiling.tiles()) * len(shots)))
    with ThreadPoolExecutor(cpu_count()) as pool:
        try:
            return Fit.joined(tracked(pool.map(fitted, parts), name, len(parts)))
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise


def predicted(strip: Strip, model: Model, fit: Fit) -> Array32:
    """What gratings show in a strip: radiance over irradiance, shape (n, J, channels)."""
    deviation = np.array([table.deviation for table in model.tables], np.float32)
    whitened = _Whitened.of(strip, model)
    rows, columns, _ = _near(whitened, fit.orientation.astype(np.float32), deviation)
    picked = _Picked(whitened, deviation, rows, columns, len(fit.orientation))
    frequencies = np.log(model.tables[0].frequencies)
    place = np.interp(np.log(fit.frequency), frequencies, np.arange(len(frequencies)))
    strength = (model.strength * fit.strength)[rows, None]
    result = np.zeros_like(strip.intensity)
    shown = strength * picked.expected(fit.orientation, place)
    result[rows, columns] = shown / model.channel_weights[strip.shot[columns]]
    return result


@dataclass(frozen=True)
class _Whitened:
    """A strip whose channels count alike."""

    intensity: Array32
    u: Array32
    v: Array32
    radius: Array32
    usable: NDArray[np.bool_]
    shot: Indices
    tables: list[Array32]
    by_radius: Array32  # the tables as (channels, photographs, radii, F)
    power: Array32  # Σ over channels of their squares, (photographs, radii, F)

    @staticmethod
    def of(strip: Strip, model: Model) -> _Whitened:
        intensity = strip.intensity * model.channel_weights[strip.shot]
        tables = [
            table.values * weight
            for table, weight in zip(model.tables, model.channel_weights, strict=True)
        ]
        radius = np.hypot(strip.u, strip.v)
        by_radius = np.ascontiguousarray(np.stack(tables).transpose(3, 0, 2, 1))
        return _Whitened(
            intensity,
            strip.u,
            strip.v,
            radius,
            strip.usable,
            strip.shot,
            tables,
            by_radius,
            np.sum(by_radius**2, axis=0),
        )


def _scan(strip: _Whitened, model: Model) -> tuple[Array32, Array32, Array32]:
    """Gains over orientation for gratings of the sample's mean period.

    Returns:
        The gains, and Σ M², both of shape (n, angles), and the angles.
    """
    deviations = np.array([table.deviation for table in model.tables], np.float32)
    angles = int(np.ceil(np.pi / (SPACING * _narrowest(model))))
    n = len(strip.u)
    match = np.zeros((n, angles), np.float32)
    energy = np.zeros((n, angles), np.float32)
    for number, table in enumerate(strip.tables):
        profile = np.tensordot(model.shares, table, 1).astype(np.float32)
        rows, columns = np.nonzero(strip.usable & (strip.shot == number))
        expected = at_radius(profile, strip.radius[rows, columns])
        seen = np.einsum("kc,kc->k", strip.intensity[rows, columns], expected)
        full = np.einsum("kc,kc->k", expected, expected)
        for total, values, power, counts in (
            (match, seen, 1, seen > DARK * model.strength * full),
            (energy, full, 2, full > DARK * full.max(initial=0)),
        ):
            lobes = _Lobes(strip, rows[counts], columns[counts], deviations[number], angles)
            lobes.add(total, values[counts], power)
    gains = _gain(match, energy, model.strength * model.strongest)
    return gains, energy, np.arange(angles, dtype=np.float32) * np.float32(np.pi / angles)


def _narrowest(model: Model) -> float:
    """Standard deviation over orientation of the lobes of all but the rarest short periods, rad."""
    deviation = min(table.deviation for table in model.tables)
    highest = np.interp(SHORT, np.cumsum(model.shares), model.tables[0].frequencies)
    return float(deviation / (MIDDLE_UM * highest))


class _Lobes:
    """Lobes over orientation about the directions in which observations lie."""

    def __init__(
        self, strip: _Whitened, rows: Indices, columns: Indices, deviation: np.float32, angles: int
    ) -> None:
        angle = np.arctan2(strip.v[rows, columns], strip.u[rows, columns])
        self.step = np.float32(np.pi / angles)
        self.rows = rows
        self.nearest = np.round(angle / self.step).astype(np.int32)
        self.within = angle - self.nearest * self.step
        self.across = strip.radius[rows, columns] / deviation

    def add(self, total: Array32, values: Array32, power: int) -> None:
        """Add values times a power of the lobes to the rows of `total`, shape (n, angles)."""
        angles = total.shape[1]
        limit = np.float32(REACH / np.sqrt(power))
        nearest = limit / float(self.across.min(initial=np.inf)) / float(self.step)
        reach = min(int(np.ceil(nearest)), angles // 2)
        keys, lobes = [], []
        for offset in range(-reach, reach + 1):
            far = self.across * (offset * self.step - self.within)
            close = np.flatnonzero(np.abs(far) < limit)
            lobes.append(np.exp(-power * far[close] ** 2 / 2) * values[close])
            keys.append(self.rows[close] * angles + (self.nearest[close] + offset) % angles)
        summed = np.bincount(np.concatenate(keys), np.concatenate(lobes), total.size)
        total += summed.reshape(total.shape)


def _gain(match: Array32, energy: Array32, strongest: float) -> Array32:
    """2s·match − s²·energy for the best s that is no stronger than can be."""
    s = (match / np.maximum(energy, 1e-30)).clip(0, np.float32(strongest))
    return s * (2 * match - s * energy)


def _peaks(scores: Array32, angles: Array32) -> tuple[Array32, Array32]:
    """The best orientations of each texel, apart from each other, best first, and their gains."""
    left, count = scores.copy(), len(angles)
    texels = np.arange(len(scores))
    apart = int(np.ceil(APART / (np.pi / count)))
    found, gains = [], []
    for _ in range(CANDIDATES):
        best = np.argmax(left, axis=1)
        found.append(angles[best])
        gains.append(np.maximum(left[texels, best], 0))
        for offset in range(-apart, apart + 1):
            left[texels, (best + offset) % count] = -1
    return np.stack(found), np.stack(gains)


def _near(strip: _Whitened, θ: Array32, deviation: Array32) -> tuple[Indices, Indices, Array32]:
    """Usable observations near the lines at θ: texels, columns, and how far off in deviations."""
    across = strip.v * np.cos(θ)[:, None] - strip.u * np.sin(θ)[:, None]
    across /= deviation[strip.shot]
    rows, columns = np.nonzero(strip.usable & (np.abs(across) < REACH))
    return rows, columns, across[rows, columns]


def _with_period(strip: _Whitened, model: Model, θ: Array32) -> tuple[Indices, Array32]:
    """The best frequency at a given orientation: its index and the gain, shape (n,) each."""
    deviation = np.array([table.deviation for table in model.tables], np.float32)
    rows, columns, across = _near(strip, θ, deviation)
    lobe = np.exp(-(across**2) / 2)
    place = np.round(strip.radius[rows, columns] / RADIUS_STEP).astype(np.intp)
    place = np.minimum(place, strip.power.shape[1] - 1)
    index = (strip.shot[columns], place)
    energy = (lobe**2)[:, None] * strip.power[index]
    match = np.zeros_like(energy)
    for channel, table in enumerate(strip.by_radius):
        match += (lobe * strip.intensity[rows, columns, channel])[:, None] * table[index]
    match, energy = (_summed(values, rows, len(θ)) for values in (match, energy))
    gains = _gain(match, energy, model.strength * model.strongest)
    # Twice a logarithm of likelihood is a gain: what few have needs more to be believed.
    gains += np.float32(2) * np.log(_commonness(model.shares)).astype(np.float32)
    best = np.argmax(gains, axis=1)
    return best, np.maximum(gains[np.arange(len(θ)), best], 0)


def _commonness(shares: Array) -> Array:
    """How common frequencies like each are, over the commonest, none below `RAREST`."""
    smooth = gaussian_filter1d(shares, 2.0)
    return np.maximum(smooth / smooth.max(), RAREST)


def _summed(values: Array32, rows: Indices, n: int) -> Array32:
    """Sums of the values (k, F) of each row, the rows being in order: shape (n, F)."""
    result = np.zeros((n, values.shape[1]), np.float32)
    if len(rows):
        starts = np.flatnonzero(np.diff(rows, prepend=-1))
        result[rows[starts]] = np.add.reduceat(values, starts, axis=0)
    return result


def _refined(
    strip: _Whitened, model: Model, θ: Array32, frequency: Indices
) -> tuple[Array, Array, Array, Array]:
    """Orientation and place among the frequencies between the steps of the search.

    Gauss and Newton's steps on the squared distance between what is seen and s·M, each taken where
    it improves the gain.

    Returns:
        θ, place, s and the gain, shape (n,) each.
    """
    deviation = np.array([table.deviation for table in model.tables], np.float32)
    rows, columns, _ = _near(strip, θ, deviation * np.float32(WIDER))
    picked = _Picked(strip, deviation, rows, columns, len(θ))
    last = len(strip.tables[0]) - 1
    angle, place = θ.astype(np.float64), frequency.astype(np.float64)
    strongest = model.strength * model.strongest
    shown = picked.expected(angle, place)
    strength, gain = picked.explained(shown, strongest)
    turn, shift = np.float64(1e-3), 0.05
    for _ in range(STEPS):
        slopes = [(picked.expected(angle + turn, place) - shown) / turn]
        if last > 0:
            ahead = np.where(place + shift <= last, shift, -shift)
            slopes.append(
                (picked.expected(angle, place + ahead) - shown) / ahead[picked.rows, None]
            )
        steps = picked.steps(shown, slopes, strength)
        steps = np.clip(steps, [[-0.05], [-2.0]][: len(slopes)], [[0.05], [2.0]][: len(slopes)])
        new_angle = angle + steps[0]
        new_place = np.clip(place + steps[1], 0, last) if last > 0 else place
        new_shown = picked.expected(new_angle, new_place)
        new_strength, new_gain = picked.explained(new_shown, strongest)
        better = new_gain > gain
        angle, place = np.where(better, new_angle, angle), np.where(better, new_place, place)
        strength, gain = np.where(better, new_strength, strength), np.where(better, new_gain, gain)
        shown = np.where(better[picked.rows, None], new_shown, shown)
    return angle, place, strength, gain


class _Picked:
    """Observations near a lobe, in one list, and sums of it by texel."""

    def __init__(
        self, strip: _Whitened, deviation: Array32, rows: Indices, columns: Indices, n: int
    ) -> None:
        self.rows, self.n = rows, n
        self.intensity = strip.intensity[rows, columns]
        self.u, self.v = strip.u[rows, columns], strip.v[rows, columns]
        self.shot = strip.shot[columns]
        self.deviation = deviation[self.shot]
        self.tables = strip.tables

    def expected(self, angle: Array, place: Array) -> Array:
        """M at each observation, for θ and a place among the frequencies at each texel."""
        θ = angle[self.rows]
        across = (self.v * np.cos(θ) - self.u * np.sin(θ)) / self.deviation
        along = np.abs(self.u * np.cos(θ) + self.v * np.sin(θ))
        lobe = np.exp(-(across**2) / 2)
        result = np.zeros(self.intensity.shape)
        for number, table in enumerate(self.tables):
            here = np.flatnonzero(self.shot == number)
            i, x = _between(place[self.rows[here]], len(table))
            k, y = _between(along[here] / RADIUS_STEP, table.shape[1])
            result[here] = (1 - x) * ((1 - y) * table[i, k] + y * table[i, k + 1])
            if len(table) > 1:
                result[here] += x * ((1 - y) * table[i + 1, k] + y * table[i + 1, k + 1])
        return result * lobe[:, None]

    def explained(self, shown: Array, strongest: float) -> tuple[Array, Array]:
        """The strength at each texel, and the gain."""
        match = self._sum(shown, self.intensity)
        energy = self._sum(shown, shown)
        s = np.clip(match / np.maximum(energy, 1e-30), 0, strongest)
        return s, s * (2 * match - s * energy)

    def steps(self, shown: Array, slopes: list[Array], strength: Array) -> Array:
        """Gauss and Newton's step of each parameter, its normal equations lightly damped."""
        s = strength[self.rows, None]
        rest = self.intensity - s * shown
        slopes = [s * slope for slope in slopes]
        right = np.stack([self._sum(slope, rest) for slope in slopes], axis=-1)
        normal = np.stack(
            [np.stack([self._sum(a, b) for a in slopes], axis=-1) for b in slopes],
            axis=-1,
        )
        diagonal = np.einsum("nii->ni", normal)
        diagonal *= 1.05
        diagonal += 1e-30
        return np.linalg.solve(normal, right[..., None])[..., 0].T.astype(np.float64)

    def _sum(self, a: Array, b: Array | Array32) -> Array:
        """Σ over observations and channels of a·b at each texel."""
        return np.bincount(self.rows, np.einsum("kc,kc->k", a, b), self.n).astype(np.float64)


def _between(place: Array, count: int) -> tuple[Indices, Array]:
    """The number below a place on a grid of so many, and the share of the one above, (k, 1)."""
    below = np.floor(place).astype(np.intp).clip(0, max(count - 2, 0))
    return below, (np.minimum(place, count - 1) - below)[:, None]


def peak_energy(model: Model) -> float:
    """s²·M², no unit, where a grating of the commonest frequency is brightest."""
    profiles = [
        np.tensordot(model.shares, table.values * weight, 1)
        for table, weight in zip(model.tables, model.channel_weights, strict=True)
    ]
    return float(model.strength**2 * max(np.max(np.sum(p**2, axis=1)) for p in profiles))
