"""Places on a repeating tile, its side being 1: opposite edges are one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

Array = NDArray[np.float64]
ROOMY = 100
"""Candidates for points that leave discs about them much room."""


def texel_places(size: int) -> tuple[Array, Array]:
    """x and y of texels' centres, shares of the tile's side, each of shape (size, size).

    The first row is the top, y ≈ 1.
    """
    texel = (np.arange(size) + 0.5) / size
    x, y = np.meshgrid(texel, texel[::-1])
    return x, y


def spread_points(rng: np.random.Generator, count: int, candidates: int = 10) -> Array:
    """Points, none very close to another: each the best of some candidates.

    Shares of the tile's side, shape (count, 2).
    """
    points = rng.random((1, 2))
    while len(points) < count:
        places = rng.random((candidates, 2))
        distance, _ = KDTree(points, boxsize=1).query(places)
        points = np.concatenate([points, places[[np.argmax(distance)]]])
    return points


def from_nearest(points: Array, size: int) -> tuple[NDArray[np.intp], Array, Array, Array]:
    """The point nearest to each texel, where the texel lies as seen from there, and from the next.

    Args:
        points: Two or more, shape (count, 2).
        size: Texels along a side.

    Returns:
        The point's index; the texel's distance from it; its direction, rad; and how much further
        the next point is, which on the line between the two is twice the distance from the
        border of their cells. Each of shape (size, size).
    """
    tree = KDTree(points, boxsize=1)
    cell = np.empty((size, size), np.intp)
    distance, direction, gap = (np.empty((size, size)) for _ in range(3))
    for row, places in enumerate(np.stack(texel_places(size), axis=-1)):
        distances, nearest = tree.query(places, k=2)
        cell[row] = np.asarray(nearest)[:, 0]
        distance[row] = distances[:, 0]
        gap[row] = distances[:, 1] - distances[:, 0]
        apart = np.mod(places - points[cell[row]] + 0.5, 1) - 0.5
        direction[row] = np.arctan2(apart[:, 1], apart[:, 0])
    return cell, distance, direction, gap


def room(points: Array) -> Array:
    """Radius of the largest disc about each point that lies in its cell.

    A share of the square's side, shape (count,).

    Args:
        points: In the unit square, whose opposite sides meet; shape (count, 2).
    """
    distances, _ = KDTree(points, boxsize=1).query(points, k=2)
    return distances[:, 1] / 2
