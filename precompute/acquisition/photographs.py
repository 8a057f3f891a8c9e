"""Photographs of a capture: exposures of one picture, merged into its radiance.

After Debevec and Malik 1997, for sensors whose numbers grow with light as the camera says.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import reduce
from operator import attrgetter
from pathlib import Path
from typing import Literal

import numpy as np
from colour.models import eotf_inverse_sRGB
from numpy.typing import NDArray

from precompute.acquisition.capture import Bracket, Camera, Capture, Photograph
from precompute.acquisition.evidence import Evidence, Mark, PhotographError
from precompute.acquisition.image_files import ImageFile, read_image, write_image
from precompute.errors import InputError
from precompute.progress import tracked

# Of full scale: from here on a sample counts as clipped. Sensors clip unevenly over the last per
# cent or two, and pixels interpolated beside clipped ones are low.
CLIPPED = 0.98
# Of full scale: up to here a sample has its whole weight. Noise decides on which side of an edge a
# sample falls, so that a sharp edge would favour low ones, by 0.4 of their noise; a slope from here
# on favours them half as much or less.
TRUSTED = 0.8
# Exposures may be told in steps of a third of a stop (1.26); half a stop and more is a mistake.
LARGEST_EXPOSURE_ERROR = 1.5
# Samples that two exposures must both show well before they are compared.
FEWEST_COMPARED = 100
# Samples that are worked on at once; they fit into a processor's cache.
BLOCK = 2**18
# Side in pixels of the squares in which noise is measured, the share of them that counts as dark,
# and the distance of the pixels compared: demosaicing makes nearer ones alike.
SQUARE, DARK, LAG = 16, 0.05, 4


@dataclass(frozen=True)
class Source:
    """One file of a photograph.

    Attributes:
        file: Its name in the capture.
        kind: Format and type.
        exposure_s: As it was used.
        exposure_from: Who said so; where nobody did, it is 1 s.
        noted_exposure_s: As the file itself notes it.
        noted_focal_px: Focal length that follows from what the file notes.
        agreement: Its light over what the shorter exposures foretell of it; 1 where exposures,
            levels and response are right. None for the shortest, and where both show too little.
    """

    file: str
    kind: str
    exposure_s: float
    exposure_from: Literal["capture", "file", "nobody"]
    noted_exposure_s: float | None
    noted_focal_px: float | None
    agreement: float | None


@dataclass(frozen=True)
class Photo:
    """A photograph, merged.

    Attributes:
        values: Radiance in full scales per second, shape (height, width, channels), float32. Noise
            may put it below 0.
        saturated: Where the shortest exposure is clipped in any channel, shape (height, width).
            There `values` are no more than a lower bound.
        noise: Standard deviation of `values` in the dark, see `dark_noise`; at least what rounding
            to whole numbers brings.
        exposure_s: The shortest exposure: it clips at `values` of 1 / exposure_s.
        focal_px: Focal length by the capture, else by the first file that notes it, else None.
        focal_from: Who said so.
        sources: Its files, the shortest exposure first.
    """

    values: NDArray[np.float32]
    saturated: NDArray[np.bool_]
    noise: float
    exposure_s: float
    focal_px: float | None
    focal_from: Literal["capture", "file", "nobody"]
    sources: tuple[Source, ...]

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        return self.values.shape[1], self.values.shape[0]

    @property
    def name(self) -> str:
        """The file of the shortest exposure."""
        return self.sources[0].file


class _Merge:
    """The weighted mean of x / t, light over time, over exposures from the shortest on.

    Where the noise of x is that of photons, the variance of x / t goes with 1 / t and the best
    weight is t; where it is that of reading the sensor, 1 / t² and t². t^1.5 needs to know of
    neither: for exposures 1, 4 and 16 its standard deviation is 4 % above the least in both.
    Samples near clipping weigh less, down to nothing; the shortest exposure always has its whole
    weight.
    """

    def __init__(self, image: ImageFile, exposure_s: float) -> None:
        self.total = np.empty(image.numbers.shape, np.float32)
        self.weight = np.full(image.numbers.shape, exposure_s**1.5, np.float32)
        self.saturated = np.empty(image.numbers.shape[:2], bool)
        self.rounding = image.step**2 / 12 * exposure_s
        self.weights = exposure_s**1.5
        for rows in _blocks(image):
            light = image.linear(rows)
            self.total[rows] = light * np.float32(exposure_s**0.5)
            if image.white is not None:
                # One channel after the other: `any` over a short axis is ten times as slow.
                clipped = np.moveaxis(light >= CLIPPED, -1, 0)
                self.saturated[rows] = reduce(np.logical_or, clipped)
            else:
                self.saturated[rows] = False

    def add(self, image: ImageFile, exposure_s: float) -> float | None:
        """Add a longer exposure.

        Returns:
            Its light over the light foretold by what was there before, over the samples that it
            shows well; None where these are too few.
        """
        seen = foretold = 0.0
        compared = 0
        for rows in _blocks(image):
            light = image.linear(rows)
            if image.white is None:
                weight = np.ones_like(light)
            else:
                weight = (CLIPPED - light) * np.float32(1 / (CLIPPED - TRUSTED))
                np.clip(weight, 0, 1, out=weight)
            well = (light > 0.2) & (weight == 1)
            seen += float(light[well].sum(dtype=float))
            before = self.total[rows][well] / self.weight[rows][well]
            foretold += float(before.sum(dtype=float)) * exposure_s
            compared += int(np.count_nonzero(well))
            weight *= np.float32(exposure_s**0.5)
            light *= weight
            self.total[rows] += light
            weight *= np.float32(exposure_s)
            self.weight[rows] += weight
        self.rounding += image.step**2 / 12 * exposure_s
        self.weights += exposure_s**1.5
        if compared < FEWEST_COMPARED:
            return None
        return seen / foretold if foretold > 0 else np.inf

    def values(self) -> NDArray[np.float32]:
        """Radiance; the sums are used up."""
        self.total /= self.weight
        return self.total

    def rounding_noise(self) -> float:
        """Standard deviation that rounding to whole numbers brings in the dark."""
        return float(np.sqrt(self.rounding)) / self.weights


def _blocks(image: ImageFile) -> Iterator[slice]:
    height, width, channels = image.numbers.shape
    step = max(1, BLOCK // (width * channels))
    for start in range(0, height, step):
        yield slice(start, min(start + step, height))


def dark_noise(values: NDArray[np.float32]) -> float:
    """Standard deviation of noise where a picture is darkest.

    In squares of 16 × 16 pixels, the spread of differences of pixels four apart; of the darkest
    twentieth of squares, the median. An even slope of light has no part in it, and a few structured
    squares do not count. Where black is cut off at 0, half of the noise is gone, and the figure is
    low accordingly.

    Args:
        values: Shape (height, width, channels), both sides 16 or more.

    Returns:
        Of the noisiest channel, in the unit of `values`.
    """
    height, width, channels = values.shape
    rows, columns = height // SQUARE, width // SQUARE
    means = np.empty((rows, columns, channels))
    variances = np.empty_like(means)
    for row in range(rows):
        strip = values[row * SQUARE : (row + 1) * SQUARE, : columns * SQUARE]
        squares = strip.reshape(SQUARE, columns, SQUARE, channels)
        differences = squares[:, :, LAG:] - squares[:, :, :-LAG]
        means[row] = squares.mean(axis=(0, 2))
        variances[row] = differences.var(axis=(0, 2)) / 2
    means, variances = means.reshape(-1, channels), variances.reshape(-1, channels)
    darkest = np.argsort(means, axis=0)[: max(1, round(DARK * len(means)))]
    return float(np.sqrt(np.median(np.take_along_axis(variances, darkest, axis=0), axis=0).max()))


def read_photograph(photograph: Photograph, camera: Camera, folder: Path) -> Photo:
    """Read a photograph; if it has brackets, one after the other, and merge them.

    Args:
        photograph: What the capture says of it.
        camera: What it says of the camera.
        folder: That of the capture file.

    Raises:
        InputError: A file cannot be used (see `read_image`); brackets differ in size, or in their
            light by other factors than their exposures; all is black; or all is clipped even in the
            shortest exposure.
    """
    brackets: Sequence[Bracket | None] = [None]
    if photograph.brackets is not None:
        brackets = sorted(photograph.brackets, key=attrgetter("exposure_s"))
    merge: _Merge | None = None
    size = (0, 0)
    sources: list[Source] = []
    for bracket in tracked(brackets, f"reading {photograph.name}"):
        name = photograph.name if bracket is None else bracket.file
        image = read_image(folder / name, camera)
        told = (bracket or photograph).exposure_s
        exposure_s, exposure_from = told or image.exposure_s or 1.0, "nobody"
        if told is not None:
            exposure_from = "capture"
        elif image.exposure_s is not None:
            exposure_from = "file"
        agreement = None
        if merge is None:
            size = image.size
            merge = _Merge(image, exposure_s)
        else:
            if image.size != size:
                light = image.linear(slice(None))
                raise _other_size(folder / name, name, light, size, sources[0].file)
            agreement = merge.add(image, exposure_s)
            if agreement is not None and not (
                1 / LARGEST_EXPOSURE_ERROR < agreement < LARGEST_EXPOSURE_ERROR
            ):
                shorter = ", ".join(source.file for source in sources)
                expected = f"about {agreement * exposure_s:.3g}, going by the light of {shorter}"
                raise InputError(folder / name, "exposure_s", exposure_s, expected)
        sources.append(
            Source(
                *(name, image.kind, exposure_s, exposure_from, image.exposure_s, image.focal_px),
                agreement,
            )
        )
    assert merge is not None
    if merge.saturated.all():
        file = folder / sources[0].file
        error = InputError(file, "numbers", "all clipped", "an exposure short enough")
        raise PhotographError(error, Evidence.of(sources[0].file, merge.values()))
    values = merge.values()
    if values.max() <= 0:
        error = InputError(folder / sources[-1].file, "numbers", "all black", "some light")
        raise PhotographError(error, Evidence.of(sources[-1].file, values))
    noise = max(dark_noise(values), merge.rounding_noise())
    noted = [source.noted_focal_px for source in sources if source.noted_focal_px is not None]
    focal_px, focal_from = camera.focal_px, "nobody"
    if focal_px is not None:
        focal_from = "capture"
    elif noted:
        focal_px, focal_from = noted[0], "file"
    return Photo(
        *(values, merge.saturated, noise, sources[0].exposure_s, focal_px, focal_from),
        tuple(sources),
    )


def read_photographs(capture: Capture, folder: Path) -> Iterator[Photo]:
    """Read the photographs of a capture, one after the other.

    Args:
        capture: What its file says.
        folder: That of its file.

    Raises:
        InputError: One cannot be used (see `read_photograph`); they differ in size; or the exposure
            of some is known and that of others is not, so that they cannot be compared.
    """
    first: tuple[str, tuple[int, int], bool] | None = None
    for photograph in capture.photographs:
        photo = read_photograph(photograph, capture.camera, folder)
        known = photo.sources[0].exposure_from != "nobody"
        if first is None:
            first = photo.name, photo.size, known
        if photo.size != first[1]:
            raise _other_size(folder / photo.name, photo.name, photo.values, first[1], first[0])
        if known != first[2]:
            unknown = photo.name if first[2] else first[0]
            other = first[0] if first[2] else photo.name
            expected = f"an exposure in the capture or in the file, as {other} has one"
            raise InputError(folder / unknown, "exposure_s", None, expected)
        yield photo


def write_photograph(
    file: Path,
    values: NDArray[np.floating],
    bits: int,
    camera: Camera,
    exposure_s: float | None = None,
) -> None:
    """Write light as a camera stores it: what `read_image` reads with the same camera.

    Args:
        file: TIFF, PNG or EXR, by its extension.
        values: Light of full scale, shape (height, width, 1 or 3). It is rounded, and cut off at
            white and at 0; in an EXR neither.
        bits: Number of bits in TIFF and PNG: 8, 12 (in 16) or 16. An EXR holds floats whatever it
            is.
        camera: Its response and its numbers for black and white; without one white is 2^bits − 1.
        exposure_s: Noted in the file where the format has a place for it.

    Raises:
        InputError: The extension or the bits are none of these, white takes more bits, or there is
            none where a reader would take another.
    """
    if file.suffix.lower() == ".exr":
        scale = 1.0 if camera.white is None else camera.white - camera.black
        write_image(file, (values * scale + camera.black).astype(np.float32), exposure_s)
        return
    if bits not in (8, 12, 16):
        raise InputError(file, "bits", bits, "8, 12 or 16")
    largest = 2**bits - 1
    if camera.white is None and bits == 12:
        raise InputError(
            file, "camera.white", None, f"{largest}, for the file's type is of 16 bits"
        )
    white = largest if camera.white is None else camera.white
    if white > largest:
        raise InputError(file, "camera.white", white, f"{largest} at most, which {bits} bits hold")
    coded = eotf_inverse_sRGB(values) if camera.response == "srgb" else values
    numbers = np.clip(np.rint(camera.black + coded * (white - camera.black)), 0, white)
    write_image(file, numbers.astype(np.uint8 if bits == 8 else np.uint16), exposure_s)


def _other_size(
    file: Path, name: str, values: NDArray[np.float32], needed: tuple[int, int], other: str
) -> PhotographError:
    size = (values.shape[1], values.shape[0])
    found, expected = (f"{width} × {height}" for width, height in (size, needed))
    error = InputError(file, "size", found, f"{expected} pixels, as {other} has")
    frames = (Mark(expected, _frame(needed), False), Mark(found, _frame(size), True))
    return PhotographError(error, Evidence.of(name, values, *frames))


def _frame(size: tuple[int, int]) -> NDArray[np.float64]:
    width, height = size
    return np.array([(0, 0), (width, 0), (width, height), (0, height)]) - 0.5
