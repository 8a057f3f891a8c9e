"""Bumps of a foil: by how much its surface leans at each texel.

A foil that is not quite flat glitters (Toisoul, Dhillon and Ghosh 2018, section 6.2).
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter, map_coordinates

from precompute.errors import InputError, unreadable
from precompute.foils.foil_map import foil_axes
from precompute.height_fields.read import read_height_field
from precompute.maps import Table

Array = NDArray[np.float64]

CHANNELS = ("n_u/n_z", "n_v/n_z", "1", "1")

LEVELS = 127
"""Steps up from texel 128, which is no slope, to the steepest, and as many down; 0 is not used.
About 127.5, the middle of 8 bits, nothing could be flat."""

STEEPEST = 1.0
"""Slope, 45°, beyond which a surface is no foil with bumps."""


@dataclass(frozen=True)
class Bumps:
    """A foil's normals.

    Attributes:
        normal: Their components along u and v over that along z, −∂z/∂u and −∂z/∂v as lengths
            over lengths, shape (rows, columns, 2), the first row on top.
        steepest: No slope, √(u² + v²), is larger; it sets the steps of the map, so that it stays
            when texels are cut off or turned.
    """

    normal: Array
    steepest: float

    def moved(self, index: Any) -> Bumps:
        """The texels of an index into rows and columns."""
        return replace(self, normal=self.normal[index])

    def at(self, row: Array, column: Array) -> Bumps:
        """At places between texels, on a tile that repeats: slopes, unlike gratings, have a mean.

        Args:
            row: Texels from the first, a real number each; shape (rows, columns) or broadcast to
                it.
            column: Texels from the first, likewise.
        """
        places = np.broadcast_arrays(row, column)
        channels = [
            map_coordinates(channel, places, order=1, mode="grid-wrap")
            for channel in np.moveaxis(self.normal, -1, 0)
        ]
        return replace(self, normal=np.stack(channels, axis=-1))

    def turned(self, degrees: float) -> Bumps:
        """Turned counter-clockwise, the texels where they are; by quarter turns exactly."""
        quarters, rest = divmod(degrees % 360, 90)
        slope = self.normal[..., 0] + 1j * self.normal[..., 1]
        slope = slope * 1j ** int(quarters) * (np.exp(1j * np.radians(rest)) if rest else 1)
        return replace(self, normal=np.stack([slope.real, slope.imag], axis=-1))

    def table(self) -> Table:
        """The array ``normal`` of a foil's map."""
        ones = np.ones_like(self.normal)
        decode = (-self.steepest * (LEVELS + 1) / LEVELS, self.steepest * 255 / LEVELS)
        return Table(
            np.concatenate([self.normal, ones], axis=-1),
            foil_axes(*self.normal.shape[:2]),
            CHANNELS,
            "uint8",
            (decode, decode, (0.0, 1.0), (0.0, 1.0)),
        )

    @staticmethod
    def of(table: Table) -> Bumps:
        """What `table` made, or such an array."""
        assert table.decode is not None  # of 8 bits, as every `normal` is
        return Bumps(table.values[..., :2], table.decode[0][1] * LEVELS / 255)


def random_bumps(
    shape: tuple[int, int],
    tile_mm: tuple[float, float],
    deviation: float,
    length_mm: float,
    seed: int,
) -> Bumps:
    """The slopes of a random surface that goes on from tile to tile.

    Heights z correlate as ρ(d) = exp(−d²/L²), so that their power spectrum is ∝ exp(−k²L²/4), and
    slopes as −s²L²/2 · ∂²ρ/∂u²: along their own axis as (1 − 2d²/L²) ρ(d), across it as ρ(d). Each
    wave has its amplitude and a random phase. Whatever the seed, deviation and correlation over
    the tile are those stated.

    Args:
        shape: Rows and columns.
        tile_mm: Width and height, mm.
        deviation: Standard deviation s of the slope along u, and along v.
        length_mm: Correlation length L, at which ρ is 1/e, mm: two texels to a quarter of the
            tile.
        seed: The phases', a whole number.

    Raises:
        InputError: The length is not in its range.
    """
    rows, columns = shape
    width, height = tile_mm
    shortest, longest = 2 * max(width / columns, height / rows), min(tile_mm) / 4
    if not shortest <= length_mm <= longest:
        expected = f"two texels to a quarter of the tile, {shortest:.4g} to {longest:.4g} mm"
        raise InputError("edit bumps", "length_mm", length_mm, expected)
    waves = np.fft.rfft2(np.random.default_rng(seed).standard_normal(shape))
    k_u = 2 * np.pi * np.fft.rfftfreq(columns, width / columns)
    k_v = -2 * np.pi * np.fft.fftfreq(rows, height / rows)[:, None]  # rows go down
    spectrum = np.exp(-(k_u**2 + k_v**2) * length_mm**2 / 8) * waves / np.abs(waves)
    normal = np.stack([np.fft.irfft2(-1j * k * spectrum, shape) for k in (k_u, k_v)], axis=-1)
    return _bumps(normal * deviation / np.sqrt(np.mean(normal**2)))


def bumps_of_heights(
    file: Path, depth_um: float, shape: tuple[int, int], tile_mm: tuple[float, float]
) -> tuple[Bumps, str]:
    """The slopes of a picture of heights that is stretched over the tile.

    Args:
        file: Grey of 8 or 16 bits, or numbers (`precompute.height_fields.read`). It goes on from
            its right to its left edge and from its top to its bottom.
        depth_um: Height of white over black, or of the number 1, µm.
        shape: Rows and columns of the slopes, each the mean over its texel.
        tile_mm: Width and height, mm.

    Returns:
        The bumps, and the file's checksum.

    Raises:
        InputError: The file cannot be used, or a slope would be above `STEEPEST`.
    """
    # Stretched over the tile it has another pitch than its own.
    heights = read_height_field(file, (1.0, 1.0), depth_um).heights[::-1]
    per_texel = np.array(heights.shape) / shape
    smooth = gaussian_filter(heights, np.maximum(per_texel - 1, 0) / 2, mode="wrap")
    middle_row, middle_column = (
        (np.arange(count) + 0.5) * ratio - 0.5
        for count, ratio in zip(shape, per_texel, strict=True)
    )
    row, column = middle_row[:, None], middle_column[None, :]

    def at(row: Array, column: Array) -> Array:
        places = np.broadcast_arrays(row, column)
        return map_coordinates(smooth, places, order=3, mode="grid-wrap")

    half_row, half_column = per_texel / 2
    across = at(row, column + half_column) - at(row, column - half_column)
    up = at(row - half_row, column) - at(row + half_row, column)
    pitch = 1000 * np.array(tile_mm) / shape[::-1]
    bumps = _bumps(-np.stack([across, up], axis=-1) / pitch)
    if bumps.steepest > STEEPEST:
        expected = f"slopes of 1 (45 degrees) at most, not {bumps.steepest:.4g}"
        raise InputError("edit bumps", "depth_um", depth_um, expected)
    try:
        return bumps, hashlib.sha256(file.read_bytes()).hexdigest()
    except OSError as failure:
        raise unreadable(file, failure) from failure


def _bumps(normal: Array) -> Bumps:
    return Bumps(normal, float(np.hypot(normal[..., 0], normal[..., 1]).max()))
