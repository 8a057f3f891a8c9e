"""From the grating at each texel to a map of kind ``foil``.

Orientation θ is an angle modulo π and is stored as (cos 2θ, sin 2θ), period as 1/a.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from precompute.axes import Axis
from precompute.errors import InputError
from precompute.maps import Map, Table

Array = NDArray[np.float64]
CHANNELS = ("cos 2theta", "sin 2theta", "spatial frequency", "strength")


def foil_map(
    orientation: ArrayLike,
    frequency: ArrayLike,
    strength: ArrayLike,
    *,
    height: float,
    tile_mm: float | tuple[float, float],
    recipe: dict[str, Any],
) -> Map:
    """A map of gratings, in 8 bits a channel, that says what the rounding changed.

    Args:
        orientation: θ at each texel, from growing u to the grating vector, rad; any number stands
            for itself modulo π. Shape (rows, columns); the first row is the top, v = 1.
        frequency: 1/a, 1/µm, of that shape or broadcast to it; above 0 where the strength is.
        strength: Share of the surface that diffracts, 0 to 1, likewise.
        height: Of all gratings, µm.
        tile_mm: Width and height of the map, mm; one number stands for both.
        recipe: What the map was made from; its ``profile`` names the gratings' profile.

    Returns:
        A map with the array ``grating``, an RGBA image; further arrays may be added to its tables.

    Raises:
        InputError: Numbers are not finite or out of range, or nothing diffracts.
    """
    θ, f, s = np.broadcast_arrays(
        *(np.asarray(a, float) for a in (orientation, frequency, strength))
    )
    _check("orientation", θ, np.isfinite(θ), "finite angles, rad")
    _check("strength", s, (s >= 0) & (s <= 1), "0 to 1")
    _check("frequency", f, np.isfinite(f) & (f >= 0) & ((f > 0) | (s == 0)), "above 0 (1/µm)")
    values = np.stack([np.cos(2 * θ), np.sin(2 * θ), f, s], axis=-1)
    return map_of_texels(values, height=height, tile_mm=tile_mm, recipe=recipe)


def map_of_texels(
    values: Array,
    *,
    height: float,
    tile_mm: float | tuple[float, float],
    recipe: dict[str, Any],
) -> Map:
    """A map of texels as they are stored: `foil_map` without its checks.

    Args:
        values: `CHANNELS` of each texel, shape (rows, columns, 4).
        height: Of the relief, µm.
        tile_mm: Width and height of the map, mm.
        recipe: What the map was made from.

    Raises:
        InputError: Nothing diffracts.
    """
    f, s = values[..., 2], values[..., 3]
    diffracting = f[s > 0]
    if diffracting.size == 0:
        raise InputError("foil map", "strength", 0.0, "above 0 somewhere")
    top = float(f.max())
    decode = ((-1.0, 2.0), (-1.0, 2.0), (0.0, top), (0.0, 1.0))
    off = total = 0.0
    for c, (offset, scale) in enumerate(decode):  # one after the other: photographs are large
        channel = values[..., c]
        stored = offset + scale * np.round((channel - offset) / scale * 255) / 255
        off += float(np.sum((stored - channel) ** 2))
        total += float(np.sum(channel**2))
    tile = (tile_mm, tile_mm) if isinstance(tile_mm, int | float) else tile_mm
    return Map(
        kind="foil",
        quantity="grating at each point of a foil",
        symbol="(theta, 1/a, strength)",
        tables={"grating": Table(values, foil_axes(*f.shape), CHANNELS, "uint8", decode)},
        error={
            "relative_rms": float(np.sqrt(off / total)),
            "against": "the map before 8-bit rounding",
        },
        recipe=recipe,
        constants={
            "height_um": height,
            "min_frequency": float(diffracting.min()),
            "max_frequency": float(diffracting.max()),
            "tile_mm": tile,
        },
    )


def foil_axes(rows: int, columns: int) -> tuple[Axis, Axis]:
    """The axes of an array of a foil, row 0 being the top.

    Args:
        rows: Number of texels from top to bottom.
        columns: Number of texels from left to right.
    """
    return (
        Axis(name="row", symbol="1-v", unit="1", size=rows, first=0, last=1),
        Axis(name="column", symbol="u", unit="1", size=columns, first=0, last=1),
    )


def _check(field: str, values: Array, good: NDArray[np.bool_], expected: str) -> None:
    if not good.all():
        raise InputError("foil map", field, float(values[~good][0]), expected)
