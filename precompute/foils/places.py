"""Places on a repeating tile, its side being 1: opposite edges are one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

Array = NDArray[np.float64]
ROOMY = 100
"""Candidates for points that leave discs about them much room."""


def texel_places(size: int) -> tuple[Array, Array]:
    """x and y of texels' centres, each of shape (size, size); the first row is the top, y ≈ 1."""
    texel = (np.arange(size) + 0.5) / size
    x, y = np.meshgrid(texel, texel[::-1])
    return x, y


def spread_points(rng: np.random.Generator, count: int, candidates: int = 10) -> Array:
    """Points, none very close to another: each the best of some candidates. Shape (count, 2)."""
    points = rng.random((1, 2))
    while len(points) < count:
        places = rng.random((candidates, 2))
        distance, _ = KDTree(points, boxsize=1).query(places)
        points = np.concatenate([points, places[[np.argmax(distance)]]])
    return points


def from_nearest(points: Array, size: int) -> tuple[NDArray[np.intp], Array, Array, Array]:
    """The point nearest to each texel, and where the texel lies as seen from there.

    Args:
        points: Two or more, shape (count, 2).
        size: Texels along a side.

    Returns:
        The point's index; the texel's distance from it; its direction, rad; and the width of the
        band about the border with the next point's cell in which it would just lie. Each of shape
        (size, size).
    """
    x, y = texel_places(size)
    distances, nearest = KDTree(points, boxsize=1).query(np.stack([x, y], axis=-1), k=2)
    cell = np.asarray(nearest)[..., 0]
    apart = np.mod(np.stack([x, y], axis=-1) - points[cell] + 0.5, 1) - 0.5
    direction = np.arctan2(apart[..., 1], apart[..., 0])
    return cell, distances[..., 0], direction, distances[..., 1] - distances[..., 0]


def room(points: Array) -> Array:
    """Radius of the largest disc about each point that lies in its cell. Shape (count,)."""
    distances, _ = KDTree(points, boxsize=1).query(points, k=2)
    return distances[:, 1] / 2
