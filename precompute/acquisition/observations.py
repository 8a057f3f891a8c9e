"""What every tile of every photograph shows of the same points of the pattern."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from precompute.acquisition.rectification import Rectification
from precompute.acquisition.tiling import Tiling

Array = NDArray[np.float64]
Array32 = NDArray[np.float32]

ENTRIES = 600_000
"""Observations of a strip: some 30 MB with all that is reckoned from them."""

FOLD = 1024
"""Points to a row when a list is looked up as a picture."""


@dataclass(frozen=True)
class Shot:
    """A photograph and all that is known of how it was taken.

    Attributes:
        name: What messages call it.
        values: Linear, full scales per second, shape (height, width, channels).
        usable: Where no channel clips, shape (height, width).
        rectification: Of the sample's plane.
        light: Position of the lamp, mm, shape (3,).
        radius: Standard deviation of the lamp as seen from the sample, rad.
        weights: Its spectrum times the channels' sensitivity, shape (401, channels).
        background: What a dark point shows, over irradiance, shape (channels,).
    """

    name: str
    values: Array32
    usable: NDArray[np.bool_]
    rectification: Rectification
    light: Array
    radius: float
    weights: Array
    background: Array32


@dataclass(frozen=True)
class Strip:
    """Observations of n points of the pattern, each in J tiles and photographs.

    Attributes:
        intensity: Radiance over irradiance, background taken off, 0 where not usable, shape
            (n, J, channels).
        u: (ω_i + ω_o)_x, shape (n, J).
        v: (ω_i + ω_o)_y.
        usable: Where the point is on the sample, in the picture, not clipped and not in the
            highlight, shape (n, J).
        shot: Which photograph, shape (J,).
    """

    intensity: Array32
    u: Array32
    v: Array32
    usable: NDArray[np.bool_]
    shot: NDArray[np.intp]

    def of_shot(self, number: int) -> Strip:
        """What one photograph alone shows, as its only one.

        Args:
            number: Its index.
        """
        here = self.shot == number
        return Strip(
            self.intensity[:, here],
            self.u[:, here],
            self.v[:, here],
            self.usable[:, here],
            self.shot[here] * 0,
        )


def half_vectors(points: Array, eye: Array, light: Array) -> tuple[Array, Array]:
    """ω_i + ω_o, shape (n, 3), and cosθ_i d0²/d² at points of the plane z = 0, shape (n, 2), mm.

    Args:
        points: x, y, mm.
        eye: The camera's centre of projection, shape (3,).
        light: The lamp; d0 is its distance from the origin, shape (3,).
    """
    position = np.concatenate([points, np.zeros((len(points), 1))], axis=1)
    towards, back = light - position, eye - position
    # A sum over an axis of three is ten times as slow by np.sum.
    squared, far = (np.einsum("nk,nk->n", way, way) for way in (towards, back))
    wi = towards / np.sqrt(squared)[:, None]
    wo = back / np.sqrt(far)[:, None]
    return wi + wo, wi[:, 2] * np.sum(light**2) / squared


def observed(
    shots: list[Shot],
    tiling: Tiling,
    place: Array,
    highlight: float,
    tiles: list[tuple[int, int]] | None = None,
) -> Strip:
    """Look points of the pattern up in the tiles of all photographs.

    Args:
        shots: The photographs.
        tiling: Where the tiles lie.
        place: Points right of and below a tile's top left corner, in tiles, shape (n, 2).
        highlight: ρ, no unit, below which the lamp's reflection outshines all.
        tiles: Indices, row and column, of those to look in; all if left out.
    """
    tiles = tiling.tiles() if tiles is None else tiles
    n, channels = len(place), shots[0].values.shape[2]
    count = len(tiles) * len(shots)
    intensity = np.zeros((n, count, channels), np.float32)
    u, v = np.zeros((n, count), np.float32), np.zeros((n, count), np.float32)
    usable = np.zeros((n, count), bool)
    for index, (row, column) in enumerate(tiles):
        points = tiling.points(row, column, place)
        inside = tiling.on_sample(points)
        for number, shot in enumerate(shots):
            j = number * len(tiles) + index
            seen, good = looked_up(shot, points)
            h, irradiance = half_vectors(points, shot.rectification.eye, shot.light)
            u[:, j], v[:, j] = h[:, 0], h[:, 1]
            good &= inside & (h[:, 0] ** 2 + h[:, 1] ** 2 > highlight**2)
            usable[:, j] = good
            shown = seen / irradiance[:, None].astype(np.float32) - shot.background
            intensity[:, j] = np.where(good[:, None], shown, 0)
    return Strip(intensity, u, v, usable, np.repeat(np.arange(len(shots)), len(tiles)))


def looked_up(shot: Shot, points: Array) -> tuple[Array32, NDArray[np.bool_]]:
    """A photograph's values at points of the sample, and where they can be used.

    Args:
        shot: The photograph.
        points: mm, shape (n, 2).

    Returns:
        Full scales per s, shape (n, channels), linear between pixels, and whether, shape (n,).
    """
    pixels = shot.rectification.pixels(points).astype(np.float32)
    # OpenCV looks up pictures of some 32000 pixels a side at most: the list is folded.
    folded = np.zeros((-(-len(points) // FOLD) * FOLD, 2), np.float32)
    folded[: len(points)] = pixels
    x, y = (np.ascontiguousarray(part).reshape(-1, FOLD) for part in folded.T)
    found = cv2.remap(shot.values, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    values = found.reshape(len(folded), -1)[: len(points)]
    height, width = shot.usable.shape
    column, row = np.round(pixels[:, 0]).astype(np.intp), np.round(pixels[:, 1]).astype(np.intp)
    inside = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    good = inside & shot.usable[row.clip(0, height - 1), column.clip(0, width - 1)]
    return np.asarray(values, np.float32), good


def texel_places(size: tuple[int, int]) -> Array:
    """Middles of a map's texels, shares of a tile, row by row from the top.

    Shape (rows · columns, 2).

    Args:
        size: Columns and rows.
    """
    columns, rows = size
    x, y = np.meshgrid((np.arange(columns) + 0.5) / columns, (np.arange(rows) + 0.5) / rows)
    return np.stack([x.ravel(), y.ravel()], axis=1)


def strips(texels: int, observations: int) -> Iterator[slice]:
    """Runs of texels whose observations fit in memory at once.

    Args:
        texels: How many there are.
        observations: How many there are of each.
    """
    length = max(1, ENTRIES // observations)
    for start in range(0, texels, length):
        yield slice(start, min(start + length, texels))
