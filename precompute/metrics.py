"""How far a picture is from its reference."""

from __future__ import annotations

import contextlib
import io

import colour
import flip_evaluator
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

DARK = 1e-3
"""Pixels whose reference is darker than this share of white have no colour to compare."""


def relative_rmse(found: Array, reference: Array) -> float:
    """√(Σ (found − reference)² / Σ reference²) over all pixels and channels of XYZ radiance.

    Raises:
        ValueError: The reference is zero everywhere: there is nothing to be relative to.

    >>> round(relative_rmse(np.array([1.1, 2.2]), np.array([1.0, 2.0])), 6)
    0.1
    """
    scale = float(np.sum(reference**2))
    if scale == 0:
        raise ValueError("the reference is zero everywhere")
    return float(np.sqrt(np.sum((found - reference) ** 2) / scale))


def exposure(reference_xyz: Array) -> float:
    """The factor that takes the 99th percentile of the lit pixels' luminance to 1."""
    luminance = reference_xyz[..., 1]
    return 1 / float(np.percentile(luminance[luminance > 0], 99))


def delta_e2000(found_rgb: Array, reference_rgb: Array) -> Array:
    """ΔE2000 of exposed linear sRGB pictures, clipped to what a display shows.

    Args:
        found_rgb: Shape (n, 3), white at 1.
        reference_rgb: Likewise.

    Returns:
        No unit, one number for each pixel whose reference is not dark, shape (lit,).
    """
    lit = reference_rgb @ colour.RGB_COLOURSPACES["sRGB"].matrix_RGB_to_XYZ[1] > DARK
    pictures = [np.clip(rgb[lit], 0, 1) for rgb in (found_rgb, reference_rgb)]
    lab = [
        colour.XYZ_to_Lab(colour.RGB_to_XYZ(rgb, "sRGB", apply_cctf_decoding=False))
        for rgb in pictures
    ]
    return np.asarray(colour.delta_E(lab[0], lab[1], method="CIE 2000"), dtype=np.float64)


def flip_mean(found_rgb: Array, reference_rgb: Array) -> float:
    """Mean of the FLIP difference (Andersson et al. 2020) of exposed linear pictures (h, w, 3).

    No unit, 0 to 1.
    """
    pictures = [
        colour.cctf_encoding(np.clip(rgb, 0, 1), function="sRGB").astype(np.float32)
        for rgb in (reference_rgb, found_rgb)
    ]
    with contextlib.redirect_stdout(io.StringIO()):
        _, mean, _ = flip_evaluator.evaluate(pictures[0], pictures[1], "LDR", applyMagma=False)
    return float(mean)
