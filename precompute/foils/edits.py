"""Foils made of foils: their texels turned, cut, repeated, masked, given other periods.

Every edit takes texels and returns others; gratings are not interpolated, since between two there
is no third.
"""

from __future__ import annotations

import hashlib
import io
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError

from precompute.errors import InputError, unreadable
from precompute.foils.bumps import Bumps, bumps_of_heights, random_bumps
from precompute.foils.edit_lines import (
    BumpsEdit,
    CropEdit,
    Edit,
    MaskEdit,
    OffsetEdit,
    PeriodEdit,
    RepeatEdit,
    RescaleEdit,
    RotateEdit,
)
from precompute.foils.foil_map import foil_axes, map_of_texels
from precompute.maps import Map, Table

Array = NDArray[np.float64]

MOST = 16384
"""Texels along a side: as many as a graphics card's texture may have."""


@dataclass(frozen=True)
class Texels:
    """A foil's texels.

    Attributes:
        grating: cos 2θ, sin 2θ, 1/a (1/µm) and strength as they are stored, so that what an edit
            leaves alone stays as it was, to the bit. Shape (rows, columns, 4), the first row on
            top.
        confidence: 0 to 1, shape (rows, columns, channels); None where there is none.
        bumps: As many texels; None where it is flat.
        tile_mm: Width and height, mm.
    """

    grating: Array
    confidence: Array | None
    bumps: Bumps | None
    tile_mm: tuple[float, float]

    def moved(self, index: Any, tile_mm: tuple[float, float]) -> Texels:
        """The texels of an index into rows and columns, on a tile of another size."""
        confidence = None if self.confidence is None else self.confidence[index]
        bumps = None if self.bumps is None else self.bumps.moved(index)
        return Texels(self.grating[index], confidence, bumps, tile_mm)

    def resized(self, rows: NDArray[np.intp], columns: NDArray[np.intp]) -> Texels:
        """Given rows of given columns, texels as large as before."""
        width, height = self.tile_mm
        was = self.grating.shape
        size = (width * columns.size / was[1], height * rows.size / was[0])
        return self.moved(np.ix_(rows, columns), size)

    def with_bumps_at(self, source: Texels, row: Array, column: Array) -> Texels:
        """With the bumps that the source has at places between its texels.

        Args:
            source: Whose bumps.
            row: Texels from the top, real numbers.
            column: Texels from the left, likewise.
        """
        bumps = None if source.bumps is None else source.bumps.at(row, column)
        return replace(self, bumps=bumps)

    def with_grating(self, **channels: Array) -> Texels:
        """With other numbers in some of the channels.

        Args:
            channels: ``doubled``, cos 2θ + i sin 2θ; ``frequency``, 1/µm; ``strength``, a share.
        """
        grating = self.grating.copy()
        for name, values in channels.items():
            match name:
                case "doubled":
                    grating[..., 0], grating[..., 1] = values.real, values.imag
                case "frequency":
                    grating[..., 2] = values
                case "strength":
                    grating[..., 3] = values
        return replace(self, grating=grating)


def edited_map(foil: Map, file: Path, edits: Sequence[Edit], folder: Path) -> Map:
    """A foil after edits, whose recipe tells them, and from what they started.

    Args:
        foil: What is edited; edits that it has had already are told before these.
        file: Where it was read from.
        edits: In their order.
        folder: Where the files are that they name.

    Raises:
        InputError: The map is no foil, an edit does not fit it, a file cannot be used, or nothing
            that diffracts is left.
    """
    if foil.kind != "foil":
        raise InputError(file, "kind", foil.kind, "foil")
    width, height = np.broadcast_to(foil.constants["tile_mm"], 2).tolist()
    confidence = foil.tables.get("confidence")
    texels = Texels(
        foil.tables["grating"].values,
        None if confidence is None else confidence.values,
        _bumps_of(foil, file),
        (width, height),
    )
    told = []
    for edit in edits:
        texels, line = _edited(texels, edit, folder)
        told.append(line.model_dump(exclude_none=True))
    start, before = {"map": file.stem, "recipe": foil.recipe}, []
    if foil.recipe.get("design") == "edited":
        start, before = foil.recipe["from"], foil.recipe["edits"]
    profile = foil.recipe.get("profile")
    recipe = {"kind": "foil", "design": "edited", "from": start, "edits": [*before, *told]}
    out = map_of_texels(
        texels.grating,
        height=float(np.ravel(foil.constants["height_um"])[0]),
        tile_mm=texels.tile_mm,
        recipe=recipe if profile is None else {**recipe, "profile": profile},
    )
    if confidence is not None and texels.confidence is not None:
        axes = foil_axes(*texels.confidence.shape[:2])
        out.tables["confidence"] = Table(
            texels.confidence, axes, confidence.channels, confidence.dtype, confidence.decode
        )
    if texels.bumps is not None:
        out.tables["normal"] = texels.bumps.table()
    return out


def _bumps_of(foil: Map, file: Path) -> Bumps | None:
    normal = foil.tables.get("normal")
    if normal is None:
        return None
    found, expected = normal.values.shape, foil.tables["grating"].values.shape
    if found != expected:
        raise InputError(file, "arrays.normal.shape", found, f"that of grating, {expected}")
    return Bumps.of(normal)


def _edited(texels: Texels, edit: Edit, folder: Path) -> tuple[Texels, Edit]:
    """The texels after an edit, and the edit as the sidecar tells it."""
    match edit:
        case PeriodEdit():
            return with_periods(texels, edit), edit
        case MaskEdit():
            share, checksum = read_mask(folder / edit.file)
            told = _told(edit, folder / edit.file, checksum)
            return masked(texels, 1 - share if edit.invert else share), told
        case CropEdit():
            return cropped(texels, edit), edit
        case RepeatEdit():
            return repeated(texels, edit), edit
        case RotateEdit():
            return rotated(texels, edit.degrees), edit
        case RescaleEdit():
            return rescaled(texels, edit), edit
        case OffsetEdit():
            return turned(texels, edit.degrees), edit
        case BumpsEdit():
            return bumpy(texels, edit, folder)


def _told(edit: MaskEdit | BumpsEdit, file: Path, checksum: str) -> Edit:
    """An edit that names a file, as the sidecar tells it: without folders, with the checksum."""
    if edit.sha256 not in (None, checksum):
        raise InputError(file, "sha256", checksum, f"{edit.sha256}")
    return edit.model_copy(update={"file": file.name, "sha256": checksum})


def bumpy(texels: Texels, edit: BumpsEdit, folder: Path) -> tuple[Texels, Edit]:
    """The foil with bumps, or without where they are 0, and the edit as the sidecar tells it."""
    rows, columns = texels.grating.shape[:2]
    size = (rows, columns), texels.tile_mm
    match edit:
        case BumpsEdit(file=str(name), depth_um=float(depth)):
            bumps, checksum = bumps_of_heights(folder / name, depth, *size)
            return replace(texels, bumps=bumps), _told(edit, folder / name, checksum)
        case BumpsEdit(deviation_deg=float(degrees), length_mm=float(length), seed=int(seed)):
            bumps = random_bumps(*size, np.tan(np.radians(degrees)), length, seed)
            return replace(texels, bumps=bumps), edit
        case _:
            return replace(texels, bumps=None), edit


def with_periods(texels: Texels, edit: PeriodEdit) -> Texels:
    """Periods by orientation."""
    θ = np.arctan2(texels.grating[..., 1], texels.grating[..., 0]) / 2
    # The nearest bin, not the next below: 8 bits put 15° at 14.9 as often as at 15.1.
    share = np.mod(np.round(θ * edit.bins / np.pi), edit.bins) / (edit.bins - 1)
    match edit.blend:
        case "linear":
            blend = share
        case "quadratic":
            blend = share**2
        case "sin2":
            blend = np.sin(np.pi * share / 2) ** 2
    period = edit.shortest + (edit.longest - edit.shortest) * blend
    return texels.with_grating(frequency=1 / period)


def read_mask(file: Path) -> tuple[Array, str]:
    """How light and opaque a PNG is.

    Returns:
        Shares, 0 to 1, shape (rows, columns), and the file's checksum.

    Raises:
        InputError: No PNG of 8 bits a channel.
    """
    try:
        data = file.read_bytes()
        with Image.open(io.BytesIO(data), formats=["PNG"]) as image:
            if image.mode.startswith(("I", "F")):
                raise InputError(file, "bits", image.mode, "8 bits a channel")
            texels = np.asarray(image.convert("LA"), float) / 255
    except (UnidentifiedImageError, Image.DecompressionBombError, OSError) as failure:
        raise unreadable(file, failure) from failure
    return texels.prod(axis=-1), hashlib.sha256(data).hexdigest()


def masked(texels: Texels, share: Array) -> Texels:
    """Strength times a picture that is stretched over the map, its nearest texel.

    Args:
        texels: The foil.
        share: What is left of the strength, 0 to 1, shape (rows, columns) of the picture.
    """
    rows, columns = (
        _nearest(size, of) for size, of in zip(texels.grating.shape, share.shape, strict=False)
    )
    return texels.with_grating(strength=texels.grating[..., 3] * share[np.ix_(rows, columns)])


def cropped(texels: Texels, edit: CropEdit) -> Texels:
    """A rectangle."""
    rows, columns = texels.grating.shape[:2]
    for field, first, count, size in (
        ("columns", edit.column, edit.columns, columns),
        ("rows", edit.row, edit.rows, rows),
    ):
        if first + count > size:
            expected = f"at most {size - first}, from {first} of {size}"
            raise InputError("edit crop", field, count, expected)
    return texels.resized(
        np.arange(edit.row, edit.row + edit.rows),
        np.arange(edit.column, edit.column + edit.columns),
    )


def repeated(texels: Texels, edit: RepeatEdit) -> Texels:
    """The tile several times."""
    rows, columns = texels.grating.shape[:2]
    _check_size("repeat", "across", edit.across, columns * edit.across)
    _check_size("repeat", "down", edit.down, rows * edit.down)
    return texels.resized(
        np.arange(rows * edit.down) % rows, np.arange(columns * edit.across) % columns
    )


def rescaled(texels: Texels, edit: RescaleEdit) -> Texels:
    """The pattern at another size; its tile is as large as whole texels make it."""
    counts = [max(round(size * edit.factor), 1) for size in texels.grating.shape[:2]]
    _check_size("rescale", "factor", edit.factor, max(counts))
    rows, columns = (
        _nearest(count, size) for count, size in zip(counts, texels.grating.shape, strict=False)
    )
    row, column = (
        (np.arange(count) + 0.5) * size / count - 0.5
        for count, size in zip(counts, texels.grating.shape, strict=False)
    )
    out = texels.resized(rows, columns).with_bumps_at(texels, row[:, None], column)
    if not edit.periods:
        return out
    return out.with_grating(frequency=out.grating[..., 2] / edit.factor)


def turned(texels: Texels, degrees: float) -> Texels:
    """All gratings turned counter-clockwise, the texels where they are."""
    quarters, rest = divmod(degrees % 180, 90)
    doubled = texels.grating[..., 0] + 1j * texels.grating[..., 1]
    # By a quarter turn, and by none, exactly.
    doubled = doubled * ((-1) ** int(quarters) * (np.exp(2j * np.radians(rest)) if rest else 1))
    return texels.with_grating(doubled=doubled)


def rotated(texels: Texels, degrees: float) -> Texels:
    """The foil turned counter-clockwise: texels change places, gratings and slopes turn."""
    if texels.bumps is not None:
        texels = replace(texels, bumps=texels.bumps.turned(degrees))
    width, height = texels.tile_mm
    quarters, rest = divmod(degrees % 360, 90)
    if rest:
        return turned(_aslant(texels, np.radians(degrees)), degrees)
    rows, columns = texels.grating.shape[:2]
    place = np.rot90(np.arange(rows * columns).reshape(rows, columns), int(quarters))
    size = (height, width) if quarters % 2 else (width, height)
    return turned(texels.moved(np.unravel_index(place, (rows, columns)), size), degrees)


def _aslant(texels: Texels, angle: float) -> Texels:
    """Texels of a map that holds the turned foil, bare around it; orientations as they were."""
    rows, columns = texels.grating.shape[:2]
    width, height = texels.tile_mm
    pitch = np.array([width / columns, height / rows])
    c, s = np.cos(angle), np.sin(angle)
    span = np.array([abs(c) * width + abs(s) * height, abs(s) * width + abs(c) * height])
    across, down = (int(count) for count in np.ceil(span / pitch - 1e-9))
    _check_size("rotate", "degrees", float(np.degrees(angle)), max(across, down))
    x = (np.arange(across) + 0.5 - across / 2) * pitch[0]
    y = (down / 2 - 0.5 - np.arange(down))[:, None] * pitch[1]
    # Where the foil had what is now at (x, y), both from its middle.
    from_left = (c * x + s * y) / pitch[0] + columns / 2
    from_top = rows / 2 - (c * y - s * x) / pitch[1]
    column, row = np.floor(from_left).astype(np.intp), np.floor(from_top).astype(np.intp)
    inside = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
    index = (row.clip(0, rows - 1), column.clip(0, columns - 1))
    out = texels.moved(index, (across * pitch[0], down * pitch[1]))
    out = out.with_bumps_at(texels, from_top - 0.5, from_left - 0.5)
    return out.with_grating(strength=np.where(inside, out.grating[..., 3], 0.0))


def _nearest(count: int, size: int) -> NDArray[np.intp]:
    """The texels of a row of some in whose places the middles of `count` lie."""
    return ((np.arange(count) + 0.5) * size / count).astype(np.intp)


def _check_size(edit: str, field: str, value: float, texels: int) -> None:
    if texels > MOST:
        expected = f"a map of at most {MOST} texels a side, not {texels}"
        raise InputError(f"edit {edit}", field, value, expected)
