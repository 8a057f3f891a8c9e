"""Textures of equal shapes strewn over a repeating tile."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError

from precompute.errors import InputError, unreadable

Array = NDArray[np.float64]
Figure = Callable[[Array, Array], NDArray[np.bool_]]
"""Whether (x, y) lies on the shape, whose square box is |x|, |y| ≤ ½; it is asked within alone."""

TEXELS_AT_ONCE = 1 << 21


def disc(x: Array, y: Array) -> NDArray[np.bool_]:
    """A disc of diameter 1.

    Args:
        x: Shares of the box' side from its middle, −½ to ½.
        y: Likewise shares, that shape.
    """
    return x**2 + y**2 <= 0.25


def square(x: Array, y: Array) -> NDArray[np.bool_]:
    """All of the box.

    Args:
        x: Shares of the box' side from its middle, −½ to ½.
        y: Likewise shares, that shape.
    """
    return np.ones(np.broadcast_shapes(x.shape, y.shape), bool)


def mask(file: Path) -> Figure:
    """The light and opaque half of a PNG, its longer side as long as the box.

    Raises:
        InputError: No PNG of 8 bits a channel, or none of it is light and opaque.
    """
    try:
        with Image.open(file, formats=["PNG"]) as image:
            if image.mode.startswith(("I", "F")):
                raise InputError(file, "bits", image.mode, "8 bits a channel")
            texels = np.asarray(image.convert("LA"), float) / 255
    except (UnidentifiedImageError, Image.DecompressionBombError, OSError) as failure:
        raise unreadable(file, failure) from failure
    light = texels.prod(axis=-1) >= 0.5
    if not light.any():
        raise InputError(file, "texels", "all dark or transparent", "a light, opaque figure")
    rows, columns = light.shape

    def figure(x: Array, y: Array) -> NDArray[np.bool_]:
        column = np.floor(x * max(rows, columns) + columns / 2).astype(np.intp)
        row = np.floor(-y * max(rows, columns) + rows / 2).astype(np.intp)
        within = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
        return within & light[np.clip(row, 0, rows - 1), np.clip(column, 0, columns - 1)]

    return figure


def area(figure: Figure) -> float:
    """Share of its box that a shape covers, to a thousandth."""
    x = (np.arange(512) + 0.5) / 512 - 0.5
    return float(figure(x[None, :], x[:, None]).mean())


def strewn(figure: Figure, places: Array, side: float, size: int) -> NDArray[np.intp]:
    """Paint shapes over one another.

    Args:
        figure: What they look like.
        places: Middles of their boxes on the unit tile, shape (count, 2), the topmost last.
        side: Of their boxes, a share of the tile's side, ½ at most.
        size: Texels along the tile's side.

    Returns:
        The uppermost shape at each texel's centre, −1 where there is none. Shape (size, size), the
        first row being the top.
    """
    uppermost = np.full(size * size, -1, np.intp)
    wide = int(np.ceil(side * size)) + 1
    at_once = max(TEXELS_AT_ONCE // wide**2, 1)
    for start in range(0, len(places), at_once):
        some = places[start : start + at_once]
        middle = np.stack([some[:, 0], 1 - some[:, 1]]) * size  # texels from the left, from the top
        first = np.ceil(middle - side * size / 2 - 0.5).astype(np.intp)
        texel = first[..., None] + np.arange(wide)
        apart = (texel + 0.5 - middle[..., None]) / (side * size)
        x, y = apart[0][:, None, :], -apart[1][:, :, None]
        covered = (np.abs(x) <= 0.5) & (np.abs(y) <= 0.5) & figure(x, y)
        column, row = texel % size
        which = np.arange(start, start + len(some))[:, None, None]
        here = np.broadcast_to(row[:, :, None] * size + column[:, None, :], covered.shape)
        np.maximum.at(uppermost, here[covered], np.broadcast_to(which, covered.shape)[covered])
    return uppermost.reshape(size, size)
