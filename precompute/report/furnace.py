"""A white furnace: what a grating returns where light comes evenly from all sides."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from precompute.renderings import Rendering
from precompute.spectra import WAVELENGTH_STEP, Metal, colour_weights, metal_reflectance

Array = NDArray[np.float64]

PROFILES = ("sinusoidal", "rectangular", "blazed", "triangular", "sampled")
LARGEST_ANGLE = 89.0
"""Degrees. Beyond, interpolated normals of a sphere's outline turn away from the viewer."""


def furnace_description(profile: str, method: dict[str, Any]) -> dict[str, Any]:
    """A sphere of a steep grating in even white light: every angle from 0° to the outline.

    Args:
        profile: Name of the profile's map.
        method: The material's options that choose how it is drawn.
    """
    return {
        "size": [160, 160],
        "camera": {"position": [0, 0, 100], "fov_deg": 1.16},
        "mesh": {"kind": "sphere", "radius": 1},
        "surface": {"kind": "grating", "period": 1.0, "height": 0.3, "profile": profile},
        "material": method,
        "environment": {"constant": [1, 1, 1]},
    }


@dataclass(frozen=True)
class Furnace:
    """Albedos over all pixels up to `LARGEST_ANGLE`.

    Attributes:
        smallest: Least luminance, over what a mirror of the same metal returns.
        largest: Most luminance, likewise.
        rms_from_one: Root mean square of albedo − 1.
        samples: Number of pixels.
        non_finite: Number of pixels with a NaN or an infinity.
        negative: Number of pixels with negative luminance.
    """

    smallest: float
    largest: float
    rms_from_one: float
    samples: int
    non_finite: int
    negative: int


def measure_furnace(rendering: Rendering) -> Furnace:
    """Albedos of a rendering of `furnace_description`."""
    position = rendering.layers["position"][rendering.covered][:, :3]
    normal = rendering.layers["normal"][rendering.covered][:, :3]
    cosine = -np.sum(normal * position, axis=1) / np.linalg.norm(position, axis=1)
    luminance = rendering.xyz()[cosine >= np.cos(np.deg2rad(LARGEST_ANGLE)), 1]
    albedo = luminance / _mirror_luminance(rendering)
    finite = np.isfinite(albedo)
    return Furnace(
        smallest=float(albedo[finite].min()),
        largest=float(albedo[finite].max()),
        rms_from_one=float(np.sqrt(np.mean((albedo[finite] - 1) ** 2))),
        samples=len(albedo),
        non_finite=int(np.count_nonzero(~finite)),
        negative=int(np.count_nonzero(albedo[finite] < 0)),
    )


def _mirror_luminance(rendering: Rendering) -> float:
    """Y of a polished surface of the same metal in white light of luminance 1."""
    metal: Metal = rendering.material.get("metal", "aluminium")
    weights = colour_weights(rendering.light.observer, rendering.light.illuminant)[:, 1]
    return float(np.sum(weights * metal_reflectance(metal)) * WAVELENGTH_STEP)
