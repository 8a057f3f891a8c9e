"""Where the tiles of a repeating sample lie."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Tiling:
    """A lattice of tiles, each a little off its place.

    Attributes:
        size: Width and height of a tile, mm, shape (2,).
        corner: Top left corner of the tile in row 0 and column 0, mm, shape (2,).
        shifts: By how much each tile's pattern is off, mm, shape (rows, columns, 2).
        sample: Width and height of the sample, mm, shape (2,).
    """

    size: Array
    corner: Array
    shifts: Array
    sample: Array

    @staticmethod
    def covering(sample: Array, size: Array, corner: Array) -> Tiling:
        """All tiles that lie on a sample at least in part, each in its place.

        Args:
            sample: Its width and height, mm.
            size: Those of a tile, mm.
            corner: Top left corner of any tile, mm.
        """
        half = sample / 2
        before = np.ceil(np.round([(corner[0] + half[0]), (half[1] - corner[1])] / size, 6))
        first = corner + before * size * [-1, 1]
        count = np.ceil(np.round([half[0] - first[0], first[1] + half[1]] / size, 6)).astype(int)
        shape = (int(count[1]), int(count[0]))
        return Tiling(size, first, np.zeros((*shape, 2)), sample)

    def tiles(self) -> list[tuple[int, int]]:
        """Row and column of each tile."""
        return list(np.ndindex(*self.shifts.shape[:2]))

    def points(self, row: int, column: int, place: Array) -> Array:
        """Where points of the pattern lie in one tile.

        Args:
            row: Index of the tile from the top.
            column: Index from the left.
            place: Right of and below the tile's top left corner, in tiles, shape (n, 2).

        Returns:
            mm, shape (n, 2).
        """
        offset = (place - 0.5) * self.size * [1, -1]
        middle = self.corner + (np.array([column, row]) + 0.5) * self.size * [1, -1]
        return middle + offset + self.shifts[row, column]

    def on_sample(self, points: Array) -> NDArray[np.bool_]:
        """Which points, mm, shape (n, 2), lie on the sample."""
        return np.all(np.abs(points) <= self.sample / 2, axis=1)
