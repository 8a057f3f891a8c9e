"""How finely a height field must be sampled, and sampling it anew."""

from __future__ import annotations

import math
from itertools import product
from pathlib import Path
from typing import cast

import numpy as np
from numpy.typing import NDArray
from scipy.fft import next_fast_len
from scipy.signal import resample

from precompute.errors import InputError
from precompute.height_fields.field import HeightField
from precompute.spectra import WAVELENGTH_MIN

Array = NDArray[np.float64]

QUARTER_WAVE = WAVELENGTH_MIN / 4
"""λ_min/4 = 0.095 µm, twice over: the coarsest pitch that resolves the 2/λ_min cycles per µm of
light and view both grazing (u = 2), and the largest change of height between neighbouring samples
with a phase k w Δh below π for both head-on (w = 2)."""

MAX_SAMPLES = 4096**2
"""Of a prepared patch: 128 MB as float64. Its spectra take tens of times as much."""


def grid_size(length: float, pitch: float) -> int:
    """Samples along a period at a pitch no coarser than given.

    A multiple of four without prime factors above 5, which Fourier transforms are fast for; the
    pitch becomes length/size.

    >>> grid_size(2.5, 0.05)
    60
    >>> grid_size(12.8, 0.1)
    128
    """
    # Less a billionth: a length that is a whole number of pitches but for its rounding stays so.
    least = math.ceil(length / (4 * pitch) * (1 - 1e-9))
    return 4 * cast(int, next_fast_len(least, real=True))


def refuse_large(file: str | Path, rows: int, columns: int) -> None:
    """Refuse a patch of more than `MAX_SAMPLES`.

    Args:
        file: For the error.
        rows: Number of samples along y.
        columns: Number of samples along x.


    Raises:
        InputError: It is larger.
    """
    if rows * columns > MAX_SAMPLES:
        expected = f"at most {MAX_SAMPLES} samples: a smaller patch or a coarser pitch"
        raise InputError(file, "samples", (columns, rows), expected)


def height_steps(heights: Array) -> Array:
    """|Δh| from each sample to the next along both axes together, the last meeting the first.

    Over a square pitch that is the slope |∇h|.

    Args:
        heights: µm, shape (rows, columns).

    Returns:
        That shape, µm.

    >>> height_steps(np.array([[0.0, 3.0], [4.0, 0.0]])).tolist()
    [[5.0, 4.242640687119285], [5.656854249492381, 5.0]]
    """
    along_x = np.roll(heights, -1, axis=1) - heights
    along_y = np.roll(heights, -1, axis=0) - heights
    return np.hypot(along_x, along_y)


def asked_pitch(field: HeightField) -> float:
    """The coarsest pitch that theory allows for the field, µm.

    It resolves 2/λ_min cycles per µm, and k w |∇h|·pitch < π at the steepest place, the slope being
    that of the Fourier series through the samples: between them it may exceed what they show.

    >>> wave = 0.1 * np.cos(2 * np.pi * np.arange(20) / 20)  # over 0.5 µm, 1.257 steep
    >>> round(asked_pitch(HeightField(np.tile(wave, (20, 1)), (0.025, 0.025))), 4)
    0.0756
    """
    rows, columns = field.heights.shape
    along_x = _angular_frequencies(columns, field.pitch[0])
    along_y = _angular_frequencies(rows, field.pitch[1])[:, None]
    spectrum = np.fft.fft2(field.heights)
    steepest = 0.0
    # At the samples and halfway between: there a step from one to the next is steepest.
    for x, y in product((0.0, field.pitch[0] / 2), (0.0, field.pitch[1] / 2)):
        moved = spectrum * np.exp(1j * along_x * x) * np.exp(1j * along_y * y)
        slopes = (np.fft.ifft2(1j * angular * moved).real for angular in (along_x, along_y))
        steepest = max(steepest, float(np.hypot(*slopes).max()))
    return min(QUARTER_WAVE, QUARTER_WAVE / steepest)


def _angular_frequencies(size: int, pitch: float) -> Array:
    """2πf of each place in a Fourier transform, 1/µm."""
    angular = 2 * np.pi * np.fft.fftfreq(size, pitch)
    if size % 2 == 0:
        angular[size // 2] = 0  # the samples are this wave's crests: it has no slope there
    return np.asarray(angular, dtype=np.float64)


def resampled(file: str | Path, field: HeightField, pitch: float) -> HeightField:
    """The same periodic surface at another pitch, by its Fourier series.

    A coarser grid keeps the spatial frequencies that it can hold and drops the rest; a finer one
    interpolates and invents no detail.

    Args:
        file: Named in errors.
        field: The patch.
        pitch: Largest distance between samples, µm.

    Raises:
        InputError: The finer patch would be too large.
    """
    width, height = field.period
    rows, columns = grid_size(height, pitch), grid_size(width, pitch)
    refuse_large(file, rows, columns)
    heights = resample(np.asarray(resample(field.heights, columns, axis=1)), rows, axis=0)
    return HeightField(np.asarray(heights), (width / columns, height / rows))


def refuse_undersampled(file: str | Path, field: HeightField) -> None:
    """Refuse a patch whose samples lie too far apart for visible light.

    Args:
        file: Named in errors.
        field: The patch, as it repeats.

    Raises:
        InputError: The pitch does not resolve 2/λ_min, or a slope, or the seam between repeats,
            is too steep for it; it says which pitch or tiling would do.
    """
    pitch, rounding = max(field.pitch), 1 + 1e-9
    # Some less: elsewhere between the samples it may be steeper still. To 0.1 nm, rounded down.
    needed = f"{math.floor(0.85 * asked_pitch(field) * 1e4) / 1e4} um"
    if pitch > QUARTER_WAVE * rounding:
        expected = (
            f"at most {needed}, so that the shortest wavelength and the slopes are resolved: a "
            "finer scan, or a pitch in the recipe, to interpolate"
        )
        raise InputError(file, "pitch", round(pitch, 6), expected)
    steps = height_steps(field.heights)
    if steps.max() < QUARTER_WAVE:
        return
    if steps[:-1, :-1].max() < QUARTER_WAVE:
        expected = (
            "mirrored: where the patch meets its repeat, and only there, the height changes by "
            f"{steps.max():.4g} um, and {QUARTER_WAVE:.4g} um would be too much"
        )
        raise InputError(file, "tiling", "periodic", expected)
    expected = f"less than {QUARTER_WAVE / pitch:.4g} at this pitch, or a pitch of at most {needed}"
    raise InputError(file, "slope", round(float(steps.max() / pitch), 4), expected)
