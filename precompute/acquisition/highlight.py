"""The lamp's mirror image in the foil: where it is, and what it says of the lamp's place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from precompute.acquisition.rectification import Rectification
from precompute.errors import InputError

Array = NDArray[np.float64]

SEARCH = 0.12
"""(u, v) within which the highlight is looked for: some 20 mm for a lamp at 200, less than any
first order is away."""

GRID = 129
"""Points along each side of the search."""

STANDS_OUT = 8.0
"""A highlight's light within two deviations, over that of as large a disc of even light."""

CLIPPED = 0.5
"""Share of the highlight's disc that may be clipped: beyond that its middle is not known."""


@dataclass(frozen=True)
class Highlight:
    """A mirror image.

    Attributes:
        position: On the sample, mm, shape (2,).
        pixel: In the photograph, shape (2,).
        light: The lamp's position that it speaks for, at the height that is given, mm, shape (3,).
        offset_mm: How far that is from where the lamp was said to be.
    """

    position: Array
    pixel: Array
    light: Array
    offset_mm: float


def mirror_point(eye: Array, light: Array) -> Array:
    """Where the plane z = 0 shows a lamp's mirror image, mm, shape (2,)."""
    return (eye[:2] * light[2] + light[:2] * eye[2]) / (eye[2] + light[2])


def find_highlight(
    name: str,
    values: NDArray[np.float32],
    saturated: NDArray[np.bool_],
    rectification: Rectification,
    size_mm: tuple[float, float],
    light: Array,
    deviation: float,
) -> Highlight:
    """Find the mirror image of a lamp near where it should be.

    Args:
        name: The photograph's, for errors.
        values: Linear, shape (height, width, channels).
        saturated: Where it is clipped, shape (height, width).
        rectification: Of the sample's plane.
        size_mm: Of the sample.
        light: Where the lamp is said to be, mm, shape (3,).
        deviation: Standard deviation of order 0 in (u, v).

    Raises:
        InputError: The mirror image would not lie on the sample, there is none that stands out, or
            it is clipped.
    """
    eye = rectification.eye
    expected = mirror_point(eye, light)
    if np.any(np.abs(expected) > np.array(size_mm) / 2):
        found = f"the lamp's mirror image at {_mm(expected)}"
        raise InputError(name, "light.position_mm", found, "one on the sample")
    mm = 1 / (1 / light[2] + 1 / eye[2])  # per unit of u or v near the mirror image
    steps = np.linspace(-SEARCH, SEARCH, GRID) * mm
    x, y = (part.ravel() for part in np.meshgrid(steps, steps))
    points = expected + np.stack([x, y], axis=1)
    brightness, clipped = _sampled(values, saturated, rectification, points, size_mm)
    if not brightness.any():
        found = "darkness" if clipped.any() else "nothing but darkness"
        raise InputError(name, "highlight", found, f"the lamp's mirror image near {_mm(expected)}")
    position, width = points[np.argmax(_smooth(brightness, deviation))], deviation * mm
    for _ in range(10):  # mean shift: the middle of the light that a window about it lets through
        window = np.exp(-np.sum((points - position) ** 2, axis=1) / (2 * (2 * width) ** 2))
        position = (window * brightness) @ points / (window @ brightness)
    disc = np.sum((points - position) ** 2, axis=1) < (2 * width) ** 2
    if np.mean(clipped[disc]) > CLIPPED:
        found = f"clipped over {np.mean(clipped[disc]):.0%} of its disc at {_mm(position)}"
        raise InputError(name, "highlight", found, "an exposure short enough not to clip it")
    concentration = brightness[disc].sum() / brightness.sum() / np.mean(disc)
    if concentration < STANDS_OUT:
        found = f"a spot at {_mm(position)} that is {concentration:.1f} times its surroundings"
        wanted = f"the lamp's mirror image near {_mm(expected)}, {STANDS_OUT:g} times or more"
        raise InputError(name, "highlight", found, wanted)
    lamp = np.append(position - light[2] / eye[2] * (eye[:2] - position), light[2])
    return Highlight(
        position,
        rectification.pixels(position[None])[0],
        lamp,
        float(np.linalg.norm(lamp - light)),
    )


def _sampled(
    values: NDArray[np.float32],
    saturated: NDArray[np.bool_],
    rectification: Rectification,
    points: Array,
    size_mm: tuple[float, float],
) -> tuple[Array, NDArray[np.bool_]]:
    """Sum of the channels above the darkest tenth, 0 off the sample, and where it is clipped."""
    height, width = saturated.shape
    column, row = np.round(rectification.pixels(points)).astype(np.intp).T
    inside = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    inside &= np.all(np.abs(points) <= np.array(size_mm) / 2, axis=1)
    column, row = column.clip(0, width - 1), row.clip(0, height - 1)
    brightness = values[row, column].sum(axis=1).astype(np.float64)
    brightness -= np.percentile(brightness[inside], 10) if inside.any() else 0
    return np.where(inside, np.maximum(brightness, 0), 0), inside & saturated[row, column]


def _smooth(brightness: Array, deviation: float) -> Array:
    pitch = 2 * SEARCH / (GRID - 1)
    return gaussian_filter(brightness.reshape(GRID, GRID), deviation / pitch).ravel()


def _mm(point: Array) -> str:
    return f"({point[0]:.1f}, {point[1]:.1f}) mm"
