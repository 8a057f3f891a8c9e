"""From a capture file to photographs of which is known where everything was."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from precompute.acquisition.capture import Capture, Corners
from precompute.acquisition.corners import find_corners
from precompute.acquisition.evidence import Evidence, Mark, PhotographError, outline
from precompute.acquisition.highlight import Highlight, find_highlight
from precompute.acquisition.lamp_colour import LampColour
from precompute.acquisition.lobes import lobe_deviation
from precompute.acquisition.observations import Shot
from precompute.acquisition.photographs import Photo, read_photographs
from precompute.acquisition.rectification import Rectification
from precompute.acquisition.sensor import channel_weights, sensitivity
from precompute.acquisition.view import View
from precompute.errors import InputError

ROUGHNESS = float(np.radians(0.2))
"""Of the foil's normal, rad, until it is known."""


FAR_MM = 5.0
"""Between where the lamp is and where it was said to be: more than a ruler's error."""


@dataclass(frozen=True)
class Taken:
    """What was made of a capture's photographs.

    Attributes:
        shots: Those that can be used.
        highlights: Of each.
        left_out: Why others cannot, by name.
        rectifications: Of all the capture's photographs, in its order.
    """

    shots: list[Shot]
    highlights: list[Highlight]
    left_out: dict[str, InputError]
    rectifications: list[Rectification]


def read_shots(
    capture: Capture,
    folder: Path,
    say: Callable[[str], None],
    draw: Callable[[InputError], InputError] = lambda error: error,
) -> Taken:
    """Read a capture's photographs, find the sample and the highlight in each.

    A photograph whose highlight cannot be found is left out; the others go on.

    Args:
        capture: What the capture file says.
        folder: That of the file.
        say: Takes remarks on what was left out, or was not given and had to be found or assumed.
        draw: Takes the errors that are remarked on, and returns them with the names of pictures.

    Raises:
        InputError: A photograph cannot be read, the sample is not found in it, or none has a
            highlight: the first one's error then.
    """
    response = sensitivity(capture.camera, folder)
    if capture.camera.spectral_response_csv is None:
        say("camera.spectral_response_csv is not given: a typical sensor's is taken")
    taken = Taken([], [], {}, [])
    photos = list(read_photographs(capture, folder))
    found = _found_corners(capture, photos, say, draw)
    for photograph, photo in zip(capture.photographs, photos, strict=True):
        rectification = _rectification(capture, photo, photograph.corners_px or found)
        taken.rectifications.append(rectification)
        if not rectification.is_scaled and not taken.shots:
            say("camera.position_mm and camera.focal_px are not given: periods are relative")
        light = photograph.light
        assert light is not None  # a flash capture
        radius = float(np.radians(light.radius_deg))
        deviation = lobe_deviation(radius, ROUGHNESS)
        weights = channel_weights(light, photograph.filter, response, folder)
        # A typical sensor's colours are not this one's.
        is_measured = capture.camera.spectral_response_csv is not None
        try:
            highlight = find_highlight(
                photo.name,
                photo.values,
                photo.saturated,
                rectification,
                capture.sample.size_mm,
                np.array(light.position_mm),
                deviation,
                LampColour.of(weights, deviation) if is_measured else None,
            )
        except InputError as error:
            taken.left_out[photo.name] = draw(error)
            continue
        if highlight.offset_mm > FAR_MM:
            say(
                f"{photo.name}: by its mirror image the lamp is {highlight.offset_mm:.1f} mm from "
                "light.position_mm, or something else was taken for it"
            )
        shot = Shot(
            photo.name,
            photo.values,
            ~photo.saturated,
            rectification,
            highlight.light,
            radius,
            weights,
            np.zeros(photo.values.shape[2], np.float32),
        )
        taken.shots.append(shot)
        taken.highlights.append(highlight)
    errors = [*taken.left_out.values()]
    for error in errors if taken.shots else errors[1:]:
        say(f"left out: {error}")
    if not taken.shots:
        raise errors[0]
    return taken


def about_all(error: InputError, taken: Taken, size_mm: tuple[float, float]) -> PhotographError:
    """An error about all photographs, with what the first shows: the sample and the highlight."""
    shot, highlight = taken.shots[0], taken.highlights[0]
    sample = replace(outline(shot.rectification, size_mm), label="the sample, lit like a foil")
    spot = Mark("the lamp's mirror image", highlight.pixel[None], True)
    return PhotographError(error, Evidence.of(shot.name, shot.values, sample, spot))


def _found_corners(
    capture: Capture,
    photos: list[Photo],
    say: Callable[[str], None],
    draw: Callable[[InputError], InputError],
) -> Corners | None:
    """The sample's corners where photographs do not have them; None where the camera says it all.

    The camera does not move: what is found in some photographs holds for all that have none.
    """
    without = [
        photo
        for photograph, photo in zip(capture.photographs, photos, strict=True)
        if photograph.corners_px is None
    ]
    if not without:
        return None
    names = ", ".join(photo.name for photo in without)
    try:
        corners = find_corners([photo.values for photo in without], names)
    except InputError as error:
        if capture.camera.position_mm is None or capture.camera.focal_px is None:
            raise
        say(f"the camera's position and focal length are taken instead of corners: {draw(error)}")
        return None
    shown = ", ".join(f"({x:.1f}, {y:.1f})" for x, y in corners)
    say(f"photographs.corners_px found: {shown}")
    return corners


def _rectification(capture: Capture, photo: Photo, corners: Corners | None) -> Rectification:
    height, width = photo.values.shape[:2]
    camera, size = capture.camera, (width, height)
    if corners is None:
        return Rectification.of_view(View.of(camera, size))
    return Rectification.of(camera, photo.focal_px, size, capture.sample.size_mm, corners)
