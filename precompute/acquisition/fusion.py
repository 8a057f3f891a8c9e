"""What a polarisation map lacks, from one flash photograph: where orientations begin, and µm.

Polarised light tells orientations up to one offset and periods up to one factor, both the same for
all of a foil. A flash photograph of the foil's tiles has few lit points, but all of them have to be
lit by the gratings that the map has there, once it is turned and scaled rightly: two numbers from
thousands of points. The offset comes first, since lobes lie along their grating's vector whatever
its period; then the scale, by the colours and distances at which they are lit; then both again,
more closely.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from precompute.acquisition.calibration import HIGHLIGHT
from precompute.acquisition.lobes import RADIUS_STEP, LobeTable, lobe_deviation
from precompute.acquisition.observations import Shot, observed
from precompute.acquisition.tiling import Tiling
from precompute.errors import InputError

Array = NDArray[np.float64]

MOST = 100_000
"""Observations that are looked at: every so-many-th texel of a map in all tiles."""

COARSE, FINE = np.radians(1.0), np.radians(0.1)
"""Steps of the offset: lobes are 3° wide or more, as seen from the highlight."""

STEP = 0.01
"""Of the logarithm of periods: lobes are 5 % wide or more; a parabola says what lies between."""

FREQUENCIES: Array = np.exp(np.arange(np.log(0.2), np.log(3.0), STEP))
"""1/a between which a map's gratings may lie, 1/µm."""

NEAR = 3.5
"""Deviations of a lobe beyond which it lights nothing: 0.2 % of its peak."""

ELSEWHERE = np.radians(10.0)
"""How far from the best offset the next best is looked for."""


@dataclass(frozen=True)
class Fusion:
    """What makes orientations and periods absolute.

    Attributes:
        offset: To be added to orientations, rad, 0 to π.
        scale: Periods in µm over relative ones.
        correlation: Of what the photograph shows and what the map would, no unit, 0 to 1.
        elsewhere: The ratio of the same, by directions alone, of the best offset at least 10° away
            to that of the offset taken: towards 1 the photograph does not tell.
    """

    offset: float
    scale: float
    correlation: float
    elsewhere: float


def fused(
    orientation: ArrayLike,
    period: ArrayLike,
    places: Array,
    shot: Shot,
    tiling: Tiling,
    height: float,
    roughness: float,
) -> Fusion:
    """Find offset and scale.

    Args:
        orientation: θ of the map's texels but for an offset, rad, shape (n,); NaN where unknown.
        period: a but for a factor, above 0, that shape or one number for all.
        places: Where the texels lie in a tile (`texel_places`), shape (n, 2).
        shot: The photograph.
        tiling: Where it has the foil's tiles; one alone does too.
        height: h0 of the gratings, µm.
        roughness: Standard deviation of the normal, rad.

    Raises:
        InputError: No texel is known, a period is not above 0, periods differ by more than
            gratings' do, or the photograph shows nothing of them beyond the highlight.
    """
    look = _Look.of(orientation, period, places, shot, tiling, roughness)
    table = LobeTable.of(shot.weights, look.deviation, FREQUENCIES, height)
    offsets = np.arange(0, np.pi, COARSE)
    by_direction = np.array([look.by_direction(offset) for offset in offsets])
    first = int(by_direction.argmax())
    offset = float(offsets[first])
    away = np.abs(np.mod(offsets - offset + np.pi / 2, np.pi) - np.pi / 2) >= ELSEWHERE
    # The longest and shortest scale for which all of the map's gratings are in the table.
    lowest, highest = (
        int(end) for end in (-look.index.min(), len(FREQUENCIES) - 1 - look.index.max())
    )
    if highest < lowest:
        ratio = float(np.exp(STEP * np.ptp(look.index)))
        raise InputError("fusion", "period", ratio, "longest over shortest below 15")
    shifts = np.arange(lowest, highest + 1)
    scale_shift = _peak(shifts, look.by_scale(offset, table))
    turns = np.arange(-2 * COARSE, 2 * COARSE + FINE / 2, FINE)
    offset = _peak(offset + turns, look.by_offset(round(scale_shift), table))
    scale_shift = _peak(shifts, look.by_scale(offset, table))
    return Fusion(
        offset=float(np.mod(offset, np.pi)),
        scale=float(np.exp(-STEP * scale_shift)) / float(FREQUENCIES[0]),
        correlation=look.by_scale(offset, table)(round(scale_shift)),
        elsewhere=float(max(by_direction[away].max(), 0) / by_direction[first]),
    )


@dataclass(frozen=True)
class _Look:
    """Observations of texels in all tiles.

    Attributes:
        orientation: Of the texel, rad, shape (N,).
        index: Where its frequency would be among `FREQUENCIES` if the scale were 1/`FREQUENCIES[0]`
            µm, shape (N,).
        angle: φ, rad.
        radius: ρ.
        shown: What is seen, each channel with mean 0 and standard deviation 1, shape (N, channels).
        deviation: Of a lobe in (u, v).
    """

    orientation: Array
    index: NDArray[np.intp]
    angle: Array
    radius: Array
    shown: Array
    deviation: float

    @staticmethod
    def of(
        orientation: ArrayLike,
        period: ArrayLike,
        places: Array,
        shot: Shot,
        tiling: Tiling,
        roughness: float,
    ) -> _Look:
        θ, a = np.broadcast_arrays(np.asarray(orientation, float), np.asarray(period, float))
        known = np.flatnonzero(np.isfinite(θ) & np.isfinite(a))
        if known.size == 0:
            raise InputError("fusion", "orientation", "no texel is known", "one, or more")
        if a[known].min() <= 0:
            raise InputError("fusion", "period", float(a[known].min()), "above 0")
        some = known[:: max(1, -(-known.size * len(tiling.tiles()) // MOST))]
        deviation = lobe_deviation(shot.radius, roughness)
        strip = observed([shot], tiling, places[some], HIGHLIGHT * deviation)
        texel, tile = np.nonzero(strip.usable)
        shown = strip.intensity[texel, tile].astype(float)
        spread = shown.std(axis=0) if len(shown) else np.zeros(1)
        if not np.all(spread > 0):
            found = "nothing but one brightness beyond the highlight"
            raise InputError("fusion", shot.name, found, "a foil's lit and dark points")
        u, v = (part[texel, tile].astype(float) for part in (strip.u, strip.v))
        return _Look(
            orientation=θ[some][texel],
            index=np.round(-np.log(a[some][texel]) / STEP).astype(np.intp),
            angle=np.arctan2(v, u),
            radius=np.hypot(u, v),
            shown=(shown - shown.mean(axis=0)) / spread,
            deviation=deviation,
        )

    def by_direction(self, offset: float) -> float:
        """Correlation of brightness with lobes of all colours along gratings' vectors."""
        lit, across = self._lit(offset)
        brightness = self.shown.sum(axis=1, keepdims=True)
        return self._correlation(across[:, None], (brightness / brightness.std())[lit])

    def by_scale(self, offset: float, table: LobeTable) -> Callable[[float], float]:
        """Correlation of colours with those of lobes, by how far frequencies are along."""
        lit, across = self._lit(offset)
        place = np.minimum(np.round(self.radius[lit] / RADIUS_STEP), table.values.shape[1] - 1)
        index, place, shown = self.index[lit], place.astype(np.intp), self.shown[lit]

        def correlation(shift: float) -> float:
            lobe = table.values[index + int(shift), place].astype(float)
            return self._correlation(lobe * across[:, None], shown)

        return correlation

    def by_offset(self, shift: int, table: LobeTable) -> Callable[[float], float]:
        """Likewise, by offset."""
        return lambda offset: self.by_scale(offset, table)(shift)

    def _lit(self, offset: float) -> tuple[NDArray[np.intp], Array]:
        """Which observations may be lit, and a lobe's share of its peak there."""
        away = self.radius * np.sin(self.angle - self.orientation - offset) / self.deviation
        lit = np.flatnonzero(np.abs(away) < NEAR)
        return lit, np.exp(-(away[lit] ** 2) / 2)

    def _correlation(self, predicted: Array, shown: Array) -> float:
        """Of all observations, all but those given being predicted dark; the channels' mean.

        Args:
            predicted: Shape (some, channels).
            shown: That shape, of what over all has mean 0 and standard deviation 1.
        """
        count = len(self.radius)
        variance = np.sum(predicted**2, axis=0) / count - (predicted.sum(axis=0) / count) ** 2
        together = np.sum(predicted * shown, axis=0) / count
        apart = np.sqrt(np.maximum(variance, 0))
        return float(np.mean(np.divide(together, apart, out=np.zeros_like(apart), where=apart > 0)))


def _peak(places: NDArray[np.number], value: Callable[[float], float]) -> float:
    """Where a function is largest, by a parabola through the largest of evenly spaced values."""
    values = np.array([value(float(place)) for place in places])
    best = int(values.argmax())
    if best in (0, len(values) - 1):
        return float(places[best])
    before, here, after = values[best - 1 : best + 2]
    bend = before - 2 * here + after
    move = 0.0 if bend == 0 else (before - after) / (2 * bend)
    return float(places[best] + move * (places[1] - places[0]))
