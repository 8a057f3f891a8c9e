"""A patch of relief that repeats over the surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class HeightField:
    """Heights on a rectangular grid; the patch repeats along both axes.

    Attributes:
        heights: h, µm, shape (rows, columns): ``heights[j, i]`` lies at x = i·pitch_x,
            y = j·pitch_y, so that row 0 is the lowest in a picture of the patch.
        pitch: Distance between samples along x and y, µm.
    """

    heights: Array
    pitch: tuple[float, float]

    @property
    def period(self) -> tuple[float, float]:
        """Lengths of the patch along x and y, µm."""
        rows, columns = self.heights.shape
        return columns * self.pitch[0], rows * self.pitch[1]

    @property
    def amplitude(self) -> float:
        """Δ/2, half the range of the heights, µm."""
        return float(np.ptp(self.heights)) / 2

    @property
    def centred(self) -> Array:
        """t = (h − h_c)/(Δ/2), no unit, from −1 at the lowest sample to 1 at the highest.

        >>> HeightField(np.array([[1.0, 2.0], [2.0, 3.0]]), (0.1, 0.1)).centred.tolist()
        [[-1.0, 0.0], [0.0, 1.0]]
        """
        middle = (self.heights.max() + self.heights.min()) / 2
        return (self.heights - middle) / self.amplitude
