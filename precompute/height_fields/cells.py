"""Cells of a relief's spectrum: places that stand for all its lines under an environment.

Light of an environment reaches a viewer by every line of the spectrum, thousands of them. The plane
of spatial frequency is cut into cells that scatter about alike, each with its centroid, its spread
and its power, a table over p = w/λ. From them and a light's spectrum
web/height-field/environment-samples.ts makes the list of directions in which the shader looks.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from precompute.axes import Axis
from precompute.height_fields.field import HeightField
from precompute.maps import Table
from precompute.spectra import WAVELENGTH_MIN

Array = NDArray[np.float64]

CELLS = 511
"""Cells besides order 0, which is one of its own."""

SAMPLES = 64
"""Of each cell's power over p: at most 0.5 rad of phase apart for reliefs up to 1 µm."""

LONGEST = 2 / WAVELENGTH_MIN
"""The largest p = w/λ, and the farthest line that can be lit: |(u, v)| and w are at most 2."""


@dataclass(frozen=True)
class Cells:
    """A partition of a relief's spectrum.

    Attributes:
        frequencies: Centroids, (x, y), 1/µm, shape (cells, 2); the first is order 0.
        spreads: Root mean square distance of a cell's power from its centroid along one axis, 1/µm.
        powers: Σ |A_jl|² of each cell's lines at each p, shape (cells, samples).
    """

    frequencies: Array
    spreads: Array
    powers: Array

    def tables(self) -> dict[str, Table]:
        """The arrays ``places`` and ``powers`` of a height field's maps."""
        count, samples = self.powers.shape
        cell = Axis(name="cell", symbol="i", unit="1", size=count, first=0, last=max(count - 1, 1))
        p = Axis(name="w/lambda", symbol="p", unit="1/um", size=samples, first=0, last=LONGEST)
        places = np.column_stack([self.frequencies, self.spreads, np.zeros(count)])
        channels = ("f_x", "f_y", "spread", "unused")
        return {
            "places": Table(places, (cell,), channels, dtype="float32"),
            "powers": Table(self.powers[..., None], (cell, p), ("power",), dtype="float16"),
        }


def spectrum_cells(field: HeightField, count: int = CELLS) -> Cells:
    """Cut a relief's spectrum into cells of about equal power.

    Whichever cell scatters the most, power times squared spread, is halved next, across its longer
    side where half of its power lies on either hand; a single line is not halved.

    Args:
        field: The relief.
        count: Cells besides order 0; fewer where there are fewer lines.
    """
    frequencies, powers = line_powers(field)
    is_zero = np.all(frequencies == 0, axis=1)
    zero, rest = powers[:, is_zero].T, powers[:, ~is_zero]
    frequencies = frequencies[~is_zero]
    weights = rest.mean(axis=0)
    lit = np.flatnonzero(weights > 1e-9 * weights.sum())
    heap = [(-_scatter(frequencies[lit], weights[lit]), 0, lit)]
    while len(heap) < count and heap[0][0] < 0:
        _, _, lines = heapq.heappop(heap)
        for half in _halves(frequencies, weights, lines):
            scatter = _scatter(frequencies[half], weights[half])
            # The first line tells cells apart that scatter alike: the same cells on every run.
            heapq.heappush(heap, (-scatter, int(half[0]), half))
    cells = [lines for _, _, lines in sorted(heap, key=lambda cell: cell[1])]
    centroids = [weights[c] @ frequencies[c] / weights[c].sum() for c in cells]
    spreads = [np.sqrt(_scatter(frequencies[c], weights[c]) / weights[c].sum() / 2) for c in cells]
    return Cells(
        np.array([(0, 0), *centroids], dtype=np.float64),
        np.array([0, *spreads], dtype=np.float64),
        np.stack([zero[0], *(rest[:, c].sum(axis=1) for c in cells)]),
    )


def line_powers(field: HeightField, samples: int = SAMPLES) -> tuple[Array, Array]:
    """|A_jl|² of the lines that can be lit, at equal steps of p from 0 to `LONGEST`.

    Returns:
        Frequencies (lines, 2), 1/µm, and powers (samples, lines).
    """
    rows, columns = field.heights.shape
    fx, fy = np.meshgrid(
        np.fft.fftfreq(columns, field.pitch[0]), np.fft.fftfreq(rows, field.pitch[1])
    )
    reachable = np.hypot(fx, fy) <= LONGEST
    powers = [
        np.abs(np.fft.ifft2(np.exp(2j * np.pi * p * field.heights))[reachable]) ** 2
        for p in np.linspace(0, LONGEST, samples)
    ]
    frequencies = np.column_stack([fx[reachable], fy[reachable]])
    return frequencies.astype(np.float64), np.stack(powers)


def _scatter(frequencies: Array, weights: Array) -> float:
    """Σ weight · squared distance from the centroid; of a single line exactly 0."""
    if len(weights) == 1:
        return 0.0
    centre = weights @ frequencies / weights.sum()
    return float(weights @ np.sum((frequencies - centre) ** 2, axis=1))


def _halves(
    frequencies: Array, weights: Array, lines: NDArray[np.intp]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    places, shares = frequencies[lines], weights[lines]
    centre = shares @ places / shares.sum()
    axis = int(np.argmax(shares @ (places - centre) ** 2))
    order = np.argsort(places[:, axis], kind="stable")
    cumulative = np.cumsum(shares[order])
    split = int(np.searchsorted(cumulative, cumulative[-1] / 2)) + 1
    split = min(max(split, 1), len(lines) - 1)
    return lines[order[:split]], lines[order[split:]]
