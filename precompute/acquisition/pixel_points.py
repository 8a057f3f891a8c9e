"""Which points of a sheet pixels show: one each, several where gratings meet."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from precompute.acquisition.pattern import Gratings

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PixelPoints:
    """Points that stand for pixels.

    Attributes:
        xy: On the plane of the sheet, mm, shape (n, 2).
        texels: The texel that shows there, −1 beside the sheet, shape (n,).
        pixel: Index of the pixel that each is a part of, shape (n,).
        share: Of that pixel, shape (n,).
        pixels: How many pixels there are.
    """

    xy: Array
    texels: NDArray[np.intp]
    pixel: NDArray[np.intp]
    share: Array
    pixels: int

    def gathered(self, values: Array) -> Array:
        """What pixels show of values at the points, shape (n, channels), in their unit.

        Shape (pixels, channels).
        """
        shares = self.share[:, None] * values
        columns = [np.bincount(self.pixel, c, self.pixels) for c in shares.T]
        return np.stack(columns, axis=-1).astype(np.float64)


def pixel_points(
    pixels: Array,
    on_sheet: Callable[[Array], Array],
    texels: Callable[[Array], NDArray[np.intp]],
    gratings: Gratings,
    subpixels: int,
) -> PixelPoints:
    """Points for pixels: the middle of one that a grating fills, a grid in one that shows several.

    Args:
        pixels: x, y in px, shape (n, 2).
        on_sheet: Where on the sheet's plane positions in px are.
        texels: The index of the texel at positions on the plane, −1 beside the sheet.
        gratings: Of the texels.
        subpixels: How many along each side of a pixel.
    """
    steps = (np.arange(subpixels) + 0.5) / subpixels - 0.5
    offsets = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    seen = on_sheet((pixels[:, None] + offsets).reshape(-1, 2))
    texel = texels(seen).reshape(len(pixels), -1)
    flat = [part.ravel() for part in vars(gratings).values()]
    shown = np.stack([np.where(texel < 0, -1, part[texel]) for part in flat])
    even = np.all(shown == shown[..., :1], axis=(0, 2))
    middles, mixed = np.flatnonzero(even), np.flatnonzero(~even)
    pixel = np.concatenate([middles, np.repeat(mixed, texel.shape[1])])
    return PixelPoints(
        xy=np.concatenate(
            [on_sheet(pixels[middles]), seen.reshape(*texel.shape, 2)[mixed].reshape(-1, 2)]
        ),
        texels=np.concatenate([texel[middles, 0], texel[mixed].ravel()]),
        pixel=pixel,
        share=np.where(even, 1.0, 1 / texel.shape[1])[pixel],
        pixels=len(pixels),
    )
