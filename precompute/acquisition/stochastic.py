"""The distribution of a stochastic foil's gratings from a filtered photograph (2018 paper, 4.5).

The paper collects orientation and period of all lit points. Here the mean brightness in each
direction is unfolded instead, which knows that a lobe lights points all about its middle, that
light of the second order is none of half the period, that fewer points look where pictures end,
and that as many gratings make a ring the fainter, the wider it is.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from precompute.acquisition.calibration import HIGHLIGHT
from precompute.acquisition.densities import (
    Lobes,
    MeanLight,
    deconvolved,
    log_likelihood,
    seen_shares,
)
from precompute.acquisition.lobes import lobe_deviation
from precompute.acquisition.observations import Shot, half_vectors
from precompute.acquisition.shots import ROUGHNESS
from precompute.errors import InputError
from precompute.foils.distribution import GratingDistribution
from precompute.progress import tracked
from precompute.spectra import WAVELENGTHS

Array = NDArray[np.float64]
Method = Literal["deconvolution", "threshold"]

ORIENTATIONS = 90
"""Cells over θ, of 2°."""

FREQUENCY_STEP = 0.01
"""Of cells over 1/a, 1/µm: in (u, v) a third of a narrow lobe's standard deviation."""

STEPS = 60
"""Of iteration."""

BLURS = (0.3, 0.5, 0.75, 1.0, 1.5, 2.0)
"""Of the estimate, in cells; the more shapes are lit, the less is best."""

PATCH = 4.0
"""Side of the squares, mm, by which a sample is parted into halves: wider than shapes."""

SEEN = 0.5
"""Share of a grating's light that has to fall where it was looked for."""

BANDWIDTH = 0.05
"""Relative standard deviation of the wavelengths that are seen, most: a filter of 62 nm at 530."""

EVEN = 2.0
"""Brightest hundredth over the median, least: paper has less."""

CERTAIN = 8.0
"""The same above the median, over the spread of what is below."""

LIT = 0.4
"""Of the brightest thousandth: what is lit for the seed's method. Of 0.05 to 0.6 this serves it
best on the spiral: less takes dimmer second orders for periods, more leaves few points."""

AT_ONCE = 1 << 20
"""Pixels of one piece: some 200 MB."""


@dataclass(frozen=True)
class Estimated:
    """What photographs say of a foil's gratings.

    Attributes:
        distribution: The estimate; 0 where nothing was seen.
        seen: Share of each cell's light that fell where it was looked for, of the weights' shape.
    """

    distribution: GratingDistribution
    seen: Array

    @property
    def covered(self) -> float:
        """Share of the cells that could be seen, had there been gratings."""
        return float(np.mean(self.seen >= SEEN))


def estimate_distribution(
    shots: list[Shot],
    size_mm: tuple[float, float],
    height: float = 0.15,
    method: Method = "deconvolution",
    steps: int = STEPS,
) -> Estimated:
    """The joint distribution of orientation and spatial frequency.

    Args:
        shots: Photographs of a narrow band of wavelengths, usually one; of several, lamps are
            taken as equally strong.
        size_mm: Of the sample.
        height: h0 of the gratings, µm, which says how bright the second order is.
        method: ``threshold`` is the paper's: the set of lit points.
        steps: Number of iterations.

    Raises:
        InputError: Photographs are of many wavelengths; no point of the sample is in them but the
            highlight; or nothing is lit that stands out.
    """
    wavelengths = [_wavelength(shot) for shot in shots]
    points = [_observed(shot, size_mm) for shot in shots]
    # Order 1 of what diffracts less is in the highlight, of what diffracts more outside pictures.
    nearest = min(_highlight(shot) / λ for shot, λ in zip(shots, wavelengths, strict=True))
    furthest = max(
        float(np.hypot(seen.u, seen.v).max()) / λ
        for seen, λ in zip(points, wavelengths, strict=True)
    )
    first, last = np.ceil(nearest / FREQUENCY_STEP), np.floor(furthest / FREQUENCY_STEP)
    frequencies = FREQUENCY_STEP * np.arange(first, max(last, first + 1) + 1)
    orientations = np.linspace(0, np.pi, ORIENTATIONS + 1)
    middles = (frequencies[1:] + frequencies[:-1]) / 2
    lobes = [Lobes(_grey(shot), _deviation(shot), middles, height, ORIENTATIONS) for shot in shots]
    halves = [[one.light(half) for one in points] for half in (False, True)]
    lights = [first + second for first, second in zip(*halves, strict=True)]
    seen = seen_shares(lobes, lights)
    if method == "threshold":
        lit = [_lit(one, λ) for one, λ in zip(points, wavelengths, strict=True)]
        θ, f = (np.concatenate(part) for part in zip(*lit, strict=True))
        weights, _, _ = np.histogram2d(θ, f, (orientations, frequencies))
    else:
        noise = [one.noise for one in points]

        def foretold(blur: float) -> float:
            """How well either half of the sample foretells the other."""
            return sum(
                log_likelihood(
                    lobes, other, noise, deconvolved(lobes, half, noise, seen >= SEEN, steps, blur)
                )
                for half, other in (halves, halves[::-1])
            )

        blur = max(tracked(BLURS, "How sharp the distribution is"), key=foretold)
        weights = deconvolved(lobes, lights, noise, seen >= SEEN, steps, blur)
    return Estimated(GratingDistribution(orientations, frequencies, weights), seen)


@dataclass(frozen=True)
class _Points:
    """Points of the sample outside the highlight, arrays of shape (n,).

    Attributes:
        u: (ω_i + ω_o)_x.
        v: (ω_i + ω_o)_y.
        intensity: Radiance over irradiance beyond what the median shows, most points being dark.
        half: In which half of the sample they are, of squares by turns.
        noise: Standard deviation of dark points.
    """

    u: Array
    v: Array
    intensity: Array
    half: NDArray[np.bool_]
    noise: float

    def light(self, half: bool) -> MeanLight:
        """What a half shows in each direction."""
        chosen = self.half == half
        u, v, intensity = self.u[chosen], self.v[chosen], self.intensity[chosen]
        return MeanLight.of(u, v, intensity, ORIENTATIONS)


def _observed(shot: Shot, size_mm: tuple[float, float]) -> _Points:
    u, v, seen, half = (np.concatenate(part) for part in zip(*_pieces(shot, size_mm), strict=True))
    if not len(seen):
        expected = "points of the sample outside the highlight"
        raise InputError(shot.name, "photograph", "none that can be used", expected)
    middle, brightest = np.percentile(seen, [50, 99])
    noise = float(1.48 * np.median(middle - seen[seen <= middle]))
    if brightest - middle < CERTAIN * noise or brightest < EVEN * middle or brightest <= 0:
        over = f"{brightest / middle:.2g} times the median" if middle > noise else "mere noise"
        found = f"a brightest hundredth outside the highlight of {over}"
        raise InputError(shot.name, "photograph", found, "lit gratings that stand out")
    # Without noise light that is a thousandth of the brightest is dark.
    return _Points(u, v, seen - middle, half, max(noise, 1e-3 * (brightest - middle)))


def _pieces(
    shot: Shot, size_mm: tuple[float, float]
) -> Iterator[tuple[Array, Array, Array, NDArray[np.bool_]]]:
    height, width = shot.usable.shape
    grey = shot.weights.sum(axis=0) / np.linalg.norm(shot.weights.sum(axis=0))
    rows = max(1, AT_ONCE // width)
    for start in range(0, height, rows):
        stop = min(start + rows, height)
        x, y = np.meshgrid(np.arange(width), np.arange(start, stop))
        pixels = np.stack([x.ravel(), y.ravel()], axis=1).astype(np.float64)
        place = shot.rectification.on_sample(pixels)
        good = shot.usable[start:stop].ravel() & np.all(
            np.abs(place) < np.array(size_mm) / 2, axis=1
        )
        place = place[good]
        h, irradiance = half_vectors(place, shot.rectification.eye, shot.light)
        light = shot.values[start:stop].reshape(-1, shot.values.shape[2])[good] @ grey
        outside = np.hypot(h[:, 0], h[:, 1]) > _highlight(shot)
        shown = light / irradiance - float(shot.background @ grey)
        half = np.floor(place / PATCH).sum(axis=1) % 2 > 0
        yield h[outside, 0], h[outside, 1], shown[outside], half[outside]


def _grey(shot: Shot) -> Array:
    """Spectral weights of the channels' sum, each weighted by its response, shape (401,)."""
    response = shot.weights.sum(axis=0)
    return shot.weights @ response / np.linalg.norm(response)


def _wavelength(shot: Shot) -> float:
    """The mean that a photograph shows.

    Raises:
        InputError: It shows too many.
    """
    weights = _grey(shot)
    mean = float(np.average(WAVELENGTHS, weights=weights))
    deviation = float(np.sqrt(np.average((WAVELENGTHS - mean) ** 2, weights=weights)))
    if deviation > BANDWIDTH * mean:
        found = f"light of {1e3 * mean:.0f} ± {1e3 * deviation:.0f} nm"
        expected = (
            f"a filter before the lamp that leaves ± {1e3 * BANDWIDTH * mean:.0f} nm at most: "
            "each wavelength is sent there by another period"
        )
        raise InputError(shot.name, "filter", found, expected)
    return mean


def _deviation(shot: Shot) -> float:
    return lobe_deviation(shot.radius, ROUGHNESS)


def _highlight(shot: Shot) -> float:
    return HIGHLIGHT * _deviation(shot)


def _lit(points: _Points, wavelength: float) -> tuple[Array, Array]:
    """Orientation and frequency of each lit point, its light taken as of the first order."""
    lit = points.intensity > LIT * np.percentile(points.intensity, 99.9)
    u, v = points.u[lit], points.v[lit]
    return np.mod(np.arctan2(v, u), np.pi), np.hypot(u, v) / wavelength
