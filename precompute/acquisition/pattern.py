"""A foil's map as the gratings found at points of a sheet on which its tile repeats."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from precompute.maps import Map

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Gratings:
    """Gratings at points of a foil, arrays of one shape.

    Attributes:
        orientation: θ, the angle of the grating vector from x, rad, modulo π.
        frequency: 1/a, 1/µm.
        strength: Share that diffracts.
    """

    orientation: Array
    frequency: Array
    strength: Array

    def __getitem__(self, index: NDArray[np.intp]) -> Gratings:
        return Gratings(self.orientation[index], self.frequency[index], self.strength[index])


def gratings_of(foil: Map) -> Gratings:
    """The texels of a foil's map, arrays of shape (rows, columns), the first row on top."""
    cosine, sine, frequency, strength = np.moveaxis(foil.tables["grating"].values, -1, 0)
    return Gratings(np.mod(np.arctan2(sine, cosine) / 2, np.pi), frequency, strength)


def texel_indices(shape: tuple[int, ...], xy: Array) -> NDArray[np.intp]:
    """The texel at positions on a tile that repeats.

    Args:
        shape: Rows and columns of the map.
        xy: In tiles: (0, 0) is the lower left corner of one, (1, 1) its upper right, shape (n, 2).

    Returns:
        Indices into the flattened map, shape (n,).
    """
    rows, columns = shape
    column = np.floor(xy[:, 0] * columns).astype(np.intp) % columns
    row = np.floor(-xy[:, 1] * rows).astype(np.intp) % rows
    return row * columns + column
