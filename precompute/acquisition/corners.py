"""The sample's four corners in the pictures of a camera that did not move."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import cv2
import numpy as np
from numpy.typing import NDArray

from precompute.acquisition.capture import Corners
from precompute.acquisition.evidence import Evidence, Mark, PhotographError
from precompute.errors import InputError

Array = NDArray[np.float64]
Picture = NDArray[np.float32]

COARSE = 300
"""Larger side of the small picture in which straight edges are looked for: a lens that bends a
side by 1 % of the picture bends it by 3 px there, and shot noise averages out."""

CONTRAST = 0.03
"""Least gradient of an edge in the small picture, in logarithms per px: a step of some 12 %."""

NEAR = 2.5
"""How far from a straight line an edge counts as part of it, px of the small picture."""

TURN = np.radians(6)
"""How far an edge's direction may be off that of the line."""

LINES = 24
"""Straight edges that are tried as sides, the longest."""

SEEN = 0.5
"""Share of each side that has to be seen as an edge."""

SPOT = 9
"""Bright spots narrower than this, px of the small picture, are also tried to be left out."""

AREA = 0.1
"""Share of the picture that a sample covers at least."""

ACROSS = 5
"""Half the length of the profiles that place an edge, px."""

BLOCKS = 48
"""Places along a side, at most, at which the edge is measured."""


@dataclass(frozen=True)
class Side:
    """An edge that is a straight line but for a small bend.

    Attributes:
        start: A point of the line, px, shape (2,).
        along: Unit vector, the sample to the right of it as the picture is seen.
        length: Of the line, px.
        bend: How far the edge is off the line, px, away from the sample, as polynomial
            coefficients over the position along it from −1 to 1, the lowest first.
        share: Of the places along it where the picture shows the edge there.
    """

    start: Array
    along: Array
    length: float
    bend: Array
    share: float = 1.0

    @property
    def outwards(self) -> Array:
        """Unit vector away from the sample."""
        return np.array([self.along[1], -self.along[0]])

    def points(self, t: Array) -> Array:
        """Points of the edge at positions along it from −1 to 1, shape (n, 2), px.

        Args:
            t: No unit, shape (n,).
        """
        s = (t + 1) / 2 * self.length
        bend = np.polynomial.polynomial.polyval(t, self.bend)
        return self.start + s[:, None] * self.along + bend[:, None] * self.outwards

    def tangent(self, point: Array) -> tuple[Array, Array]:
        """The edge's point, px, and direction, a unit vector, beside a point near it."""
        t = np.array([2 * (point - self.start) @ self.along / self.length - 1])
        slope = np.polynomial.polynomial.polyval(t, np.polynomial.polynomial.polyder(self.bend))
        return self.points(t)[0], self.along + 2 / self.length * slope[0] * self.outwards


def find_corners(pictures: list[Picture], name: str) -> Corners:
    """Find the sample: the quadrilateral that stands out from what it lies on.

    It may be darker or lighter than that, if only the same way all around, and may be turned by
    less than 45 degrees. Several pictures are used as one, at each pixel what two
    thirds of them exceed (the darkest of up to three): what a lamp lights up in one is dark in
    most others. Straight edges are found
    in a small picture, then measured in the large one by how much of their profiles is as bright
    as the outside, which is unbiased whatever the lens blurs; sides may be bent as parabolas are.

    Args:
        pictures: Linear radiance, each of shape (height, width, channels), from one place.
        name: What messages call them.

    Returns:
        x, y in px, clockwise from the sample's top left as the camera sees it.

    Raises:
        PhotographError: No four such sides enclose a tenth of the picture, or so much shines beside
            one that it cannot be measured.
    """
    greys = np.stack([np.mean(picture, axis=2) for picture in pictures])
    dark = (len(greys) - 1) // 3
    grey = np.partition(greys, dark, axis=0)[dark].astype(np.float32)
    coarse, scale = _coarse(grey)
    coarse_outline, seen = _outline(coarse)
    outline = None if coarse_outline is None else (coarse_outline + 0.5) * scale - 0.5
    if outline is None or seen < SEEN:
        found = f"no quadrilateral of which more than {seen:.0%} of each side is seen"
        raise _refusal(name, found, grey, outline)
    corners = outline
    sides = [Side(a, _unit(b - a), _length(b - a), np.zeros(1)) for a, b in _edges(corners)]
    widest = 2 * NEAR * float(scale.max())
    passes = ((widest + ACROSS, 1), ((widest + ACROSS) / 2, 1), (ACROSS, 2), (ACROSS, 2))
    for across, degree in passes:
        sides = [_measured(grey, side, across, degree) for side in sides]
        corners = np.array([_meeting(sides[i - 1], sides[i], corners[i]) for i in range(4)])
    least = min(side.share for side in sides)
    moved = float(np.linalg.norm(corners - outline, axis=1).max())
    if least < SEEN:
        found = f"a quadrilateral of which a side is straight over {least:.0%}"
        raise _refusal(name, found, grey, corners)
    if moved > widest:
        found = f"a quadrilateral whose sides bend by {moved:.0f} px at a corner"
        raise _refusal(name, found, grey, corners)
    found = [(float(x), float(y)) for x, y in corners]
    return found[0], found[1], found[2], found[3]


def _coarse(grey: Picture) -> tuple[Array, Array]:
    """A small picture of logarithms, and how many px of the large one its px are in x and y."""
    height, width = grey.shape
    factor = min(1.0, COARSE / max(height, width))
    size = (max(1, round(width * factor)), max(1, round(height * factor)))
    small = cv2.resize(grey, size, interpolation=cv2.INTER_AREA).astype(np.float64)
    # What is as dark as noise is all the same, or its logarithms would be noise.
    second = small[:, 2:] - 2 * small[:, 1:-1] + small[:, :-2]
    noise = float(np.median(np.abs(second))) / 0.6745 / np.sqrt(6)
    floor = max(2 * noise, 1e-3 * float(np.median(np.abs(small))), 1e-12)
    return np.arcsinh(small / floor), np.array([width / size[0], height / size[1]])


def _outline(coarse: Array) -> tuple[Array | None, float]:
    """The quadrilateral whose sides are seen best, and which share of its worst side is.

    Returns:
        Clockwise from the top left, shape (4, 2), None where no lines enclose one; where none is
        seen well enough, that whose worst side is seen most of.
    """
    best, most, seen = None, 0.0, 0.0
    nearest = None
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (SPOT, SPOT))
    opened = cv2.morphologyEx(coarse, cv2.MORPH_OPEN, disc).astype(np.float64)
    for shown in (coarse, opened):
        points, direction = _edge_points(shown)
        for outwards in (direction, direction + np.pi):  # the surroundings lighter, darker
            lines = _lines(points, outwards, coarse.shape)
            if len(lines) < 4:
                continue
            fours, corners = _quadrilaterals(lines, coarse.shape)
            shares, lengths = _support(lines, fours, corners, points, outwards)
            least = shares.min(axis=1)
            if least.max(initial=0.0) > seen:
                nearest, seen = corners[np.argmax(least)], float(least.max())
            scores = np.where(least < SEEN, 0, np.sum((shares - SEEN) * lengths, axis=1))
            if scores.max(initial=0.0) > most:
                best, most = corners[np.argmax(scores)], float(scores.max())
    return (nearest if best is None else best), seen


def _edge_points(picture: Array) -> tuple[Array, Array]:
    """Where a small picture has edges, px, shape (n, 2), and the direction of its gradient, rad."""
    smooth = cv2.GaussianBlur(picture, (0, 0), 1.0)
    gx = cv2.Sobel(smooth, cv2.CV_64F, 1, 0, scale=1 / 8)
    gy = cv2.Sobel(smooth, cv2.CV_64F, 0, 1, scale=1 / 8)
    strength = np.hypot(gx, gy)
    noise = float(np.median(strength)) / 1.1774  # of a Rayleigh distribution
    row, column = np.nonzero(strength > max(CONTRAST, 3 * noise))
    points = np.stack([column, row], axis=1).astype(np.float64)
    return points, np.arctan2(gy[row, column], gx[row, column])


def _lines(points: Array, outwards: Array, shape: tuple[int, ...]) -> Array:
    """The straight edges that most edge points lie on (Hough, each voting along its gradient).

    Args:
        points: Edge points, px, shape (n, 2).
        outwards: Direction of their gradients, rad.
        shape: Of the picture.

    Returns:
        Angle of the normal and distance from the origin along it, the longest line first, shape
        (lines, 2).
    """
    turns, step = 180, 2.0
    reach = int(np.ceil(np.hypot(shape[0], shape[1]) / step))
    votes = np.zeros((turns, 2 * reach + 1))
    nearest = np.round(outwards / (2 * np.pi) * turns).astype(int)
    spread = round(TURN / (2 * np.pi) * turns)
    for offset in range(-spread, spread + 1):
        index = (nearest + offset) % turns
        angle = index * 2 * np.pi / turns
        distance = points[:, 0] * np.cos(angle) + points[:, 1] * np.sin(angle)
        np.add.at(votes, (index, np.round(distance / step).astype(int) + reach), 1.0)
    votes = cv2.blur(votes, (3, 1), borderType=cv2.BORDER_CONSTANT).astype(np.float64)
    lines = []
    for _ in range(LINES):
        turn, bin_ = np.unravel_index(np.argmax(votes), votes.shape)
        if votes[turn, bin_] == 0:
            break
        lines.append((float(turn) * 2 * np.pi / turns, (float(bin_) - reach) * step))
        around = np.arange(turn - 3, turn + 4) % turns
        votes[around, max(0, bin_ - 3) : bin_ + 4] = 0
    return np.array(lines).reshape(-1, 2)


def _quadrilaterals(lines: Array, shape: tuple[int, ...]) -> tuple[NDArray[np.intp], Array]:
    """Convex ones that lines enclose, their normals outwards, in the picture and large enough.

    Returns:
        Which lines, from the top one clockwise, shape (n, 4), and the corners, from the top left
        one clockwise, shape (n, 4, 2).
    """
    fours = np.array(list(combinations(range(len(lines)), 4)))
    # From the side whose normal points up the picture, clockwise.
    from_top = np.mod(lines[fours, 0] + 3 * np.pi / 4, 2 * np.pi)
    order = np.argsort(from_top, axis=1)
    from_top = np.take_along_axis(from_top, order, axis=1)
    gaps = np.diff(from_top, axis=1, append=from_top[:, :1] + 2 * np.pi)
    convex = (gaps.min(axis=1) > np.pi / 6) & (gaps.max(axis=1) < 5 * np.pi / 6)
    fours = np.take_along_axis(fours, order, axis=1)[convex]
    angle, distance = np.moveaxis(lines[fours], -1, 0)
    normals = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    pairs = np.stack([np.roll(normals, 1, axis=1), normals], axis=2)
    distances = np.stack([np.roll(distance, 1, axis=1), distance], axis=2)
    corners = np.linalg.solve(pairs, distances[..., None])[..., 0]
    size = np.array(shape[::-1])
    inside = np.all((corners > -NEAR) & (corners < size - 1 + NEAR), axis=(1, 2))
    x, y = np.moveaxis(corners, -1, 0)
    area = np.sum(x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1), axis=1) / 2
    good = inside & (area >= AREA * shape[0] * shape[1])
    return fours[good], corners[good]


def _support(
    lines: Array, fours: NDArray[np.intp], corners: Array, points: Array, outwards: Array
) -> tuple[Array, Array]:
    """Which share of each side has edge points beside it that face outwards, and its length."""
    reach = int(np.ceil(np.linalg.norm(points, axis=1).max())) + 1
    seen = np.zeros((len(lines), 2 * reach + 1))  # how many px of a line, up to each
    along = np.stack([-np.sin(lines[:, 0]), np.cos(lines[:, 0])], axis=1)
    for i, (angle, distance) in enumerate(lines):
        off = np.abs(np.mod(outwards - angle + np.pi, 2 * np.pi) - np.pi)
        beside = np.abs(points @ [np.cos(angle), np.sin(angle)] - distance)
        near = points[(beside < NEAR) & (off < 1.5 * TURN)]
        seen[i, np.round(near @ along[i]).astype(int) + reach] = 1
    seen = np.cumsum(seen, axis=1)
    following = np.roll(corners, -1, axis=1)
    start, stop = (
        np.clip(np.round(np.sum(c * along[fours], axis=2)).astype(int) + reach, 0, 2 * reach)
        for c in (corners, following)
    )
    length = np.linalg.norm(following - corners, axis=2)
    return (seen[fours, stop] - seen[fours, start]) / np.maximum(length, 1), length


def _measured(grey: Picture, side: Side, across: float, degree: int) -> Side:
    """A side moved to where the picture's profiles across it place it."""
    margin = min(across + 2, side.length / 4)
    blocks = min(BLOCKS, int((side.length - 2 * margin) / 4))
    each = int((side.length - 2 * margin) / blocks)
    s = margin + (np.arange(blocks * each) + 0.5) / (blocks * each) * (side.length - 2 * margin)
    t = 2 * s / side.length - 1
    steps = np.arange(-2 * round(across), 2 * round(across) + 1) / 2
    places = side.points(t)[:, None] + steps[:, None] * side.outwards
    x, y = np.moveaxis(places, -1, 0).astype(np.float32)
    strip = cv2.remap(grey, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    # Medians along the side leave out what shines in a few profiles.
    profiles = np.median(strip.reshape(blocks, each, len(steps)), axis=1)
    t = t.reshape(blocks, each).mean(axis=1)
    level = max(2, len(steps) // 4)
    inner, outer = profiles[:, :level].mean(axis=1), profiles[:, -level:].mean(axis=1)
    contrast = outer - inner
    usual = np.median(contrast)
    usable = contrast / usual > 0.3 if usual != 0 else np.zeros(blocks, bool)
    shown = (profiles - inner[:, None]) / np.where(usable, contrast, 1)[:, None]
    share = np.mean(shown, axis=1)
    offset = (0.5 - share) * (steps[-1] - steps[0] + steps[1] - steps[0])
    # What shines beside the edge makes a profile no step: such are few, and far off the others.
    misfit = np.mean((shown - (steps > offset[:, None])) ** 2, axis=1)
    usable &= misfit < 3 * np.median(misfit[usable]) + 0.01 if usable.any() else usable
    measured = np.polynomial.polynomial.polyval(t, side.bend) + offset
    bend, kept = _polynomial(t, measured, usable, degree)
    return Side(side.start, side.along, side.length, bend, kept)


def _polynomial(
    t: Array, values: Array, usable: NDArray[np.bool_], degree: int
) -> tuple[Array, float]:
    """A polynomial through most values (Tukey's biweight), and the share of them within 1 px.

    Its degree is up to `degree` as high as the values speak for: the least of Schwarz's criterion.
    """
    highest = min(degree, max(0, int(usable.sum()) // 6))
    powers = np.asarray(np.polynomial.polynomial.polyvander(t, highest), np.float64)
    weights = usable.astype(np.float64)
    residuals = values
    for step in range(20):
        residuals = np.abs(values - powers @ _weighted(powers, values, weights))
        spread = np.median(residuals[usable]) / 0.6745 if usable.any() else 0.0
        reach = max(4.7 * spread * (3 if step < 5 else 1), 0.02)
        weights = np.where(usable & (residuals < reach), (1 - (residuals / reach) ** 2) ** 2, 0)
    fits = [_weighted(powers[:, :count], values, weights) for count in range(1, highest + 2)]
    count = max(float(weights.sum()), 1.0)
    criterion = [
        count * np.log(weights @ (values - powers[:, : len(fit)] @ fit) ** 2 / count + 1e-8)
        + len(fit) * np.log(count)
        for fit in fits
    ]
    near = usable & (residuals < 1)
    return fits[int(np.argmin(criterion))], float(np.mean(near))


def _weighted(powers: Array, values: Array, weights: Array) -> Array:
    root = np.sqrt(weights)
    fit = np.linalg.lstsq(powers * root[:, None], values * root, rcond=None)[0]
    return np.asarray(fit, np.float64)


def _meeting(before: Side, after: Side, near: Array) -> Array:
    """Where two edges cross."""
    point = near
    for _ in range(6):
        a, d = before.tangent(point)
        b, e = after.tangent(point)
        along, _ = np.linalg.solve(np.stack([d, -e], axis=1), b - a)
        point = a + along * d
    return point


def _refusal(name: str, found: str, grey: Picture, corners: Array | None) -> PhotographError:
    wanted = "the four corners of a sample that stands out from what it lies on"
    error = InputError(name, "corners_px", found, f"{wanted} and covers a tenth of the picture")
    marks = () if corners is None else (Mark(found, corners, True),)
    return PhotographError(error, Evidence.of("corners", grey[..., None], *marks))


def _edges(corners: Array) -> list[tuple[Array, Array]]:
    return [(corners[i], corners[(i + 1) % 4]) for i in range(4)]


def _length(vector: Array) -> float:
    return float(np.linalg.norm(vector))


def _unit(vector: Array) -> Array:
    return vector / np.linalg.norm(vector)
