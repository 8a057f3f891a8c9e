"""Height fields of one's own making, each exactly periodic.

Flanks have a width, since a step in height is a phase that no pitch resolves: steps become straight
or smooth edges. Unless a pitch is asked for, it follows from the steepest place.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from precompute.height_fields.field import HeightField
from precompute.height_fields.recipe import (
    Blazed,
    Bumps,
    Cosine,
    Fingers,
    Generated,
    Pits,
    Roughness,
)
from precompute.height_fields.sampling import QUARTER_WAVE, grid_size, refuse_large

Array = NDArray[np.float64]

LARGEST_PITCH = 0.05
"""µm: about half of what theory allows, so that what is aliased is what no light can carry off."""

MARGIN = 0.8
"""Share of the steepest slope allowed at the pitch that a field chooses for itself."""


def generated(source: Generated, pitch: float | None = None) -> HeightField:
    """The field of a source.

    Args:
        source: Which field, and its parameters.
        pitch: Largest distance between samples, µm; by default fine enough for the steepest place.

    Raises:
        InputError: The patch would have too many samples.

    >>> generated(Cosine(height=0.2)).amplitude
    0.1
    """
    match source:
        case Bumps():
            return bumps(source, pitch)
        case Blazed():
            return blazed(source, pitch)
        case Cosine():
            return cosine(source, pitch)
        case Pits():
            return pits(source, pitch)
        case Fingers():
            return fingers(source, pitch)
        case Roughness():
            return roughness(source, pitch)


def bumps(source: Bumps, pitch: float | None = None) -> HeightField:
    """One smooth bump in the middle of the cell.

    Args:
        source: What to make.
        pitch: Largest distance between samples, µm; by default fine enough for the steepest place.
    """

    def heights(x: Array, y: Array) -> Array:
        along_x = _raised_cosine((x - source.cell[0] / 2) / source.size[0])
        along_y = _raised_cosine((y - source.cell[1] / 2) / source.size[1])
        return source.height * along_y[:, None] * along_x

    # cos² falls by π/size at most.
    steepest = np.pi * source.height / min(source.size)
    return _sampled(source, source.cell, steepest, pitch, heights)


def blazed(source: Blazed, pitch: float | None = None) -> HeightField:
    """A sawtooth: p = ξ/(1 − e) up to 1 − e, then straight back to 0, e being edge/period.

    Args:
        source: What to make.
        pitch: Largest distance between samples, µm; by default fine enough for the steepest place.
    """
    corner = source.period - source.edge

    def heights(x: Array, y: Array) -> Array:
        profile = np.where(x < corner, x / corner, (source.period - x) / source.edge)
        return source.height * np.tile(profile, (len(y), 1))

    steepest = source.height / min(source.edge, corner)
    return _sampled(source, (source.period, source.period), steepest, pitch, heights)


def cosine(source: Cosine, pitch: float | None = None) -> HeightField:
    """h = height·(1 + cos 2πx/period)/2, the profile ``sinusoidal`` of gratings.

    Args:
        source: What to make.
        pitch: Largest distance between samples, µm; by default fine enough for the steepest place.
    """

    def heights(x: Array, y: Array) -> Array:
        profile = (1 + np.cos(2 * np.pi * x / source.period)) / 2
        return source.height * np.tile(profile, (len(y), 1))

    steepest = np.pi * source.height / source.period
    return _sampled(source, (source.period, source.period), steepest, pitch, heights)


def pits(source: Pits, pitch: float | None = None) -> HeightField:
    """Tracks of pits; the same pits at whatever pitch.

    Args:
        source: What to make.
        pitch: Largest distance between samples, µm; by default fine enough for the steepest place.
    """
    rng = np.random.default_rng(source.seed)
    length = source.bits * source.channel_bit
    period = (source.tracks * source.track_pitch, length)
    ends = [_pit_ends(source, rng) * source.channel_bit for _ in range(source.tracks)]

    def heights(x: Array, y: Array) -> Array:
        relief = np.zeros((len(y), len(x)))
        for track, (begin, end) in enumerate(ends):
            middle = (track + 0.5) * source.track_pitch
            across = _trench(_wrapped(x - middle, period[0]), source.width, source.edge)
            away = _wrapped(y[:, None] - (begin + end) / 2, length)
            along = _trench(away, end - begin, source.edge).sum(axis=1)
            relief -= source.depth * along[:, None] * across
        return relief

    steepest = np.pi * source.depth / (2 * source.edge)
    return _sampled(source, period, steepest, pitch, heights)


def fingers(source: Fingers, pitch: float | None = None) -> HeightField:
    """Rounded ridges that widen from tail to tip, the highest one showing where they overlap.

    About the line from tail to tip a ridge of height H is H·cos²(πd/2r), where d is the distance
    from that line and r the ridge's radius there.

    Args:
        source: What to make.
        pitch: Largest distance between samples, µm; by default fine enough for the steepest place.
    """
    rng = np.random.default_rng(source.seed)
    period = (source.columns * source.length, source.rows * source.spacing)
    count = source.columns * source.rows
    column, row = np.divmod(np.arange(count), source.rows)
    strewn = source.jitter * rng.uniform(-1, 1, (3, count))
    tip_x = (column + 1 + strewn[0]) * source.length
    tip_y = (row + 0.5 + strewn[1] / 2) * source.spacing
    height = source.height * (1 + strewn[2])
    # Lengths and tilts vary too; with the tip's radius a ridge reaches under the next column.
    reach = source.length * rng.uniform(0.8, 1, count)
    tilt = source.jitter * source.spacing / source.length * rng.uniform(-1, 1, count)
    tip_radius = 0.75 * source.spacing
    tail_radius = 0.4 * source.spacing

    def heights(x: Array, y: Array) -> Array:
        relief = np.zeros((len(y), len(x)))
        for i in range(count):
            # Only the samples near the ridge; an index past the patch's edge comes in again.
            near_x = _near(x, tip_x[i] - reach[i] / 2, reach[i] / 2 + tip_radius)
            near_y = _near(y, tip_y[i], reach[i] * abs(np.sin(tilt[i])) + tip_radius)
            # About its middle: the ridge is shorter than the patch, its distance to the tip not.
            dx = _wrapped(x[near_x] - tip_x[i] + reach[i] / 2, period[0]) - reach[i] / 2
            dy = _wrapped(y[near_y] - tip_y[i], period[1])[:, None]
            along = np.cos(tilt[i]) * dx + np.sin(tilt[i]) * dy  # 0 at the tip, −reach at the tail
            share = np.clip(along / reach[i] + 1, 0, 1)
            off_the_end = along - (share - 1) * reach[i]
            distance = np.hypot(off_the_end, np.cos(tilt[i]) * dy - np.sin(tilt[i]) * dx)
            radius = tail_radius + (tip_radius - tail_radius) * share
            patch = np.ix_(near_y, near_x)
            ridge = height[i] * _raised_cosine(distance / (2 * radius))
            relief[patch] = np.maximum(relief[patch], ridge)
        return relief

    # πH/2r across the tail; its widening adds less than a tenth.
    steepest = 1.1 * np.pi * source.height * (1 + source.jitter) / (2 * tail_radius)
    return _sampled(source, period, steepest, pitch, heights)


def roughness(source: Roughness, pitch: float | None = None) -> HeightField:
    """A random surface of the power spectrum exp(−π²ℓ²f²), the transform of exp(−r²/ℓ²).

    The Fourier coefficients are drawn in one order up to where they vanish, so that the surface is
    the same at whatever pitch resolves it.

    Args:
        source: What to make.
        pitch: Largest distance between samples, µm; by default fine enough for the steepest place.
    """
    rng = np.random.default_rng(source.seed)
    # exp(−π²ℓ²f²/2), the amplitude, is 1e-8 at f = 6.07/(πℓ).
    highest = int(np.ceil(6.07 / (np.pi * source.correlation) * source.period))
    refuse_large(source.kind, 2 * highest + 1, 2 * highest + 1)
    order = np.arange(-highest, highest + 1)
    f = order / source.period
    amplitude = np.exp(-((np.pi * source.correlation) ** 2) * (f[:, None] ** 2 + f**2) / 2)
    shape = amplitude.shape
    coefficients = amplitude * (rng.standard_normal(shape) + 1j * rng.standard_normal(shape))
    coefficients[highest, highest] = 0

    def heights(x: Array, y: Array) -> Array:
        # Sums of waves by matrices: any pitch, and no transform to pad.
        waves_x = np.exp(2j * np.pi * np.outer(f, x))
        waves_y = np.exp(2j * np.pi * np.outer(y, f))
        relief = (waves_y @ coefficients @ waves_x).real
        return relief * (source.rms / np.sqrt(np.mean(relief**2)))

    # Of one axis the slope deviates by √2·rms/ℓ; both together exceed six of it once in 7e7.
    steepest = 6 * np.sqrt(2) * source.rms / source.correlation
    return _sampled(source, (source.period, source.period), steepest, pitch, heights)


def _sampled(
    source: Generated,
    period: tuple[float, float],
    steepest: float,
    pitch: float | None,
    heights: Callable[[Array, Array], Array],
) -> HeightField:
    """A field of the given period and steepest slope, from its heights at x and y."""
    chosen = pitch or min(LARGEST_PITCH, MARGIN * QUARTER_WAVE / steepest)
    columns, rows = (grid_size(length, chosen) for length in period)
    refuse_large(source.kind, rows, columns)
    spacing = (period[0] / columns, period[1] / rows)
    x, y = np.arange(columns) * np.float64(spacing[0]), np.arange(rows) * np.float64(spacing[1])
    return HeightField(heights(x, y), spacing)


def _raised_cosine(position: Array) -> Array:
    """cos²(πx), from 1 at the middle to 0 at ±½ and beyond."""
    return np.cos(np.pi * np.clip(position, -0.5, 0.5)) ** 2


def _trench(distance: Array, width: Array | float, edge: float) -> Array:
    """1 inside a trench about 0, 0 outside, ½ at half its width, with flanks of a half cosine."""
    beyond = np.clip((np.abs(distance) - width / 2) / edge, -0.5, 0.5)
    return (1 - np.sin(np.pi * beyond)) / 2


def _wrapped(distance: Array, period: float) -> Array:
    """The distance to the nearest of the repeats, in [−period/2, period/2)."""
    return np.mod(distance + period / 2, period) - period / 2


def _near(positions: Array, middle: float, reach: float) -> NDArray[np.intp]:
    """Indices of periodic samples no farther than `reach` from `middle`, each once."""
    period = len(positions) * positions[1]
    return np.flatnonzero(np.abs(_wrapped(positions - middle, period)) <= reach)


def _pit_ends(source: Pits, rng: np.random.Generator) -> Array:
    """Where the pits of a track begin and end, channel bits, shape (2, pits)."""
    shortest, longest = source.runs
    lengths = np.arange(shortest, longest + 1)
    # Runs of n bits carry the most information a bit with shares D^−n that sum to one; D is the
    # only positive root of D^longest = Σ D^(longest−n), and the largest of all.
    polynomial = np.concatenate([[1], np.zeros(shortest - 1), -np.ones(len(lengths))])
    shares = np.roots(polynomial).real.max() ** -lengths.astype(np.float64)
    shares /= shares.sum()
    while True:
        # Until runs close the track: about one draw in twice the mean run does.
        ends = np.cumsum(rng.choice(lengths, size=source.bits // shortest + 1, p=shares))
        closing = np.flatnonzero(ends == source.bits)
        if len(closing) and closing[0] % 2 == 1:  # as many pits as lands
            ends = ends[: closing[0] + 1] + rng.uniform(0, source.bits)
            return np.stack([ends[0::2], ends[1::2]])
