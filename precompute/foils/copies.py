"""Where a figure's copies lie."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from precompute.foils.figure_recipes import At, Points, Ring, Row, Strewn
from precompute.foils.places import ROOMY

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Frame:
    """A frame in another: shifted, turned, scaled.

    Attributes:
        x: Of its origin, mm.
        y: Likewise, mm.
        turn: Counter-clockwise, rad.
        scale: Factor of its lengths.
    """

    x: float = 0.0
    y: float = 0.0
    turn: float = 0.0
    scale: float = 1.0

    def point(self, x: float, y: float) -> tuple[float, float]:
        """A point of this frame as the outer one has it, mm.

        Args:
            x: To the right, mm.
            y: Upwards, mm.
        """
        cosine, sine = math.cos(self.turn), math.sin(self.turn)
        return (
            self.x + self.scale * (cosine * x - sine * y),
            self.y + self.scale * (sine * x + cosine * y),
        )

    def within(self, x: Array, y: Array) -> tuple[Array, Array]:
        """Points of the outer frame as this one has them, mm: the inverse of `point`.

        Args:
            x: To the right, mm, any shape.
            y: Upwards, mm, that shape.
        """
        cosine, sine = math.cos(self.turn), math.sin(self.turn)
        across, up = (x - self.x) / self.scale, (y - self.y) / self.scale
        return cosine * across + sine * up, cosine * up - sine * across

    def holding(self, inner: Frame) -> Frame:
        """A frame that is stated in this one, as the outer one has it."""
        x, y = self.point(inner.x, inner.y)
        return Frame(x, y, self.turn + inner.turn, self.scale * inner.scale)


def copies(at: At, tile_mm: float, rng: np.random.Generator) -> Iterator[Frame]:
    """The frames of a figure's copies, the topmost last.

    Args:
        at: Where they go.
        tile_mm: Side of the tile over which they may be strewn.
        rng: Strews, turns and shuffles.
    """
    match at:
        case Points():
            for p in at.points:
                yield Frame(p.x_mm, p.y_mm, math.radians(p.turn_deg), p.scale)
        case Row():
            for i in range(at.count):
                steps = i - (at.count - 1) / 2
                yield Frame(steps * at.step_mm[0], steps * at.step_mm[1])
        case Ring():
            scales = rng.permutation(np.linspace(at.scale[0], at.scale[1], at.count))
            for i, scale in enumerate(scales):
                turn = math.radians(at.start_deg) + 2 * math.pi * i / at.count
                x, y = at.radius_mm * math.cos(turn), at.radius_mm * math.sin(turn)
                yield Frame(x, y, turn, float(scale))
        case Strewn():
            scales = np.linspace(at.scale[1], at.scale[0], at.count)
            points = tile_mm * (_apart(rng, scales * at.radius_mm / tile_mm) - 0.5)
            turns = rng.random(at.count) * 2 * math.pi
            rows = np.column_stack([points, turns, scales])
            yield from (Frame(*row) for row in rows.tolist())


def _apart(rng: np.random.Generator, radii: Array) -> Array:
    """Middles of discs on the unit tile, each the clearest of some candidates. Shape (count, 2)."""
    points = np.empty((len(radii), 2))
    for i, radius in enumerate(radii):
        candidates = rng.random((ROOMY, 2))
        apart = np.abs(candidates[:, None] - points[:i])
        distance = np.hypot(*np.moveaxis(np.minimum(apart, 1 - apart), -1, 0))
        gap = (distance - radii[:i] - radius).min(axis=1, initial=np.inf)
        points[i] = candidates[np.argmax(gap)]
    return points
