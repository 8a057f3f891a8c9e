"""Earth mover's distances: how much has to be moved how far to make one picture of another.

The exact least cost, by linear programming. Where both have light it stays, which costs nothing
more as long as costs are distances; what is left of the one goes to what is left of the other.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.sparse import csr_array, eye_array, kron, vstack

from precompute.foils.distribution import GratingDistribution

Array = NDArray[np.float64]

ORIENTATIONS = 36
"""Cells over θ in which distributions are compared, of 5°."""

LOG_STEP = 0.035
"""Of cells over ln(1/a): 3.5 % of the period."""


def earth_movers_distance(first: Array, second: Array, distance: Array) -> float:
    """The least Σ moved · distance that makes one distribution of another.

    Args:
        first: Shares that sum to 1, shape (n,).
        second: Shares likewise.
        distance: Of each place from each, a metric, shape (n, n).

    Returns:
        In the distance's unit.

    >>> line = np.abs(np.subtract.outer(np.arange(3.0), np.arange(3.0)))
    >>> earth_movers_distance(np.array([1.0, 0, 0]), np.array([0, 0.5, 0.5]), line)
    1.5
    """
    surplus = first - second
    source, sink = np.flatnonzero(surplus > 1e-12), np.flatnonzero(surplus < -1e-12)
    if not (len(source) and len(sink)):
        return 0.0
    leaves = kron(eye_array(len(source)), np.ones((1, len(sink))))
    arrives = kron(np.ones((1, len(source))), eye_array(len(sink)))
    # The last sink takes what is left, which rounding cannot make infeasible.
    rows = csr_array(vstack([leaves, arrives]))[:-1]
    solved = linprog(
        distance[np.ix_(source, sink)].ravel(),
        A_eq=rows,
        b_eq=np.concatenate([surplus[source], -surplus[sink]])[:-1],
        method="highs",
    )
    if not solved.success:
        raise RuntimeError(f"linear programming: {solved.message}")
    return float(solved.fun)


def distribution_distance(first: GratingDistribution, second: GratingDistribution) -> float:
    """The earth mover's distance of two distributions on the cylinder of θ modulo π and ln(1/a).

    A move by Δθ and Δln(1/a) costs √(Δθ² + (Δln(1/a))²): by how much of its own length the
    grating's vector (1/a)(cos θ, sin θ) moves. 0.01 is 0.57°, or 1 % of the period.

    Args:
        first: A distribution; both are gathered in cells of 5° × 3.5 %, so that less than some
            0.01 is not told apart from nothing.
        second: Another.

    Returns:
        rad.
    """
    lows, highs = zip(*(_support(one) for one in (first, second)), strict=True)
    start = np.floor(np.log(min(lows)) / LOG_STEP)
    stop = np.ceil(np.log(max(highs)) / LOG_STEP)
    edges = np.exp(LOG_STEP * np.arange(start, stop + 1))
    shares = [_gathered(one, edges).ravel() for one in (first, second)]
    θ = np.arange(ORIENTATIONS) * np.pi / ORIENTATIONS
    turn = np.abs(np.subtract.outer(θ, θ))
    turn = np.minimum(turn, np.pi - turn)
    step = LOG_STEP * np.abs(
        np.subtract.outer(np.arange(len(edges) - 1), np.arange(len(edges) - 1))
    )
    distance = np.hypot(turn[:, None, :, None], step[None, :, None, :])
    n = len(shares[0])
    return earth_movers_distance(shares[0], shares[1], distance.reshape(n, n))


def picture_distance(first: Array, second: Array, pitch: float) -> float:
    """The earth mover's distance of two pictures' light.

    Args:
        first: Light, not below 0 and not all 0, shape (rows, columns); only its shares count.
        second: Of the same shape.
        pitch: From pixel to pixel, mm or whatever unit.

    Returns:
        In that unit.
    """
    row, column = np.indices(first.shape)
    place = pitch * np.stack([row.ravel(), column.ravel()], axis=1)
    apart = place[:, None] - place[None]
    a, b = (picture.ravel() / picture.sum() for picture in (first, second))
    return earth_movers_distance(a, b, np.hypot(apart[..., 0], apart[..., 1]))


def _support(distribution: GratingDistribution) -> tuple[float, float]:
    """Lowest and highest frequency that occur."""
    (columns,) = np.nonzero(distribution.weights.any(axis=0))
    edges = distribution.frequency_edges
    return float(edges[columns[0]]), float(edges[columns[-1] + 1])


def _gathered(distribution: GratingDistribution, edges: Array) -> Array:
    """Shares of cells over θ from 0 to π and between edges of 1/a, each cell evenly filled."""
    cells = np.linspace(0, np.pi, ORIENTATIONS + 1)
    over = np.zeros((len(distribution.weights), ORIENTATIONS))
    # Edges of a distribution may lie anywhere: what is beyond 0 or π belongs half a turn off.
    for turn in range(-2, 3):
        over += _overlaps(distribution.orientation_edges + turn * np.pi, cells)
    return over.T @ distribution.weights @ _overlaps(distribution.frequency_edges, edges)


def _overlaps(source: Array, target: Array) -> Array:
    """Which share of each source cell lies in each target cell, shape (sources, targets)."""
    low = np.maximum(source[:-1, None], target[None, :-1])
    high = np.minimum(source[1:, None], target[None, 1:])
    return np.maximum(high - low, 0) / np.diff(source)[:, None]
