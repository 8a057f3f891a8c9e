"""The tile of a repeating sample, from the pictures themselves or from one that is marked."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from precompute.acquisition.capture import Corners
from precompute.acquisition.rectification import Rectification
from precompute.errors import InputError

Array = NDArray[np.float64]

BLOCKS = 24
"""Parts along each side of a picture whose medians are its unlit background."""

NOISE = 3.0
"""Standard deviations of noise above the background from which on a pixel is lit."""

SMALLEST = 20
"""Pixels of the smallest lit shape that is compared."""

WINDOW = 16
"""Half the side of the window in which shapes are compared, after they are scaled to fit."""

SHAPES = 2000
"""Shapes that are compared at most, the largest: some 30 MB of overlaps."""

ALIKE = 0.8
"""Overlap over union of two shapes from which on they may be the same part of the pattern."""

PAIRS = 400
"""Pairs that vote at most, those that are most alike."""

STEP = 0.25
"""Of the periods that are tried, px: an eighth of the widest spread at the eighth tile."""

SPREADS = (0.7, 1.5, 3.0)
"""Standard deviations of how far pairs are off a multiple, px: of tiles in and off their place."""

SHARES = (0.2, 0.4, 0.6, 0.8, 0.95)
"""Of pairs that are the same part of the pattern, the others being alike by chance."""

CHANCE = 1e-4
"""Probability with which a pattern that does not repeat is taken for one that does."""

LEAD = 7.0
"""Logarithm of how much likelier than any other period the best one is: 1000 times."""

LONGEST = 0.6
"""Of the sample's width or height, the longest period that is tried."""

FEW = 3.0
"""Widths of a usual shape that a tile is wide and high at least."""

SKEW = 3.0
"""Degrees by which a marked tile's angles and directions may be off."""

UNEVEN = 0.05
"""Share by which opposite sides of a marked tile may differ."""


@dataclass(frozen=True)
class Period:
    """What displacements along one axis speak for.

    Attributes:
        length: Of the period, px.
        evidence: Logarithm of how much likelier it makes the displacements than chance does.
        needed: How much it takes.
        lead: Its evidence less that of the next best.
    """

    length: float
    evidence: float
    needed: float
    lead: float

    @property
    def is_clear(self) -> bool:
        """Whether neither chance nor another period may be behind the displacements."""
        return self.evidence > self.needed and self.lead > LEAD


def find_tile(pictures: list[Array], pitch_mm: float) -> tuple[float, float]:
    """Find how often a sample's pattern repeats along x and y.

    Where a part of the pattern is lit depends on where the lamp's mirror image is, but not the
    shape of what is lit. So lit shapes are compared with each other, in all pictures at once, and
    the displacements between those that are alike are multiples of the period but for chance. Of
    all periods the one wins that makes them likeliest: with a normal distribution N about its
    multiples a displacement x is q T N(x mod T) + 1 − q times as likely as with chance alone. Half
    of the period T predicts half as sharply, and its double misses half of what there is.

    Against chance that ratio is 1 in the mean, however many displacements there are. So the best of
    m periods exceeds m / p with probability p at most (Markov), and that is the margin.

    Parts that are all alike and in rows, such as circles on a square lattice, repeat from one to
    the next, and no shape tells them apart. So a tile that holds little more than one shape is
    refused.

    Args:
        pictures: Luminance on one grid over the sample, rows along y, each of shape
            (rows, columns).
        pitch_mm: Of the grid.

    Returns:
        Width and height of a tile, mm.

    Raises:
        InputError: Along one axis or both no period stands out from chance.
    """
    masks, middles, usual = _shapes(pictures)
    displacements, weights = _pairs(masks, middles, usual / 2)
    rows, columns = pictures[0].shape
    periods = [
        _period(displacements[:, axis], weights, 0.9 * usual, LONGEST * extent)
        for axis, extent in enumerate((columns, rows))
    ]
    if not all(period.is_clear and period.length > FEW * usual for period in periods):
        found = " and ".join(
            f"{period.length * pitch_mm:.1f} mm along {axis} with evidence {period.evidence:.0f} "
            f"of {period.needed:.0f}, {period.lead:.0f} ahead"
            for axis, period in zip("xy", periods, strict=True)
        )
        raise InputError(
            "capture",
            "sample.tile_mm",
            f"{len(masks)} lit shapes {usual * pitch_mm:.1f} mm wide, {len(displacements)} pairs "
            f"alike; {found}",
            "a pattern that repeats so clearly that its tile can be found, or the tile's size",
        )
    width, height = (period.length * pitch_mm for period in periods)
    return width, height


def _shapes(pictures: list[Array]) -> tuple[Array, Array, float]:
    """Lit shapes, cut out about their middles and flattened, the middles, and a usual width, px."""
    found = []
    for picture in pictures:
        lit = _lit(picture).astype(np.uint8)
        count, labels, boxes, middles = cv2.connectedComponentsWithStats(lit, connectivity=4)
        rows, columns = lit.shape
        for index in range(1, count):
            left, top, width, height, area = boxes[index]
            # What the picture's edge cuts off is not the whole shape.
            cut = left == 0 or top == 0 or left + width == columns or top + height == rows
            if area >= SMALLEST and not cut:
                mask = labels[top : top + height, left : left + width] == index
                found.append((int(area), mask, middles[index], (left, top)))
    found = sorted(found, key=lambda shape: -shape[0])
    if not found:
        return np.zeros((0, (2 * WINDOW + 1) ** 2)), np.zeros((0, 2)), 1.0
    # Half of what is lit belongs to shapes of at least this width.
    areas = np.array([area for area, *_ in found], dtype=np.float64)
    usual = float(np.sqrt(areas[np.searchsorted(np.cumsum(areas), areas.sum() / 2)]))
    # What does not fit is the highlight, or many shapes; what is too small looks like anything.
    scale = WINDOW / (2 * usual)
    fitting = [
        shape for shape in found if max(shape[1].shape) <= 4 * usual and shape[0] >= usual**2 / 8
    ][:SHAPES]
    masks = [_cut_out(mask, middle - corner, scale) for _, mask, middle, corner in fitting]
    return np.array(masks), np.array([middle for _, _, middle, _ in fitting]), usual


def _cut_out(mask: NDArray[np.bool_], middle: Array, scale: float) -> Array:
    shift = WINDOW - scale * middle
    matrix = np.array([[scale, 0, shift[0]], [0, scale, shift[1]]])
    size = (2 * WINDOW + 1, 2 * WINDOW + 1)
    window = cv2.warpAffine(mask.astype(np.float32), matrix, size, flags=cv2.INTER_LINEAR)
    return window.ravel().astype(np.float64)


def _lit(picture: Array) -> NDArray[np.bool_]:
    """Where a picture is twice as bright as its background and stands out from noise."""
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


def _pairs(masks: Array, middles: Array, beside: float) -> tuple[Array, Array]:
    """Pairs of shapes that are alike.

    Args:
        masks: The shapes, shape (n, pixels).
        middles: Where they are, px, shape (n, 2).
        beside: Distance below which two are the same in different pictures, px.

    Returns:
        How far they are apart along x and y, px, shape (pairs, 2), and by how much each counts,
        so that what is seen in several pictures counts once.
    """
    shared = masks @ masks.T
    areas = masks.sum(axis=1)
    overlap = shared / np.maximum(areas[:, None] + areas - shared, 1e-9)
    first, second = np.nonzero(np.triu(overlap > ALIKE, 1))
    best = np.argsort(-overlap[first, second], kind="stable")[:PAIRS]
    first, second = first[best], second[best]
    apart = np.linalg.norm(middles[:, None] - middles, axis=2)
    times = np.sum(apart < beside, axis=1)
    displacements = np.abs(middles[second] - middles[first])
    return displacements, 1 / (times[first] * times[second])


def _period(displacements: Array, weights: Array, shortest: float, longest: float) -> Period:
    """The period that explains displacements along one axis best, shape (pairs,), px.

    Those shorter than any period say nothing of it: the same part of one tile, seen twice.
    """
    far, counts = displacements[displacements > shortest], weights[displacements > shortest]
    trials = np.arange(shortest, longest, STEP)
    needed = float(np.log(max(1, len(trials)) * len(SPREADS) * len(SHARES) / CHANCE))
    if len(trials) == 0:
        return Period(shortest, 0.0, needed, 0.0)
    fits = [_fit(far, counts, float(length)) for length in trials]
    evidence = np.array([fit[0] for fit in fits])
    index = int(np.argmax(evidence))
    length, (most, spread, share) = float(trials[index]), fits[index]
    others = evidence[np.abs(trials - length) > 4 * max(spread, STEP)]
    lead = most - float(others.max(initial=0.0))
    return Period(_refined(far, counts, length, spread, share), most, needed, lead)


def _fit(far: Array, counts: Array, length: float) -> tuple[float, float, float]:
    """How much likelier a period makes displacements than chance, at which spread and share."""
    best = (0.0, SPREADS[0], SHARES[0])
    for spread in SPREADS:
        ratio = _comb(far, length, spread)
        for share in SHARES:
            best = max(best, (float(counts @ np.log(share * ratio + 1 - share)), spread, share))
    return best


def _refined(far: Array, counts: Array, length: float, spread: float, share: float) -> float:
    """Least squares over the multiples, each displacement by how likely it is one."""
    for _ in range(10):
        multiple = np.maximum(np.round(far / length), 1)
        same = share * _comb(far, length, spread)
        weight = counts * same / (same + 1 - share)
        if not weight.any():
            break
        length = float(np.sum(weight * multiple * far) / np.sum(weight * multiple**2))
    return length


def _comb(far: Array, length: float, spread: float) -> Array:
    """Density of displacements about a period's multiples, over that of even ones."""
    return length * _normal(far - length * np.maximum(np.round(far / length), 1), spread)


def _normal(x: Array, spread: float) -> Array:
    return np.exp(-0.5 * (x / spread) ** 2) / (spread * np.sqrt(2 * np.pi))


def reference_tiling(
    corners_px: Corners, rectification: Rectification, name: str
) -> tuple[tuple[float, float], tuple[float, float]]:
    """The tile that is marked in a photograph.

    Args:
        corners_px: Its corners, clockwise from the top left.
        rectification: Of the photograph.
        name: What messages call the file that marks it.

    Returns:
        Width and height, and x and y of the top left corner, mm.

    Raises:
        InputError: On the sample the corners are those of no rectangle, or of one that is turned
            against the sample's edges.
    """
    corners = rectification.on_sample(np.array(corners_px, dtype=np.float64))
    edges = np.roll(corners, -1, axis=0) - corners
    lengths = np.linalg.norm(edges, axis=1)
    width, height = (lengths[:2] + lengths[2:]) / 2
    # y points up on the sample: to the right, down, to the left, up.
    expected = np.array([0, -90, 180, 90])
    turns = np.mod(np.degrees(np.arctan2(edges[:, 1], edges[:, 0])) - expected + 180, 360) - 180
    angles = turns - np.roll(turns, 1)
    uneven = np.abs(lengths[:2] - lengths[2:]) / [width, height]
    wrong = None
    if uneven.max() > UNEVEN:
        wrong = f"opposite sides that differ by {uneven.max():.0%}"
    elif np.abs(turns).max() > SKEW and np.abs(np.abs(angles)).max() <= SKEW:
        wrong = f"a rectangle turned by {np.abs(turns).max():.0f} degrees against the sample"
    elif max(np.abs(turns).max(), np.abs(angles).max()) > SKEW:
        wrong = f"angles that are off by {np.abs(angles).max():.0f} degrees"
    if wrong is not None:
        size = ", ".join(f"{length:.1f}" for length in lengths)
        raise InputError(
            name,
            "sample.reference_tile_px",
            f"sides of {size} mm, {wrong}",
            "the corners of a rectangle parallel to the sample's edges, clockwise from its top "
            "left",
        )
    # The mean of what all four corners say of the one.
    corner = np.mean(corners, axis=0) + np.array([-width, height]) / 2
    return (float(width), float(height)), (float(corner[0]), float(corner[1]))
