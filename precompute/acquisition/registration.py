"""By how much a camera moved between two photographs of a foil through a turning polariser.

The polariser changes which pieces are brighter than their neighbours, and may turn their contrast
round; it leaves edges where they are. So sizes of gradients are compared: roughly by phase
correlation, then by ECC (Evangelidis and Psarakis 2008) from coarse to fine.

Comparing light itself with what a harmonic of the other photographs foretells does no better: moves
that are a harmonic of ψ themselves look like modulated edges.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Picture = NDArray[np.float32]

LONGEST = 2048
"""Longest side, px, at which photographs are compared: larger ones are reduced, and what is then
found to some hundredths of these pixels is as many times as much of theirs."""

COARSEST = 128
"""Shortest side, px, at which a search begins."""

BLUR = 1.0
"""Standard deviation, px, by which pictures are blurred before gradients are taken."""

SMOOTHED = 5
"""Side, px, of the Gaussian that ECC smooths gradients by: it interpolates them linearly, which
their sizes, bent where a gradient is 0, do not suit. Unsmoothed, moves are off twice as much."""

INSET, RIM = 0.96, 8
"""Part of a sheet's sides within which its print is compared, but for so many px of it: as far as
blur and smoothing spread its outline."""

STEPS, ENOUGH = 60, 1e-6
"""Of ECC at one size: most, and by how much its correlation grows when it stops."""


@dataclass(frozen=True)
class Move:
    """How a photograph lies on another.

    Attributes:
        shift: What it shows is so far off, px, shape (2,): x right, y down.
        turn: And turned by so much about the picture's middle, clockwise as it is seen, rad.
        quality: Correlation of the gradients' sizes once it is moved back, −1 to 1; 0 where no such
            move was found.
    """

    shift: Array
    turn: float
    quality: float

    def moved(self, pixels: Array, size: tuple[int, int]) -> Array:
        """Where the photograph shows, px, what the other one shows at pixels x, y.

        Args:
            pixels: Shape (n, 2).
            size: Width and height of both, pixels.
        """
        middle = (np.array(size) - 1) / 2
        x, y = (pixels - middle).T
        cosine, sine = np.cos(self.turn), np.sin(self.turn)
        turned = np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=1)
        return turned + middle + self.shift


class Outlines:
    """A photograph's edges, of whatever contrast: what tells how it lies on another.

    Args:
        light: Shape (height, width).
    """

    def __init__(self, light: Picture) -> None:
        height, width = light.shape
        self.size = width, height
        self.factor = max(1, -(-max(light.shape) // LONGEST))
        small = _reduced(light, self.factor)
        self.levels = [_gradients(small)]
        while min(small.shape) >= 2 * COARSEST:
            small = _reduced(small, 2)
            self.levels.append(_gradients(small))

    def move_of(self, other: Outlines) -> Move:
        """How another photograph of the same size lies on this one.

        Nothing is said of whether it does: a quality near 0 says that it does not.
        """
        still, moving = self.levels[-1], other.levels[-1]
        window = cv2.createHanningWindow(still.shape[::-1], cv2.CV_32F)
        # OpenCV 5.0 multiplies its arguments by the window where their size suits it.
        shift, _ = cv2.phaseCorrelate(still.copy(), moving.copy(), window)
        rough = np.array([[1, 0, shift[0]], [0, 1, shift[1]]])
        # From where it is, too: phase correlation may err, and most cameras stand still.
        starts = (np.eye(2, 3), rough)
        found = (self._refined(other, start) for start in starts)
        _, quality, warp = min(found, key=lambda one: one[0])
        warp = _enlarged(warp, self.factor)
        middle = (np.array(self.size) - 1) / 2
        offset = warp[:, :2] @ middle + warp[:, 2] - middle
        return Move(offset, float(np.arctan2(warp[1, 0], warp[0, 0])), quality)

    def likeness(self, other: Outlines, move: Move, corners: Array) -> float:
        """How well edges of another photograph lie on this one's within a quadrilateral.

        A sheet's own outline is the same whatever is printed on it, and left out by that. Pictures
        are compared from fine to coarse: noise hides fine edges, reduction the small ones.

        Args:
            other: The photograph.
            move: How it lies on this one.
            corners: Of the quadrilateral in this one, px, shape (4, 2).

        Returns:
            Correlation of the gradients' sizes where it is largest, no unit, −1 to 1.
        """
        return max(
            _likeness(still, moving, move, corners, self.size, self.factor * 2**level)
            for level, (still, moving) in enumerate(zip(self.levels, other.levels, strict=True))
        )

    def _refined(self, other: Outlines, warp: Array) -> tuple[float, float, Array]:
        """A warp from a start at the coarsest level, as fine as noise lets it be told.

        A correlation ρ of n pixels tells it to some √(1/ρ² − 1)/√n of their size. With every level
        that size doubles and n is a quarter, so its uncertainty is 4 times as much, but that ρ is
        larger where there is noise.

        Returns:
            That uncertainty in arbitrary units, the correlation, and the warp at the finest level.
        """
        least, quality = np.inf, 0.0
        for level in range(len(self.levels) - 1, -1, -1):
            ρ, moved = _ecc(self.levels[level], other.levels[level], warp)
            uncertainty = 4.0**level * np.sqrt(max(1 / ρ**2 - 1, 0)) if ρ > 0 else np.inf
            if uncertainty < least:
                least, quality, warp = uncertainty, ρ, moved
            if level > 0:
                warp = _enlarged(warp, 2)
        return least, quality, warp


def _ecc(still: Picture, moving: Picture, start: Array) -> tuple[float, Array]:
    """The correlation of two pictures and the warp between them, shape (2, 3)."""
    criteria = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, STEPS, ENOUGH)
    warp = start.astype(np.float32)
    everywhere = np.ones(still.shape, np.uint8)
    try:
        quality, warp = cv2.findTransformECC(
            still, moving, warp, cv2.MOTION_EUCLIDEAN, criteria, everywhere, SMOOTHED
        )
    except cv2.error:  # it does not converge, or leaves nothing that overlaps
        return 0.0, start
    return float(quality), np.asarray(warp, np.float64)


def _likeness(
    still: Picture,
    moving: Picture,
    move: Move,
    corners: Array,
    size: tuple[int, int],
    factor: int,
) -> float:
    """`Outlines.likeness` of two pictures that have been reduced from a size by a factor."""
    half = (factor - 1) / 2
    ends = np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)])
    to = (move.moved(ends * factor + half, size) - half) / factor
    warp = cv2.getAffineTransform(ends.astype(np.float32), to.astype(np.float32))
    height, width = still.shape
    moved = cv2.warpAffine(
        moving, warp, (width, height), flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    )
    outline = (corners - half) / factor
    middle = outline.mean(axis=0)
    inside = np.zeros(still.shape, np.uint8)
    inner = middle + INSET * (outline - middle)
    cv2.fillConvexPoly(inside, np.round(inner).astype(np.int32), (1,))
    inside = cv2.erode(inside, np.ones((2 * RIM + 1, 2 * RIM + 1), np.uint8))
    one, two = (
        cv2.GaussianBlur(sizes, (SMOOTHED, SMOOTHED), 0)[inside > 0] for sizes in (still, moved)
    )
    if one.size == 0 or min(float(one.std()), float(two.std())) == 0:
        return 0.0
    return float(np.corrcoef(one, two)[0, 1])


def _enlarged(warp: Array, factor: int) -> Array:
    """The warp once pictures are so much larger: what is at x is at factor (x + 1/2) − 1/2 then."""
    half = np.full(2, (factor - 1) / 2)
    linear = warp[:, :2]
    return np.column_stack([linear, factor * warp[:, 2] + half - linear @ half])


def _reduced(picture: Picture, factor: int) -> Picture:
    height, width = (side // factor for side in picture.shape)
    whole = picture[: height * factor, : width * factor]
    small = cv2.resize(whole, (width, height), interpolation=cv2.INTER_AREA)
    return np.asarray(small, np.float32)


def _gradients(picture: Picture) -> Picture:
    soft = cv2.GaussianBlur(picture, (0, 0), BLUR)
    x, y = (cv2.Sobel(soft, cv2.CV_32F, *order, ksize=3) for order in ((1, 0), (0, 1)))
    return np.asarray(cv2.magnitude(x, y), np.float32)
