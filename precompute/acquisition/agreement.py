"""Where a sample shows the same gratings again: the displacements at which light agrees.

A point that is lit says what its grating is: one along the line to the lamp's mirror image. So it
says where else that grating would be lit, in this photograph or another: where the line to the
mirror image has that direction too. Points a period apart have the same grating; if one is lit, so
is the other, where its direction is the same. Other points are lit as often as any.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import fft
from scipy.ndimage import uniform_filter

Array = NDArray[np.float64]
Array32 = NDArray[np.float32]

BLOCKS = 24
"""Parts along each side of a picture whose medians are its unlit background."""

NOISE = 3.0
"""Standard deviations of noise above the background from which on a pixel is lit."""

DIRECTIONS = 36
"""Among which lit points are shared out, each to the two nearest: steps of 5°, some two standard
deviations of a lobe. All take some 350 MB, with `layout.GRID` points along both sides."""

RADIUS_STEP = 0.02
"""Of ρ, at which points are lit about as often: a lobe's standard deviation or two."""

FARTHEST = 0.85
"""Of the sample's width and height, the largest displacement: beyond, next to nothing overlaps."""

ALIKE = 1.25
"""Agreement over chance below which points do not belong to the same piece of the pattern."""

CLEAR = 1.5
"""Times where that is first so, from which on it is so everywhere."""

AROUND = 5
"""Pieces along each side of what a displacement is compared with."""


@dataclass(frozen=True)
class Look:
    """A photograph on a grid over the sample, rows downwards, arrays of shape (rows, columns).

    Attributes:
        lit: Where a grating may be seen.
        usable: Where one would be seen, were it lit.
        u: (ω_i + ω_o)_x.
        v: (ω_i + ω_o)_y.
    """

    lit: NDArray[np.bool_]
    usable: NDArray[np.bool_]
    u: Array
    v: Array


@dataclass(frozen=True)
class Agreement:
    """Pairs of points by displacement, px, shape (2I + 1, 2J + 1): down and right of the middle.

    Attributes:
        seen: Number of those that are both lit as by one grating.
        expected: The number that chance would have.
    """

    seen: Array
    expected: Array

    @property
    def reach(self) -> tuple[int, int]:
        """Largest displacement down and right, px."""
        rows, columns = self.seen.shape
        return rows // 2, columns // 2

    def piece(self) -> int:
        """Displacement from which on agreement is no longer that of one and the same piece, px."""
        distance = np.round(self._distance()).astype(np.intp)
        count = min(self.reach)
        seen, expected = (
            np.bincount(distance.ravel(), pairs.ravel())[:count]
            for pairs in (self.seen, self.expected)
        )
        return round(CLEAR * int(np.argmax(np.append(seen < ALIKE * expected, True))))

    def beyond(self, piece: int) -> Agreement:
        """Without pairs closer than a piece, and expecting what there is round about.

        What changes slowly with displacement is no repetition, but directions that are commoner
        than others, or commoner in one part of the sample.

        Args:
            piece: Size of a piece, pixels of the grid.
        """
        far = self._distance() >= piece
        seen, expected = self.seen * far, np.maximum(self.expected * far, 0)
        around, foreseen = (uniform_filter(pairs, AROUND * piece) for pairs in (seen, expected))
        return Agreement(seen, expected * around / np.maximum(foreseen, 1e-9))

    def _distance(self) -> Array:
        down, right = self.reach
        return np.hypot(np.arange(-down, down + 1)[:, None], np.arange(-right, right + 1))


def lit_points(picture: Array) -> NDArray[np.bool_]:
    """Where a picture is twice as bright as its background and stands out from noise.

    Args:
        picture: Luminance, shape (rows, columns).
    """
    rows, columns = picture.shape
    edges = [np.linspace(0, n, BLOCKS + 1).astype(int) for n in (rows, columns)]
    medians = np.array(
        [
            [np.median(picture[a:b, c:d]) for c, d in zip(edges[1], edges[1][1:], strict=False)]
            for a, b in zip(edges[0], edges[0][1:], strict=False)
        ],
        dtype=np.float32,
    )
    background = cv2.resize(cv2.medianBlur(medians, 5), (columns, rows))
    excess = picture - background
    noise = float(np.median(np.abs(excess))) / 0.6745
    return excess > np.maximum(NOISE * noise, background)


def agreements(looks: list[Look], turns: list[int]) -> Iterator[Agreement]:
    """Count pairs of lit points, in all photographs at once, by how far they are apart.

    Where L_k is lit in direction k, and E_k is the mean of what is lit at that distance from the
    mirror image, in all as much as L_k, pairs are Σ_k L_k ⋆ L_{k+t}, and chance has
    ½ Σ_k (L_k ⋆ E_{k+t} + E_k ⋆ L_{k+t}). At t = 0 both points are lit as by the same grating. At
    others they cannot be, which tells what chance is able to.

    Args:
        looks: The photographs, on the same grid.
        turns: t, by how many steps of direction the second point's differs, of `DIRECTIONS`.
    """
    rows, columns = looks[0].lit.shape
    size = fft.next_fast_len(2 * rows, True), fft.next_fast_len(2 * columns, True)
    lit, even = (
        [np.asarray(fft.rfft2(part, size)) for part in parts] for parts in _by_direction(looks)
    )
    down, right = int(FARTHEST * rows), int(FARTHEST * columns)
    window = np.ix_(np.arange(-down, down + 1), np.arange(-right, right + 1))
    for turn in turns:
        seen, expected = np.zeros_like(lit[0]), np.zeros_like(lit[0])
        for k in range(DIRECTIONS):
            other = (k + turn) % DIRECTIONS
            seen += lit[k].conj() * lit[other]
            expected += (lit[k].conj() * even[other] + even[k].conj() * lit[other]) / 2
        yield Agreement(
            *(np.asarray(fft.irfft2(pairs, size), np.float64)[window] for pairs in (seen, expected))
        )


def _by_direction(looks: list[Look]) -> tuple[Array32, Array32]:
    """What is lit in all, and in the mean at each ρ, shape (directions, rows, columns)."""
    shape = looks[0].lit.shape
    row, column = np.indices(shape)
    result = np.zeros((2, DIRECTIONS, *shape), np.float32)
    for look in looks:
        lit = look.lit & look.usable
        ring = np.round(np.hypot(look.u, look.v) / RADIUS_STEP).astype(np.intp)
        count = np.bincount(ring[look.usable], minlength=ring.max() + 1)
        mean = np.bincount(ring[lit], minlength=len(count)) / np.maximum(count, 1)
        even = np.where(look.usable, mean[ring], 0)
        direction = np.mod(np.arctan2(look.v, look.u) / np.pi, 1) * DIRECTIONS
        below = np.floor(direction).astype(np.intp)
        for step, share in enumerate((below + 1 - direction, direction - below)):
            for shared, values in zip(result, (lit, even), strict=True):
                shared[(below + step) % DIRECTIONS, row, column] += share * values
    # Some directions are commoner than others.
    often, mean = result.sum(axis=(2, 3))
    return result[0], result[1] * (often / np.maximum(mean, 1e-9))[:, None, None]
