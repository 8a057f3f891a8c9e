"""From a recipe to a patch that repeats and is sampled finely enough."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from precompute.errors import InputError
from precompute.height_fields.field import HeightField
from precompute.height_fields.generate import generated
from precompute.height_fields.levelling import levelled, with_rows_mended
from precompute.height_fields.read import read_height_field
from precompute.height_fields.recipe import Crop, FileSource, HeightFieldRecipe
from precompute.height_fields.sampling import (
    asked_pitch,
    refuse_large,
    refuse_undersampled,
    resampled,
)
from precompute.height_fields.spectrum import periods_held

LEAST_PERIODS = 1.8
"""Of a patch's dominant period: two, less what levelling and the window shift the estimate by. A
cosine of two periods is taken for 1.82 to 2, depending on its phase, one of one period for 1.5."""

FAR_FINER = 4.0
"""How much finer than theory asks a file's pitch is before the patch is coarsened of itself."""


def prepared(recipe: HeightFieldRecipe, folder: Path) -> HeightField:
    """Generate or read a field and make it repeat.

    Outlier rows are mended first, then the field is levelled, cropped, tiled and resampled.

    Args:
        recipe: What to do.
        folder: Where a file's path starts.

    Raises:
        InputError: The file cannot be read (`read_height_field`), the crop lies outside of it, a
            file's patch holds fewer than two of its dominant periods, its samples are too many, or
            too far apart for visible light (`refuse_undersampled`).
    """
    source = recipe.source
    if isinstance(source, FileSource):
        file = folder / source.path
        patch = _from_file(recipe, source, file)
    else:
        file = source.kind
        patch = generated(source, recipe.pitch)
    if recipe.tiling == "mirrored":
        patch = mirrored(file, patch)
    if isinstance(source, FileSource):
        pitch = recipe.pitch or _coarser_pitch(patch)
        patch = patch if pitch is None else resampled(file, patch, pitch)
    refuse_large(file, *patch.heights.shape)
    refuse_undersampled(file, patch)
    return patch


def cropped(file: str | Path, field: HeightField, crop: Crop) -> HeightField:
    """The samples within a rectangle, to the nearest ones.

    Raises:
        InputError: The rectangle reaches beyond the patch or holds fewer than two rows or columns.
    """
    corners = []
    for first, length, pitch, samples in (
        (crop.x, crop.width, field.pitch[0], field.heights.shape[1]),
        (crop.y, crop.height, field.pitch[1], field.heights.shape[0]),
    ):
        begin, end = round(first / pitch), round((first + length) / pitch)
        if end > samples or end - begin < 2:
            width, height = field.period
            expected = (
                f"two samples or more within the patch of {width:.6g} um by {height:.6g} um, "
                f"whose samples are {pitch:.4g} um apart"
            )
            raise InputError(file, "crop", crop.model_dump(), expected)
        corners.append(slice(begin, end))
    return HeightField(field.heights[corners[1], corners[0]], field.pitch)


def mirrored(file: str | Path, field: HeightField) -> HeightField:
    """The patch and its reflections, twice as long along both axes, which repeat without a seam.

    Raises:
        InputError: That would be too large.
    """
    rows, columns = field.heights.shape
    refuse_large(file, 2 * rows, 2 * columns)
    half = np.concatenate([field.heights, field.heights[:, ::-1]], axis=1)
    return HeightField(np.concatenate([half, half[::-1]]), field.pitch)


def _from_file(recipe: HeightFieldRecipe, source: FileSource, file: Path) -> HeightField:
    field = read_height_field(file, source.pitch_um, source.height_um, source.channel)
    heights = with_rows_mended(file, field.heights) if recipe.outlier_rows else field.heights
    heights = levelled(heights, recipe.level or ("none" if source.whole_periods else "plane"))
    patch = HeightField(heights, field.pitch)
    if recipe.crop is not None:
        patch = cropped(file, patch, recipe.crop)
    if np.ptp(patch.heights) == 0:
        raise InputError(file, "heights", "all equal", "heights that differ, within the crop")
    periods = periods_held(patch)
    if not source.whole_periods and periods < LEAST_PERIODS:
        expected = (
            "two or more of the dominant period: a larger patch, a polynomial level if that is "
            "the instrument's bow, or whole_periods for a patch that is a whole number of them"
        )
        raise InputError(file, "periods", round(periods, 2), expected)
    return patch


def _coarser_pitch(patch: HeightField) -> float | None:
    """Half the pitch that theory asks for, where the patch's own is far finer."""
    asked = asked_pitch(patch)
    return asked / 2 if max(patch.pitch) * FAR_FINER < asked else None
