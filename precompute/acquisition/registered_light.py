"""Photographs through a turning polariser, laid on one another on the plane of the sample."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryFile

import cv2
import numpy as np
from numpy.typing import NDArray

from precompute.acquisition.capture import Capture
from precompute.acquisition.corners import find_corners
from precompute.acquisition.evidence import Evidence, Mark, PhotographError, outline
from precompute.acquisition.photographs import Photo, read_photographs
from precompute.acquisition.rectification import Rectification, corners_mm
from precompute.acquisition.registration import Move, Outlines
from precompute.acquisition.view import View
from precompute.errors import InputError
from precompute.progress import tracked

Array = NDArray[np.float64]
Picture = NDArray[np.float32]

LIKE = 0.3
"""Likeness from which a photograph shows what the first one does: of the same foil it is 0.5 to 1,
of another in the same place 0.2 or less."""

FLAT = 0.005
"""Contrast of a photograph, over its median, below which nothing can be told by it."""

COARSE = 64
"""Longest side, px, of the picture whose contrast is judged: noise has none there."""

CLIPPED = 0.1
"""Share of the sample that may be clipped in a photograph."""

POINTS = 256
"""Along each side of the sample, at which clipping is looked for."""

LARGEST = 4096
"""Texels along a side of a map whose size is not asked for: what graphics cards take."""

BLOCK = 2**20
"""Points that are looked up at once."""


@dataclass(frozen=True)
class RegisteredLight:
    """Photographs of a capture on a map's texels.

    Attributes:
        names: Of the photographs.
        polariser: ψ of each, rad.
        moves: How each lies on the first, their quality being `Outlines.likeness` within the
            sample.
        rectification: Of the first.
        light: The mean of a pixel's channels, shape (photographs, rows, columns), mapped from a
            file that is gone when this is; NaN where a photograph is clipped or ends.
        clipped: Share of the sample that is clipped, of each.
    """

    names: tuple[str, ...]
    polariser: Array
    moves: tuple[Move, ...]
    rectification: Rectification
    light: Picture
    clipped: tuple[float, ...]


def registered_light(
    capture: Capture, folder: Path, size: tuple[int, int] | None, say: Callable[[str], None]
) -> RegisteredLight:
    """Read a capture's photographs one after the other, and lay each on the first.

    Args:
        capture: What the capture file says.
        folder: That of the file.
        size: Columns and rows; the photographs' resolution if None. A texel that is larger than a
            pixel has the mean of several.
        say: Takes remarks on what was not given and had to be found.

    Raises:
        InputError: A photograph cannot be read; the sample is not found in the first; a photograph
            is flat, clipped in a tenth of the sample or more, or does not lie on the first.
    """
    reference: Outlines | None = None
    rectification: Rectification | None = None
    light: Picture | None = None
    names, moves, clipped = [], [], []
    photos = tracked(read_photographs(capture, folder), "registering", len(capture.photographs))
    for index, photo in enumerate(photos):
        grey = photo.values.mean(axis=2)
        _check_contrast(folder, photo, grey)
        outlines = Outlines(grey)
        if reference is None or rectification is None or light is None:
            reference, move = outlines, Move(np.zeros(2), 0.0, 1.0)
            rectification = _rectification(capture, photo, say)
            size = size or _resolution(rectification, capture.sample.size_mm)
            shape = (len(capture.photographs), size[1], size[0])
            with TemporaryFile() as file:  # the map outlives the name
                light = np.memmap(file, np.float32, "w+", shape=shape)
        else:
            move = reference.move_of(outlines)
            corners = rectification.pixels(corners_mm(capture.sample.size_mm))
            move = replace(move, quality=reference.likeness(outlines, move, corners))
            _check_move(folder, photo, move, names[0])
        places = _Places(rectification, move, photo.size, capture.sample.size_mm)
        clipped.append(_clipped(folder, photo, places, rectification, capture.sample.size_mm))
        grey[photo.saturated] = np.nan
        places.look_up(grey, light[index])
        names.append(photo.name)
        moves.append(move)
    assert rectification is not None and light is not None  # a capture has photographs
    ψ = np.radians([photograph.polariser_deg or 0.0 for photograph in capture.photographs])
    return RegisteredLight(tuple(names), ψ, tuple(moves), rectification, light, tuple(clipped))


class _Places:
    """Where a photograph shows points of the sample.

    Args:
        rectification: Of the first photograph.
        move: How this one lies on it.
        size_px: Width and height of both.
        size_mm: Of the sample.
    """

    def __init__(
        self,
        rectification: Rectification,
        move: Move,
        size_px: tuple[int, int],
        size_mm: tuple[float, float],
    ) -> None:
        self.rectification = rectification
        self.move = move
        self.size_px = size_px
        self.size_mm = np.array(size_mm)

    def of(self, rows: Array, columns: Array) -> tuple[Picture, Picture]:
        """x and y in px of a grid, whose rows and columns run from 0 to 1 from the top left."""
        u, v = np.meshgrid(columns, rows)
        xy = (np.stack([u.ravel(), 1 - v.ravel()], axis=1) - 0.5) * self.size_mm
        pixels = self.move.moved(self.rectification.pixels(xy), self.size_px).astype(np.float32)
        x, y = (np.ascontiguousarray(part).reshape(u.shape) for part in pixels.T)
        return x, y

    def look_up(self, grey: Picture, out: Picture) -> None:
        """Fill a map's texels, cubic between pixels, as the mean over each."""
        rows, columns = out.shape
        per_texel = self.rectification.pixels_per_mm() * self.size_mm / (columns, rows)
        fine = max(1, int(np.ceil(per_texel.max() - 0.25)))
        step = max(1, BLOCK // (columns * fine**2))
        across = (np.arange(columns * fine) + 0.5) / (columns * fine)
        for start in range(0, rows, step):
            stop = min(start + step, rows)
            along = (np.arange(start * fine, stop * fine) + 0.5) / (rows * fine)
            x, y = self.of(along, across)
            seen = cv2.remap(
                grey, x, y, cv2.INTER_CUBIC, borderMode=cv2.BORDER_CONSTANT, borderValue=np.nan
            )
            out[start:stop] = seen.reshape(stop - start, fine, columns, fine).mean(axis=(1, 3))


def _check_contrast(folder: Path, photo: Photo, grey: Picture) -> None:
    factor = max(1, max(grey.shape) // COARSE)
    height, width = (side // factor for side in grey.shape)
    whole = grey[: height * factor, : width * factor]
    small = cv2.resize(whole, (width, height), interpolation=cv2.INTER_AREA)
    low, middle, high = np.percentile(small, [1, 50, 99])
    if high - low < FLAT * abs(middle):
        error = InputError(folder / photo.name, "numbers", "flat", "some contrast")
        raise PhotographError(error, Evidence.of(photo.name, photo.values))


def _check_move(folder: Path, photo: Photo, move: Move, first: str) -> None:
    if move.quality >= LIKE:
        return
    x, y = move.shift
    found = f"shift ({x:.1f}, {y:.1f}) px, quality {move.quality:.2f}"
    error = InputError(
        folder / photo.name,
        "registration",
        found,
        f"a photograph that lies on {first} with a quality of {LIKE:g} or more",
    )
    width, height = photo.size
    frame = np.array([(0, 0), (width, 0), (width, height), (0, height)]) - 0.5
    there = Mark(f"{first}'s frame", move.moved(frame, photo.size), True)
    raise PhotographError(error, Evidence.of(photo.name, photo.values, there))


def _clipped(
    folder: Path,
    photo: Photo,
    places: _Places,
    rectification: Rectification,
    size_mm: tuple[float, float],
) -> float:
    """The share of the sample that is clipped.

    Raises:
        InputError: It is too much.
    """
    across = (np.arange(POINTS) + 0.5) / POINTS
    x, y = places.of(across, across)
    share = float(cv2.remap(photo.saturated.astype(np.uint8), x, y, cv2.INTER_NEAREST).mean())
    if share > CLIPPED:
        error = InputError(
            folder / photo.name,
            "numbers",
            f"{share:.0%} of the sample clipped",
            f"{CLIPPED:.0%} at most: a shorter exposure, or brackets",
        )
        raise PhotographError(
            error, Evidence.of(photo.name, photo.values, outline(rectification, size_mm))
        )
    return share


def _rectification(capture: Capture, photo: Photo, say: Callable[[str], None]) -> Rectification:
    camera, corners = capture.camera, capture.photographs[0].corners_px
    if corners is None and camera.position_mm is not None and camera.focal_px is not None:
        say("the camera's position and focal length are taken instead of photographs.0.corners_px")
        return Rectification.of_view(View.of(camera, photo.size))
    if corners is None:
        corners = find_corners([photo.values], photo.name)
        shown = ", ".join(f"({x:.1f}, {y:.1f})" for x, y in corners)
        say(f"photographs.0.corners_px found: {shown}")
    return Rectification.of(camera, photo.focal_px, photo.size, capture.sample.size_mm, corners)


def _resolution(rectification: Rectification, size_mm: tuple[float, float]) -> tuple[int, int]:
    pixels = np.array(size_mm) * rectification.pixels_per_mm()
    pixels *= min(1.0, LARGEST / pixels.max())
    columns, rows = np.maximum(np.round(pixels), 8).astype(int)
    return int(columns), int(rows)
