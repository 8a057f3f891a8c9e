"""What an error saw: a photograph, what was looked for in it and what was found."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from precompute.acquisition.rectification import Rectification, corners_mm
from precompute.errors import InputError

Array = NDArray[np.float64]

LARGEST = 1000
"""Longest side of a photograph that is drawn, px."""


@dataclass(frozen=True)
class Mark:
    """Something drawn in a photograph.

    Attributes:
        label: What it is.
        pixels: Where: one point, or those of a closed line, shape (n, 2).
        is_found: Whether it was found there; else it was looked for.
    """

    label: str
    pixels: Array
    is_found: bool


@dataclass(frozen=True)
class Evidence:
    """What an error saw.

    Attributes:
        name: What the picture is named after: a photograph, or what was looked for in several.
        shown: The photograph as a display shows it, no larger than it will be drawn, shape
            (height, width, 3), from 0 to 1.
        size: Width and height of the photograph, px, which marks are counted in.
        marks: What is drawn.
    """

    name: str
    shown: Array
    size: tuple[int, int]
    marks: tuple[Mark, ...]

    @staticmethod
    def of(name: str, values: NDArray[np.float32], *marks: Mark) -> Evidence:
        """What is to be drawn of a photograph; the photograph itself is not kept.

        Args:
            name: See `Evidence.name`.
            values: Linear, shape (height, width, channels).
            marks: What is drawn.
        """
        height, width, channels = values.shape
        factor = min(1.0, LARGEST / max(height, width))
        size = (max(1, round(width * factor)), max(1, round(height * factor)))
        small = cv2.resize(values, size, interpolation=cv2.INTER_AREA)
        small = small.reshape(size[1], size[0], channels).astype(np.float64)
        return Evidence(name, shown(small, float(np.percentile(small, 99))), (width, height), marks)


class PhotographError(InputError):
    """A photograph that cannot be used, and what to show of it.

    Args:
        error: What is wrong.
        evidence: What was looked for and found.
    """

    def __init__(self, error: InputError, evidence: Evidence) -> None:
        super().__init__(error.file, error.field, error.value, error.expected)
        self.evidence = evidence


def outline(rectification: Rectification, size_mm: tuple[float, float]) -> Mark:
    """The sample as it is taken to lie, its sides as the lens bends them."""
    corners = corners_mm(size_mm)
    along = np.linspace(0, 1, 20, endpoint=False)[:, None]
    sides = [a + along * (b - a) for a, b in zip(corners, np.roll(corners, -1, 0), strict=True)]
    return Mark("the sample", rectification.pixels(np.concatenate(sides)), False)


def shown(linear: Array, white: float) -> Array:
    """What a display shows, shares of white: a power of 1/2.2, grey as three channels.

    Args:
        linear: Linear light, shape (height, width, 1 or 3).
        white: The number that is shown white.
    """
    tone = np.clip(linear / max(white, 1e-30), 0, 1) ** (1 / 2.2)
    return np.broadcast_to(tone, (*tone.shape[:2], 3)) if tone.shape[2] == 1 else tone
