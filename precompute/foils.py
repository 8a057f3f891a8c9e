"""Foils: maps of gratings that vary over the surface, generated from a recipe.

Orientation θ is an angle modulo π and is stored as (cos 2θ, sin 2θ), period as 1/a.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from precompute.axes import Axis
from precompute.maps import Map, Table
from precompute.recipes import PolygonsFoilRecipe

Array = NDArray[np.float64]


def polygons_foil(recipe: PolygonsFoilRecipe) -> Map:
    """Bake a tile of polygons, the cells of points scattered over a torus, so that it repeats.

    Args:
        recipe: The design.

    Returns:
        A map of kind ``foil`` with the array ``grating``, an RGBA image: cos 2θ, sin 2θ, 1/a in
        1/µm, and the share of the surface that diffracts.
    """
    rng = np.random.default_rng(recipe.seed)
    points = _spread_points(rng, recipe.polygons)
    texel = (np.arange(recipe.size) + 0.5) / recipe.size
    x, y = np.meshgrid(texel, texel[::-1])  # the first row of the image is the top, v = 1
    distances, nearest = KDTree(points, boxsize=1).query(np.stack([x, y], axis=-1), k=2)

    # Orientations and periods in a shuffled round robin: all occur equally often.
    turn = rng.permutation(recipe.polygons)
    θ = np.pi * (turn % recipe.orientations) / recipe.orientations
    frequency = 1 / np.asarray(recipe.periods)[(turn // recipe.orientations) % len(recipe.periods)]
    cell = np.asarray(nearest)[..., 0]
    seam = distances[..., 1] - distances[..., 0] < 2 * recipe.border
    values = np.stack(
        [
            np.cos(2 * θ)[cell],
            np.sin(2 * θ)[cell],
            frequency[cell],
            np.where(seam, 0.0, 1.0),
        ],
        axis=-1,
    )
    top = float(frequency.max())
    decode = ((-1.0, 2.0), (-1.0, 2.0), (0.0, top), (0.0, 1.0))
    quantised = np.round((values - np.array(decode)[:, 0]) / np.array(decode)[:, 1] * 255)
    stored = np.array(decode)[:, 0] + np.array(decode)[:, 1] * quantised / 255
    error = np.sqrt(np.mean((stored - values) ** 2) / np.mean(values**2))
    axes = (
        Axis(name="row", symbol="1-v", unit="1", size=recipe.size, first=0, last=1),
        Axis(name="column", symbol="u", unit="1", size=recipe.size, first=0, last=1),
    )
    channels = ("cos 2theta", "sin 2theta", "spatial frequency", "strength")
    return Map(
        kind="foil",
        quantity="grating at each point of a foil",
        symbol="(theta, 1/a, strength)",
        tables={"grating": Table(values, axes, channels, "uint8", decode)},
        error={"relative_rms": float(error), "against": "the design before 8-bit rounding"},
        recipe=recipe.model_dump(),
        constants={
            "height_um": recipe.height,
            "min_frequency": float(frequency.min()),
            "max_frequency": top,
            "tile_mm": (recipe.tile_mm, recipe.tile_mm),
        },
    )


def _spread_points(rng: np.random.Generator, count: int) -> Array:
    """Points on the unit torus, none very close to another: each the best of ten candidates."""
    points = rng.random((1, 2))
    while len(points) < count:
        candidates = rng.random((10, 2))
        distance, _ = KDTree(points, boxsize=1).query(candidates)
        points = np.concatenate([points, candidates[[np.argmax(distance)]]])
    return points
