"""A map: binaries that the shaders look up, and the sidecar that says what is in them."""

from __future__ import annotations

import hashlib
import json
import math
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    FailFast,
    Field,
    ValidationError,
    model_validator,
)
from scipy.ndimage import map_coordinates

import precompute
from precompute.axes import Axis
from precompute.errors import InputError, unreadable
from precompute.files import written_aside
from precompute.images import decode_png, encode_png
from precompute.validation import first_failure

FORMAT = "three-diffraction/map"
VERSION = 1
Kind = Literal["profile", "lobes", "metals", "foil", "height-field-terms", "height-field-baked"]


MAX_SIDECAR_BYTES = 2**18
"""Shipped sidecars have 16 kB. A validation lists every wrong field, which costs far more."""

MAX_ARRAY_BYTES = 2**28
"""8192 × 8192 texels of 8-bit RGBA: larger textures cannot be relied upon."""


def _file_name(name: str) -> str:
    # Nothing that leaves the folder on any system, or that no system has in a name.
    if re.fullmatch(r"[^/\\:\x00-\x1f\x7f]+\.(bin|png)", name) is None:
        raise ValueError("a .bin's or .png's name without a folder")
    return name


def _json_value(value: dict[str, Any]) -> dict[str, Any]:
    json.dumps(value, allow_nan=False)
    return value


# Arrays and constants are keys of objects in JavaScript, and array names become files' names.
Name = Annotated[str, Field(pattern="^[A-Za-z][A-Za-z0-9_]*$")]
Json = Annotated[dict[str, Any], AfterValidator(_json_value)]


class ArraySpec(BaseModel):
    """One binary of a map.

    Attributes:
        file: Its name, beside the sidecar: ``.bin`` (little-endian, slowest axis first, channels
            last) or ``.png`` (8-bit RGBA).
        dtype: Type of a number in the file.
        shape: Sizes of the axes, then the number of channels.
        sha256: Checksum of the file.
        axes: What each axis stands for.
        channels: What each channel is.
        decode: For 8-bit files, (offset, scale) of each channel, in its unit: value = offset +
            scale·texel/255.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    file: Annotated[str, AfterValidator(_file_name)]
    dtype: Literal["float16", "float32", "uint8"]
    shape: Annotated[tuple[Annotated[int, Field(ge=1)], ...], Field(min_length=2, max_length=4)]
    sha256: str
    axes: Annotated[tuple[Axis, ...], FailFast()]
    channels: tuple[str, ...]
    decode: tuple[tuple[float, float], ...] | None = None

    @model_validator(mode="after")
    def _agrees_with_itself(self) -> ArraySpec:
        expected = (*(axis.size for axis in self.axes), len(self.channels))
        if self.shape != expected:
            raise ValueError(f"the shape of its axes and channels, {expected}, not {self.shape}")
        if self.file.endswith(".png") != (self.dtype == "uint8"):
            raise ValueError("uint8 in a .png, other numbers in a .bin")
        if self.dtype == "uint8":
            if self.decode is None or len(self.decode) != expected[-1]:
                raise ValueError("for uint8, decode with an offset and a scale for each channel")
            if len(expected) != 3 or expected[2] != 4:
                raise ValueError("for uint8, rows, columns and 4 channels")
        if self.byte_size > MAX_ARRAY_BYTES:
            raise ValueError(f"an array of {MAX_ARRAY_BYTES} bytes at most")
        return self

    @property
    def byte_size(self) -> int:
        """Size of its numbers, before any compression."""
        return math.prod(self.shape) * np.dtype(self.dtype).itemsize


class Sidecar(BaseModel):
    """What NAME.json says of a map; its fields are described in docs/map-format.md."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    format: Literal["three-diffraction/map"] = FORMAT
    version: Literal[1] = VERSION
    kind: Kind
    quantity: str
    symbol: str
    arrays: dict[Name, ArraySpec]
    constants: dict[Name, float | tuple[float, ...]]
    error: dict[str, float | str]
    recipe: Json
    generator: dict[str, str] = Field(
        default_factory=lambda: {"name": "precompute", "version": precompute.__version__}
    )

    @staticmethod
    def read(file: Path) -> Sidecar:
        """Read a sidecar alone; `Map.read` reads its binaries too.

        Raises:
            InputError: It is missing, of another format or version, or a field is wrong.
        """
        try:
            # Strict: a number in quotes is none.
            return Sidecar.model_validate_json(_contents(file, MAX_SIDECAR_BYTES), strict=True)
        except ValidationError as failure:
            raise first_failure(file, failure) from failure


@dataclass
class Table:
    """The numbers of one binary before they are written, or after they are read.

    Attributes:
        values: Shape of the axes, then channels; decoded, as numbers of the quantity itself.
        axes: What each axis stands for.
        channels: What each channel is.
        dtype: How the numbers are stored.
        decode: For ``uint8``: (offset, scale) of each channel, in its unit.
    """

    values: NDArray[Any]
    axes: tuple[Axis, ...]
    channels: tuple[str, ...]
    dtype: Literal["float16", "float32", "uint8"] = "float16"
    decode: tuple[tuple[float, float], ...] | None = None

    def sample(self, *parameters: NDArray[np.float64]) -> NDArray[np.float64]:
        """Multilinear interpolation at parameters of each axis, as a texture unit does.

        Args:
            parameters: One array for each axis, all of one shape.

        Returns:
            That shape, then channels.
        """
        texels = [a.texel_from_parameter(p) for a, p in zip(self.axes, parameters, strict=True)]
        coordinates = np.stack(np.broadcast_arrays(*texels))
        return np.stack(
            [
                map_coordinates(self.values[..., c], coordinates, order=1, mode="nearest")
                for c in range(self.values.shape[-1])
            ],
            axis=-1,
        )


@dataclass
class Map:
    """A map in memory: what `write` stores and `read` returns."""

    kind: Kind
    quantity: str
    symbol: str
    tables: dict[str, Table]
    error: dict[str, float | str]
    recipe: dict[str, Any]
    constants: dict[str, float | tuple[float, ...]] = field(default_factory=dict)

    def write(self, folder: Path, name: str) -> list[Path]:
        """Write NAME.json and its binaries, each aside and then renamed, the sidecar last.

        Nothing is written unless all of it can be.

        Args:
            folder: Where; made if missing.
            name: The map's name, without extension.

        Returns:
            The files written.

        Raises:
            InputError: A table holds numbers that its storage type cannot, or the map is one that
                `read` would refuse.
        """
        sidecar_name = folder / f"{name}.json"
        contents, arrays = {}, {}
        try:
            for key, table in self.tables.items():
                suffix = "png" if table.dtype == "uint8" else "bin"
                file = folder / f"{name}.{key}.{suffix}"
                data = _encoded(table, file, key)
                contents[file] = data
                arrays[key] = ArraySpec(
                    file=file.name,
                    dtype=table.dtype,
                    shape=table.values.shape,
                    sha256=hashlib.sha256(data).hexdigest(),
                    axes=table.axes,
                    channels=table.channels,
                    decode=table.decode,
                )
            sidecar = Sidecar(
                kind=self.kind,
                quantity=self.quantity,
                symbol=self.symbol,
                arrays=arrays,
                constants=self.constants,
                error=self.error,
                recipe=self.recipe,
            )
        except ValidationError as failure:
            raise first_failure(sidecar_name, failure) from failure
        text = json.dumps(sidecar.model_dump(exclude_none=True), indent=1)
        contents[sidecar_name] = text.encode() + b"\n"
        if len(contents[sidecar_name]) > MAX_SIDECAR_BYTES:
            size, expected = len(contents[sidecar_name]), f"{MAX_SIDECAR_BYTES} bytes at most"
            raise InputError(sidecar_name, "size", size, expected)
        for file, data in contents.items():
            with written_aside(file) as aside:
                aside.write_bytes(data)
        return list(contents)

    @staticmethod
    def read(file: Path) -> Map:
        """Read a sidecar and its binaries.

        Args:
            file: The sidecar, with or without ``.json``.

        Raises:
            InputError: The sidecar is of another format or version, lacks a field or names a file
                elsewhere, or a binary is missing, of another size or checksum than stated, or
                holds NaN or infinite texels.
        """
        file = sidecar_file(file)
        sidecar = Sidecar.read(file)
        tables = {key: _read_table(file.parent / a.file, a) for key, a in sidecar.arrays.items()}
        return Map(
            kind=sidecar.kind,
            quantity=sidecar.quantity,
            symbol=sidecar.symbol,
            tables=tables,
            error=sidecar.error,
            recipe=sidecar.recipe,
            constants=sidecar.constants,
        )


def sidecar_file(file: Path) -> Path:
    """The sidecar of a map that is named with or without ``.json``."""
    return file.with_name(file.name.removesuffix(".json") + ".json")


def _encoded(table: Table, file: Path, key: str) -> bytes:
    if table.dtype == "uint8":
        offset, scale = np.array(table.decode).T
        stored = np.round((table.values - offset) / scale * 255)
        good = (stored >= 0) & (stored <= 255)
        problem, expected = "texels that are NaN or beyond what decode covers", "0 to 255"
    else:
        with np.errstate(over="ignore"):
            stored = table.values.astype(np.dtype(table.dtype).newbyteorder("<"))
        good = np.isfinite(stored)
        problem, expected = "NaN or infinite texels", f"finite {table.dtype}"
    if not good.all():
        raise InputError(file, key, f"{np.count_nonzero(~good)} {problem}", expected)
    return encode_png(stored.astype(np.uint8)) if table.dtype == "uint8" else stored.tobytes()


def _contents(file: Path, most: int) -> bytes:
    """A file's bytes, its size being looked at first; links are followed."""
    try:
        size = file.stat().st_size
        if not file.is_file():
            raise unreadable(file, "no regular file")
        if size > most:
            raise InputError(file, "size", size, f"{most} bytes at most")
        return file.read_bytes()
    except OSError as failure:
        raise unreadable(file, failure) from failure


def _read_table(file: Path, spec: ArraySpec) -> Table:
    # Deflate stores what it cannot compress; twice as much is no picture of that size.
    data = _contents(file, 2 * spec.byte_size + 2**16 if spec.dtype == "uint8" else spec.byte_size)
    if spec.dtype != "uint8" and len(data) != spec.byte_size:
        raise InputError(file, "size", len(data), f"{spec.byte_size} bytes")
    checksum = hashlib.sha256(data).hexdigest()
    if checksum != spec.sha256:
        raise InputError(file, "sha256", checksum, spec.sha256)
    if spec.dtype == "uint8":
        texels = decode_png(file, data, spec.shape)
        offset, scale = np.array(spec.decode).T
        with np.errstate(over="ignore", invalid="ignore"):  # counted below
            values = offset + scale * texels / 255.0
    else:
        values = np.frombuffer(data, np.dtype(spec.dtype).newbyteorder("<")).reshape(spec.shape)
        with np.errstate(invalid="ignore"):  # counted below
            values = values.astype(np.float64)
    bad = int(np.sum(~np.isfinite(values)))
    if bad:
        raise InputError(file, "texels", f"{bad} NaN or infinite", "finite numbers")
    return Table(values, spec.axes, spec.channels, spec.dtype, spec.decode)
