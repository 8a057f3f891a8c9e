"""The lamp's mirror image in photographs that were made by hand."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import refused

from precompute.acquisition.capture import Camera
from precompute.acquisition.evidence import PhotographError
from precompute.acquisition.highlight import (
    SEARCH_BY_COLOUR,
    Highlight,
    find_highlight,
    mirror_point,
)
from precompute.acquisition.lamp_colour import LampColour
from precompute.acquisition.observations import half_vectors
from precompute.acquisition.rectification import Rectification
from precompute.acquisition.view import View
from precompute.spectra import WAVELENGTHS

EYE = (40.0, -30.0, 400.0)
LIGHT = np.array([50.0, 20.0, 200.0])
SIZE_PX, SIZE_MM = (400, 300), (180.0, 130.0)
DEVIATION = 0.0144


def rectification() -> Rectification:
    camera = Camera(position_mm=EYE, focal_px=850, distortion=(0.05, 0, 0.002, 0, 0))
    return Rectification.of_view(View.of(camera, SIZE_PX))


def picture(light: np.ndarray, background: float = 0.02) -> np.ndarray:
    """Order 0: a Gaussian of (u, v), of three channels, on haze."""
    y, x = np.mgrid[: SIZE_PX[1], : SIZE_PX[0]]
    pixels = np.stack([x.ravel(), y.ravel()], axis=1).astype(float)
    h, irradiance = half_vectors(rectification().on_sample(pixels), np.array(EYE), light)
    spot = np.exp(-np.sum(h[:, :2] ** 2, axis=1) / (2 * DEVIATION**2))
    values = irradiance * (background + 5 * spot)
    image = values.reshape(SIZE_PX[1], SIZE_PX[0], 1) * np.array([1.0, 0.8, 0.5])
    return image.astype(np.float32)


def found(
    values: np.ndarray,
    saturated: np.ndarray | None = None,
    light: np.ndarray = LIGHT,
    colour: LampColour | None = None,
) -> Highlight:
    clipped = np.zeros(values.shape[:2], bool) if saturated is None else saturated
    return find_highlight(
        "a.tif", values, clipped, rectification(), SIZE_MM, light, DEVIATION, colour
    )


def spot(light: np.ndarray) -> np.ndarray:
    """The mirror image in the plane z = 0 is on the line from the eye to the lamp behind it."""
    behind, eye = light * [1, 1, -1], np.array(EYE)
    along = eye[2] / (eye[2] - behind[2])
    return (eye + along * (behind - eye))[:2]


def test_the_mirror_image_is_on_the_line_to_the_lamp_behind() -> None:
    assert mirror_point(np.array(EYE), LIGHT) == pytest.approx(spot(LIGHT))
    h, irradiance = half_vectors(spot(LIGHT)[None], np.array(EYE), LIGHT)
    assert h[0, :2] == pytest.approx([0, 0], abs=1e-12)
    distance = np.linalg.norm(LIGHT - [*spot(LIGHT), 0])
    assert irradiance[0] == pytest.approx(200 / distance * np.sum(LIGHT**2) / distance**2)


@pytest.mark.parametrize("off", [(0.0, 0.0), (6.0, -3.0), (-9.0, 8.0)])
def test_it_is_found_and_says_where_the_lamp_is(off: tuple[float, float]) -> None:
    """The lamp was off where it was said to be, at the height that was said."""
    light = LIGHT + np.array([*off, 0])
    highlight = found(picture(light))
    assert highlight.position == pytest.approx(spot(light), abs=0.2)
    assert highlight.light == pytest.approx(light, abs=0.3)
    assert highlight.offset_mm == pytest.approx(np.hypot(*off), abs=0.3)
    pixel = rectification().pixels(spot(light)[None])[0]
    assert highlight.pixel == pytest.approx(pixel, abs=0.4)


def test_noise_and_a_coloured_facet_do_not_move_it() -> None:
    values = picture(LIGHT)
    values += np.random.default_rng(1).normal(0, 0.02, values.shape)
    x, y = np.round(rectification().pixels(spot(LIGHT)[None] + [14.0, 0])[0]).astype(int)
    values[y - 4 : y + 4, x - 4 : x + 4, 0] += 1  # a fifth of the highlight's brightness
    assert found(values.astype(np.float32)).position == pytest.approx(spot(LIGHT), abs=0.2)


def test_a_few_clipped_pixels_do_not_matter() -> None:
    values = picture(LIGHT)
    clipped = values[..., 0] > 0.9 * values[..., 0].max()
    values = np.minimum(values, 0.9 * values.max(axis=(0, 1)))
    assert clipped.sum() > 3
    assert found(values, clipped).position == pytest.approx(spot(LIGHT), abs=0.2)


def test_a_lamp_whose_image_is_not_on_the_sample() -> None:
    far = np.array([300.0, 0.0, 200.0])
    x, y = spot(far)
    place = f"the lamp's mirror image at ({x:.1f}, {y:.1f}) mm"
    with refused("a.tif", "light.position_mm", place, "one on the sample"):
        found(picture(far), light=far)


def test_darkness() -> None:
    wanted = "the lamp's mirror image near"
    for level in (0.0, 0.3):  # black, or as bright everywhere
        even = np.full((SIZE_PX[1], SIZE_PX[0], 3), level, np.float32)
        with refused("a.tif", "highlight", "nothing but darkness", wanted):
            found(even)


def test_nothing_that_stands_out() -> None:
    noise = np.random.default_rng(2).uniform(0, 1, (SIZE_PX[1], SIZE_PX[0], 3))
    with pytest.raises(ValueError, match=r"times its surroundings.*8 times or more"):
        found(noise.astype(np.float32))


def test_a_highlight_clipped_all_over() -> None:
    values = picture(LIGHT)
    clipped = values[..., 0] > 0.1 * values[..., 0].max()  # to 2.1 deviations
    values = np.minimum(values, 0.1 * values.max(axis=(0, 1)))
    with pytest.raises(ValueError, match=r"clipped over \d+% of its disc.*short enough"):
        found(values, clipped)


# ---- By its colour -------------------------------------------------------------------------------


WEIGHTS = np.exp(-((WAVELENGTHS[:, None] - np.array([0.60, 0.54, 0.45])) ** 2) / (2 * 0.04**2))
"""An even spectrum, seen by three bell-shaped channels."""


def lamp_colour() -> LampColour:
    colour = LampColour.of(WEIGHTS, DEVIATION)
    assert colour is not None
    return colour


def coloured(light: np.ndarray) -> np.ndarray:
    """The same as `picture`, white being what an even spectrum is."""
    return (picture(light) / [1.0, 0.8, 0.5] * WEIGHTS.mean(axis=0)).astype(np.float32)


def facet(values: np.ndarray, place: np.ndarray, wavelength: float, strength: float) -> None:
    """A disc of 3 mm that shows one wavelength."""
    y, x = np.mgrid[: SIZE_PX[1], : SIZE_PX[0]]
    points = rectification().on_sample(np.stack([x.ravel(), y.ravel()], axis=1).astype(float))
    inside = np.linalg.norm(points - place, axis=1).reshape(values.shape[:2]) < 3
    line = WEIGHTS[np.argmin(np.abs(WAVELENGTHS - wavelength))]
    values[inside] += (strength * line).astype(np.float32)


@pytest.mark.parametrize("wavelength", [0.46, 0.50, 0.55, 0.62])
def test_a_brighter_facet_is_not_taken_for_it(wavelength: float) -> None:
    """As far from it as a first order, with a lamp that is between the two."""
    values, said = coloured(LIGHT), LIGHT + np.array([18.0, 0, 0])
    place = spot(LIGHT) + np.array([22.0, 4.0])
    facet(values, place, wavelength, 10 * float(values.max()))
    assert found(values, light=said).position == pytest.approx(place, abs=0.5)
    right = found(values, light=said, colour=lamp_colour()).position
    assert right == pytest.approx(spot(LIGHT), abs=0.2)


@pytest.mark.parametrize("off", [(40.0, 0.0), (-30.0, 30.0), (0.0, -58.0)])
def test_colour_finds_it_where_nobody_expects_it(off: tuple[float, float]) -> None:
    """Among facets that are nearer to where the lamp was said to be."""
    values = coloured(LIGHT)
    said = LIGHT + np.array([*off, 0])
    for wavelength, dx in ((0.47, -6.0), (0.53, 7.0)):
        facet(values, spot(said) + np.array([dx, 3.0]), wavelength, 10 * float(values.max()))
    highlight = found(values, light=said, colour=lamp_colour())
    assert highlight.light == pytest.approx(LIGHT, abs=0.3)
    assert highlight.offset_mm == pytest.approx(np.hypot(*off), abs=0.3)


def test_one_at_the_border_of_the_search_is_found_whole() -> None:
    """Its middle is beyond where it is looked for by its own deviation."""
    mm = 1 / (1 / LIGHT[2] + 1 / EYE[2])
    moved = (SEARCH_BY_COLOUR + DEVIATION) * mm * (LIGHT[2] + EYE[2]) / EYE[2]
    said = LIGHT + np.array([-moved, 0, 0])
    highlight = found(coloured(LIGHT), light=said, colour=lamp_colour())
    assert highlight.position == pytest.approx(spot(LIGHT), abs=0.2)


def test_facets_alone() -> None:
    values = 0.001 * coloured(LIGHT)
    place = spot(LIGHT) + np.array([8.0, -4.0])
    facet(values, place, 0.5, 5)
    wanted = "the lamp's mirror image near"
    with pytest.raises(ValueError, match=rf"of another colour than the lamp's.*{wanted}"):
        found(values, colour=lamp_colour())


def test_a_clipped_highlight_beside_a_facet_that_is_not() -> None:
    """By what is left of its colour about what is clipped."""
    values = coloured(LIGHT)
    clipped = np.any(values > 0.1 * values.max(axis=(0, 1)), axis=2)
    values = np.minimum(values, 0.1 * values.max(axis=(0, 1)))
    facet(values, spot(LIGHT) + np.array([15.0, 0]), 0.5, 0.05)
    with pytest.raises(ValueError, match=r"clipped over \d+% of its disc.*short enough"):
        found(values, clipped, colour=lamp_colour())


def test_what_is_clipped_has_no_colour() -> None:
    """Two channels are, so that the spot is blue but for its rim."""
    values = coloured(LIGHT)
    limit = 0.05 * values.max(axis=(0, 1)) * [1, 1, 100]
    clipped = np.any(values > limit, axis=2)
    with pytest.raises(ValueError, match=r"clipped over \d+% of its disc.*short enough"):
        found(np.minimum(values, limit).astype(np.float32), clipped, colour=lamp_colour())


def test_the_picture_shows_what_was_looked_for_and_what_was_found() -> None:
    values = 0.001 * coloured(LIGHT)
    place = spot(LIGHT) + np.array([8.0, -4.0])
    facet(values, place, 0.5, 5)
    with pytest.raises(PhotographError) as caught:
        found(values, colour=lamp_colour())
    marks = caught.value.evidence.marks
    (looked_for,) = (mark.pixels for mark in marks if len(mark.pixels) == 1)
    assert looked_for == pytest.approx(rectification().pixels(spot(LIGHT)[None]))
    (circle,) = (mark.pixels for mark in marks if mark.is_found)
    assert circle.mean(axis=0) == pytest.approx(rectification().pixels(place[None])[0], abs=1.5)
    corners = rectification().pixels(np.array([(-90.0, 65), (90, 65), (90, -65), (-90, -65)]))
    sample = marks[0].pixels
    assert sample[::20] == pytest.approx(corners)


def test_a_mirror_image_off_the_sample_comes_with_the_brightest_spot() -> None:
    far, values = np.array([300.0, 0.0, 200.0]), coloured(LIGHT)
    facet(values, spot(LIGHT) - np.array([40.0, 0]), 0.53, 10 * float(values.max()))
    with pytest.raises(PhotographError) as caught:
        found(values, light=far, colour=lamp_colour())
    (circle,) = (mark.pixels for mark in caught.value.evidence.marks if mark.is_found)
    pixel = rectification().pixels(spot(LIGHT)[None])[0]
    assert circle.mean(axis=0) == pytest.approx(pixel, abs=1)
