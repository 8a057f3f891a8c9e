"""How far points lie from the edges of figures: below 0 inside, above 0 outside, mm."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from precompute.foils.figure_recipes import Disc, Figure, Polygon, Rectangle, Rosette, Star, Stroke

Array = NDArray[np.float64]


def signed_distance(figure: Figure, x: Array, y: Array) -> Array:
    """Distance of points from a figure's edge, mm, negative inside.

    Args:
        figure: The figure.
        x: In its frame, mm.
        y: Likewise, of the same shape.

    Returns:
        Of that shape; exact, but for rosettes, where it is exact to first order at the edge.
    """
    match figure:
        case Disc():
            radius = np.hypot(x, y)
            # A disc without a hole has no inner edge at its middle.
            inner = figure.inner_mm - radius if figure.inner_mm > 0 else -np.inf
            return np.maximum(radius - figure.radius_mm, inner)
        case Rectangle():
            across, up = np.abs(x) - figure.width_mm / 2, np.abs(y) - figure.height_mm / 2
            outside = np.hypot(np.maximum(across, 0), np.maximum(up, 0))
            return outside + np.minimum(np.maximum(across, up), 0)
        case Polygon():
            return _from_polygon(np.array(figure.corners_mm), x, y)
        case Star():
            return _from_polygon(star_corners(figure), x, y)
        case Stroke():
            return _from_stroke(figure, x, y)
        case Rosette():
            return _from_rosette(figure, x, y)


def bounding_disc(figure: Figure) -> tuple[float, float, float]:
    """x and y of the middle and radius of a disc, in the figure's frame, that holds it, mm."""
    match figure:
        case Disc() | Star():
            return 0.0, 0.0, figure.radius_mm
        case Rectangle():
            return 0.0, 0.0, float(np.hypot(figure.width_mm, figure.height_mm)) / 2
        case Polygon():
            corners = np.array(figure.corners_mm)
            x, y = (corners.min(axis=0) + corners.max(axis=0)) / 2
            return float(x), float(y), float(np.hypot(*(corners - (x, y)).T).max())
        case Stroke():
            half = (figure.to_mm - figure.from_mm + max(figure.width_mm)) / 2
            return (figure.from_mm + figure.to_mm) / 2, 0.0, half
        case Rosette():
            line = figure.width_mm or 0.0
            return 0.0, 0.0, figure.radius_mm + figure.amplitude_mm + line / 2


def star_corners(star: Star) -> Array:
    """Its points and notches by turns, (x, y) in mm, shape (2·points, 2)."""
    direction = np.pi / star.points * np.arange(2 * star.points)
    radius = star.radius_mm * np.where(np.arange(2 * star.points) % 2, star.notch, 1.0)
    return np.stack([radius * np.cos(direction), radius * np.sin(direction)], axis=-1)


def _from_polygon(corners: Array, x: Array, y: Array) -> Array:
    squared = np.full(x.shape, np.inf)
    inside = np.zeros(x.shape, bool)
    for (x0, y0), (x1, y1) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        along, up = x1 - x0, y1 - y0
        side = along**2 + up**2
        if side == 0:
            continue
        share = np.clip(((x - x0) * along + (y - y0) * up) / side, 0, 1)
        squared = np.minimum(squared, (x - x0 - share * along) ** 2 + (y - y0 - share * up) ** 2)
        # The ray from a point to the right crosses the side.
        crosses = ((y0 <= y) != (y1 <= y)) & ((up > 0) == ((x - x0) * up < (y - y0) * along))
        inside ^= crosses
    return np.where(inside, -1.0, 1.0) * np.sqrt(squared)


def _from_stroke(stroke: Stroke, x: Array, y: Array) -> Array:
    length = stroke.to_mm - stroke.from_mm
    first, last = (width / 2 for width in stroke.width_mm)
    along, off = x - stroke.from_mm, np.abs(y)
    # The common tangent leans by this angle; it touches the discs at right angles to itself.
    sine = (first - last) / length
    cosine = np.sqrt(1 - sine**2)
    foot = along * cosine - off * sine
    between = along * sine + off * cosine - first
    ends = np.where(foot < 0, np.hypot(along, off) - first, np.hypot(along - length, off) - last)
    return np.where((foot >= 0) & (foot <= cosine * length), between, ends)


def _from_rosette(rosette: Rosette, x: Array, y: Array) -> Array:
    radius, direction = np.hypot(x, y), rosette.lobes * np.arctan2(y, x)
    amplitude = rosette.amplitude_mm
    edge = rosette.radius_mm + amplitude * np.cos(direction)
    slope = rosette.lobes * amplitude * np.sin(direction) / edge
    distance = (radius - edge) / np.sqrt(1 + slope**2)
    return distance if rosette.width_mm is None else np.abs(distance) - rosette.width_mm / 2
