"""The lamp's mirror image in the foil: where it is, and what it says of the lamp's place."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter, maximum_filter

from precompute.acquisition.evidence import Evidence, Mark, PhotographError, outline
from precompute.acquisition.lamp_colour import LampColour
from precompute.acquisition.rectification import Rectification
from precompute.errors import InputError

Array = NDArray[np.float64]

SEARCH = 0.12
"""(u, v) within which the highlight is looked for: some 20 mm for a lamp at 200, less than any
first order is away."""

SEARCH_BY_COLOUR = 0.3
"""The same where colour tells it from first orders: some 60 mm for a lamp at 200."""

PITCH = SEARCH / 64
"""Between points of the search."""

SPOTS = 16
"""Bright spots that are looked at, the brightest."""

STANDS_OUT = 8.0
"""A highlight's light within two deviations, over that of as large a disc of even light."""

CLIPPED = 0.5
"""Share of the highlight's disc that may be clipped: beyond that its middle is not known."""

RIM = 3.0
"""Deviations within which a spot's colour is looked at."""


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


@dataclass(frozen=True)
class Spot:
    """A bright spot.

    Attributes:
        position: Its middle on the sample, mm, shape (2,).
        clipped: Share of its disc that is.
        concentration: The ratio of its disc's light to that of its surroundings, see `STANDS_OUT`.
        is_lamps: Whether it has a colour that the lamp's mirror image may have.
    """

    position: Array
    clipped: float
    concentration: float
    is_lamps: bool


def mirror_point(eye: Array, light: Array) -> Array:
    """Where the plane z = 0 shows a lamp's mirror image, mm, shape (2,).

    Args:
        eye: The camera's centre of projection, mm, shape (3,).
        light: The lamp, mm, shape (3,).
    """
    return (eye[:2] * light[2] + light[:2] * eye[2]) / (eye[2] + light[2])


def find_highlight(
    name: str,
    values: NDArray[np.float32],
    saturated: NDArray[np.bool_],
    rectification: Rectification,
    size_mm: tuple[float, float],
    light: Array,
    deviation: float,
    colour: LampColour | None,
) -> Highlight:
    """Find the mirror image of a lamp near where it should be.

    Of the bright spots it is the brightest that stands out and has the lamp's colour; without
    knowing that, only the brightest is looked at, and less far away.

    Args:
        name: The photograph's, for errors.
        values: Linear, shape (height, width, channels).
        saturated: Where it is clipped, shape (height, width).
        rectification: Of the sample's plane.
        size_mm: Of the sample.
        light: Where the lamp is said to be, mm, shape (3,).
        deviation: Standard deviation of order 0 in (u, v).
        colour: What tells it from first orders; None where nothing does.

    Raises:
        PhotographError: The mirror image would not lie on the sample, there is none that stands
            out, it is clipped, or what is bright has other colours than the lamp.
    """
    eye = rectification.eye
    expected = mirror_point(eye, light)
    mm = 1 / (1 / light[2] + 1 / eye[2])  # per unit of u or v near the mirror image
    search, width = SEARCH if colour is None else SEARCH_BY_COLOUR, deviation * mm

    def refusal(field: str, found: str, wanted: str, *spots: Spot) -> PhotographError:
        square = expected + search * mm * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
        turn = np.linspace(0, 2 * np.pi, 40, endpoint=False)[:, None]
        circle = 2 * width * np.concatenate([np.cos(turn), np.sin(turn)], axis=1)
        marks = [
            outline(rectification, size_mm),
            Mark("the lamp's mirror image", rectification.pixels(expected[None]), False),
            Mark(
                "the same, if the lamp is a little elsewhere", rectification.pixels(square), False
            ),
            *(
                Mark(
                    f"a bright spot at {_mm(s.position)}",
                    rectification.pixels(s.position + circle),
                    True,
                )
                for s in spots
            ),
        ]
        return PhotographError(
            InputError(name, field, found, wanted), Evidence.of(name, values, *marks)
        )

    black = np.zeros(values.shape[2])
    sampler = _Sampler(values, saturated, rectification, size_mm, black)
    if np.any(np.abs(expected) > np.array(size_mm) / 2):
        grid = _grid(max(size_mm) / 2 / mm) * mm
        brightness = sampler.at(grid)[0].sum(axis=1)
        spots = [
            _spot(grid[place], sampler, width, mm, colour)
            for place in _brightest(brightness, deviation, SPOTS)
        ]
        spots.sort(key=lambda spot: not spot.is_lamps)
        found = f"the lamp's mirror image at {_mm(expected)}"
        raise refusal("light.position_mm", found, "one on the sample", *spots[:1])
    grid = _grid(search) * mm
    sampler = sampler.above_darkest_tenth(expected + grid)
    seen, _, clipped = sampler.at(expected + grid)
    brightness = np.maximum(seen.sum(axis=1), 0)
    near = f"the lamp's mirror image near {_mm(expected)}"
    if not brightness.any():
        found = "darkness" if clipped.any() else "nothing but darkness"
        raise refusal("highlight", found, near)
    spots: list[Spot] = []
    for place in _brightest(brightness, deviation, 1 if colour is None else SPOTS):
        spots.append(_spot(expected + grid[place], sampler, width, mm, colour))
        spot = spots[-1]
        if spot.is_lamps and (spot.clipped > CLIPPED or spot.concentration >= STANDS_OUT):
            break
    else:
        spot = spots[0]
    at = _mm(spot.position)
    if not spot.is_lamps:
        found = f"a spot at {at} of another colour than the lamp's"
        raise refusal("highlight", found, near, spot)
    if spot.clipped > CLIPPED:
        found = f"clipped over {spot.clipped:.0%} of its disc at {at}"
        raise refusal("highlight", found, "an exposure short enough not to clip it", spot)
    if spot.concentration < STANDS_OUT:
        found = f"a spot at {at} that is {spot.concentration:.1f} times its surroundings"
        raise refusal("highlight", found, f"{near}, {STANDS_OUT:g} times or more", spot)
    lamp = np.append(spot.position - light[2] / eye[2] * (eye[:2] - spot.position), light[2])
    pixel = rectification.pixels(spot.position[None])[0]
    return Highlight(spot.position, pixel, lamp, float(np.linalg.norm(lamp - light)))


@dataclass(frozen=True)
class _Sampler:
    """A photograph's light at points of the sample.

    Attributes:
        values: Linear, shape (height, width, channels).
        saturated: Where it is clipped, shape (height, width).
        rectification: Of the sample's plane.
        size_mm: Of the sample.
        floor: What counts as no light, shape (channels,).
    """

    values: NDArray[np.float32]
    saturated: NDArray[np.bool_]
    rectification: Rectification
    size_mm: tuple[float, float]
    floor: Array

    def above_darkest_tenth(self, points: Array) -> _Sampler:
        """The same, no light being what points show a tenth of which show less."""
        light, inside, _ = self.at(points)
        light = light[inside]
        tenth = len(light) // 10
        about = np.argsort(light.sum(axis=1))[tenth // 2 : tenth + tenth // 2 + 1]
        return replace(self, floor=light[about].mean(axis=0)) if inside.any() else self

    def at(self, points: Array) -> tuple[Array, NDArray[np.bool_], NDArray[np.bool_]]:
        """Light at points, mm, shape (n, 2).

        Returns:
            Channels, 0 off the sample, shape (n, channels); which points are on it; which of them
            are clipped.
        """
        height, width = self.saturated.shape
        column, row = np.round(self.rectification.pixels(points)).astype(np.intp).T
        inside = (column >= 0) & (column < width) & (row >= 0) & (row < height)
        inside &= np.all(np.abs(points) <= np.array(self.size_mm) / 2, axis=1)
        column, row = column.clip(0, width - 1), row.clip(0, height - 1)
        light = np.where(inside[:, None], self.values[row, column] - self.floor, 0)
        return light, inside, inside & self.saturated[row, column]


def _spot(
    position: Array, sampler: _Sampler, width: float, mm: float, colour: LampColour | None
) -> Spot:
    """The spot near a position: its standard deviation is `width`, in mm."""
    points = position + _grid(SEARCH) * mm
    seen, _, clipped = sampler.at(points)
    brightness = np.maximum(seen.sum(axis=1), 0)
    for _ in range(10):  # mean shift: the middle of the light that a window about it lets through
        window = np.exp(-np.sum((points - position) ** 2, axis=1) / (2 * (2 * width) ** 2))
        position = (window * brightness) @ points / (window @ brightness)
    squared = np.sum((points - position) ** 2, axis=1)
    disc = squared < (2 * width) ** 2
    concentration = brightness[disc].mean() / brightness.mean()
    is_lamps = True
    if colour is not None:
        # What is clipped has lost some of its colour.
        is_lamps = colour.shows(seen[(squared < (RIM * width) ** 2) & ~clipped].sum(axis=0))
    return Spot(position, float(np.mean(clipped[disc])), float(concentration), is_lamps)


def _brightest(brightness: Array, deviation: float, count: int) -> NDArray[np.intp]:
    """Which points are the brightest about them, the brightest first."""
    side = round(np.sqrt(len(brightness)))
    smooth = gaussian_filter(brightness.reshape(side, side), deviation / PITCH)
    about = maximum_filter(smooth, 2 * round(2 * deviation / PITCH) + 1)
    peaks = np.flatnonzero((smooth == about) & (smooth > 0))
    return peaks[np.argsort(-smooth.flat[peaks])][:count]


def _grid(reach: float) -> Array:
    """Points of a square about the origin, row by row, shape (n², 2), the middle one 0."""
    half = round(reach / PITCH)
    steps = np.arange(-half, half + 1) * PITCH
    x, y = np.meshgrid(steps, steps)
    return np.stack([x.ravel(), y.ravel()], axis=1).astype(np.float64)


def _mm(point: Array) -> str:
    return f"({point[0]:.1f}, {point[1]:.1f}) mm"
