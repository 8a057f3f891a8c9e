"""How far one rendering is from the reference."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from precompute.errors import InputError
from precompute.metrics import delta_e2000, exposure, flip_mean, relative_rmse
from precompute.renderings import Rendering
from precompute.spectra import xyz_to_linear_srgb

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Comparison:
    """A rendering against the reference of the same pixels.

    Attributes:
        rel_rmse: Relative root mean square error of linear XYZ radiance.
        delta_e2000_median: Median ΔE2000 of lit pixels, exposed.
        delta_e2000_p95: Its 95th percentile.
        flip_mean: Mean FLIP difference of the exposed pictures.
        covered: Number of pixels compared.
        lit: Number of pixels that have a colour to compare.
        pictures: Reference and result as exposed linear sRGB, shape (2, height, width, 3).
    """

    rel_rmse: float
    delta_e2000_median: float
    delta_e2000_p95: float
    flip_mean: float
    covered: int
    lit: int
    pictures: Array


def compare(rendering: Rendering, reference: Array) -> Comparison:
    """Compare a rendering with the reference of all the pixels it covers.

    Args:
        rendering: What the browser drew.
        reference: XYZ radiance, shape (covered, 3).

    Raises:
        InputError: The rendering holds a number that is not finite, or the reference is zero
            everywhere: there is nothing to be relative to.
    """
    found = rendering.xyz()
    bad = int(np.count_nonzero(~np.isfinite(found).all(axis=1)))
    if bad:
        raise InputError("rendering", "radiance", f"{bad} pixels", "finite numbers only")
    if not reference.any():
        raise InputError("rendering", "reference", 0.0, "light somewhere in the picture")
    light = rendering.light
    to_rgb = xyz_to_linear_srgb(light.observer, light.illuminant).T
    scale = exposure(reference)
    exposed = [scale * xyz @ to_rgb for xyz in (reference, found)]
    difference = delta_e2000(exposed[1], exposed[0])
    pictures = np.zeros((2, *rendering.covered.shape, 3))
    for picture, colours in zip(pictures, exposed, strict=True):
        picture[rendering.covered] = colours
    return Comparison(
        rel_rmse=float(relative_rmse(found, reference)),
        delta_e2000_median=float(np.median(difference)),
        delta_e2000_p95=float(np.percentile(difference, 95)),
        flip_mean=flip_mean(pictures[1], pictures[0]),
        covered=len(reference),
        lit=len(difference),
        pictures=pictures,
    )
