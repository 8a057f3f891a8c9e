"""The tile of a repeating sample that is marked in a photograph."""

from __future__ import annotations

import numpy as np

from precompute.acquisition.capture import Corners
from precompute.acquisition.rectification import Rectification
from precompute.errors import InputError

SKEW = 3.0
"""Degrees by which a marked tile's angles and directions may be off."""

UNEVEN = 0.05
"""Share by which opposite sides of a marked tile may differ."""


def reference_tiling(
    corners_px: Corners, rectification: Rectification, name: str
) -> tuple[tuple[float, float], tuple[float, float]]:
    """The tile that is marked in a photograph.

    Args:
        corners_px: Its corners, clockwise from the top left.
        rectification: Of the photograph.
        name: What messages call the file that marks it.

    Returns:
        Width and height, and x and y of the top left corner, mm.

    Raises:
        InputError: On the sample the corners are those of no rectangle, or of one that is turned
            against the sample's edges.
    """
    corners = rectification.on_sample(np.array(corners_px, dtype=np.float64))
    edges = np.roll(corners, -1, axis=0) - corners
    lengths = np.linalg.norm(edges, axis=1)
    width, height = (lengths[:2] + lengths[2:]) / 2
    # y points up on the sample: to the right, down, to the left, up.
    expected = np.array([0, -90, 180, 90])
    turns = np.mod(np.degrees(np.arctan2(edges[:, 1], edges[:, 0])) - expected + 180, 360) - 180
    angles = turns - np.roll(turns, 1)
    uneven = np.abs(lengths[:2] - lengths[2:]) / [width, height]
    wrong = None
    if uneven.max() > UNEVEN:
        wrong = f"opposite sides that differ by {uneven.max():.0%}"
    elif np.abs(turns).max() > SKEW and np.abs(angles).max() <= SKEW:
        wrong = f"a rectangle turned by {np.abs(turns).max():.0f} degrees against the sample"
    elif max(np.abs(turns).max(), np.abs(angles).max()) > SKEW:
        wrong = f"angles that are off by {np.abs(angles).max():.0f} degrees"
    if wrong is not None:
        size = ", ".join(f"{length:.1f}" for length in lengths)
        raise InputError(
            name,
            "sample.reference_tile_px",
            f"sides of {size} mm, {wrong}",
            "the corners of a rectangle parallel to the sample's edges, clockwise from its top "
            "left",
        )
    # The mean of what all four corners say of the one.
    corner = np.mean(corners, axis=0) + np.array([-width, height]) / 2
    return (float(width), float(height)), (float(corner[0]), float(corner[1]))
