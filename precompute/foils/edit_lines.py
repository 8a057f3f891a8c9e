"""Edits of a foil as they are written: a line on the command, a line in the map's sidecar.

On the command an edit is its kind and fields, ``crop columns=64 rows=32``; in a sidecar it is a
JSON object, ``{"kind": "crop", "columns": 64, "rows": 32, "column": 0, "row": 0}``.
"""

from __future__ import annotations

import shlex
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    TypeAdapter,
    ValidationError,
    ValidationInfo,
    field_validator,
)

from precompute.errors import InputError
from precompute.gratings import Positive
from precompute.validation import first_failure

Texel = Annotated[int, Field(ge=0)]
Count = Annotated[int, Field(ge=1)]


class _Edit(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class PeriodEdit(_Edit):
    """Period by orientation (the 2018 paper, section 6.4).

    Attributes:
        shortest: Period of the first bin, orientation 0, µm.
        longest: Of the last, one bin short of 180°, µm.
        bins: Of orientation, equally wide, the first about 0.
        blend: From first to last bin, t being 0 to 1: t, t² or sin²(πt/2).
    """

    kind: Literal["period"]
    shortest: Positive
    longest: Positive
    bins: Annotated[int, Field(ge=2, le=3600)] = 180
    blend: Literal["linear", "quadratic", "sin2"] = "linear"

    @field_validator("longest")
    @classmethod
    def _is_no_shorter(cls, value: float, info: ValidationInfo) -> float:
        shortest = info.data.get("shortest")
        if shortest is not None and value < shortest:
            raise ValueError(f"the shortest, {shortest:g} um, or more")
        return value


class MaskEdit(_Edit):
    """Only what is light in an image diffracts, grey in part.

    Attributes:
        file: A PNG, stretched over the map; its opacity counts too. The sidecar has its name alone.
        sha256: Checksum of the file, written into the sidecar.
        invert: What is dark diffracts instead.
    """

    kind: Literal["mask"]
    file: Annotated[str, Field(min_length=1)]
    sha256: str | None = None
    invert: bool = False


class CropEdit(_Edit):
    """A rectangle of texels, (0, 0) being the top left.

    Attributes:
        columns: Its width.
        rows: Its height.
        column: Its first column from the left.
        row: Its first row from the top.
    """

    kind: Literal["crop"]
    columns: Count
    rows: Count
    column: Texel = 0
    row: Texel = 0


class RepeatEdit(_Edit):
    """The map several times side by side.

    Attributes:
        across: How many times.
        down: How many rows of them.
    """

    kind: Literal["repeat"]
    across: Count = 1
    down: Count = 1


class RotateEdit(_Edit):
    """The foil turned in its plane, gratings and all.

    Attributes:
        degrees: Counter-clockwise. By other than quarter turns the map grows to hold the foil,
            with bare corners, and does not go on from tile to tile.
    """

    kind: Literal["rotate"]
    degrees: float


class RescaleEdit(_Edit):
    """The pattern larger or smaller, texels as large as before.

    Attributes:
        factor: By how much, no unit.
        periods: Whether periods grow likewise, as they would on a foil that is stretched.
    """

    kind: Literal["rescale"]
    factor: Annotated[float, Field(ge=0.01, le=100)]
    periods: bool = False


class OffsetEdit(_Edit):
    """All gratings turned where they are.

    Attributes:
        degrees: Counter-clockwise.
    """

    kind: Literal["offset"]
    degrees: float


class BumpsEdit(_Edit):
    """The foil's surface uneven, in the place of bumps that it had (the 2018 paper, section 6.2).

    Either at random, by `deviation_deg` and `length_mm`, or of a picture of heights.

    Attributes:
        file: Grey heights, stretched over the map. The sidecar has its name alone.
        sha256: Checksum of the file, written into the sidecar.
        depth_um: Height of the file's white over its black, µm.
        deviation_deg: Standard deviation of the surface's tilt along u, and along v; 0: no bumps.
        length_mm: Correlation length of the heights, at which their correlation is 1/e, mm.
        seed: Of the random ones.
    """

    kind: Literal["bumps"]
    file: Annotated[str | None, Field(min_length=1)] = None
    sha256: str | None = None
    depth_um: Annotated[float | None, Field(gt=0, validate_default=True)] = None
    deviation_deg: Annotated[float | None, Field(ge=0, le=10, validate_default=True)] = None
    length_mm: Annotated[float | None, Field(gt=0, validate_default=True)] = None
    seed: Annotated[int | None, Field(ge=0, validate_default=True)] = None

    @field_validator("depth_um")
    @classmethod
    def _of_a_file(cls, value: float | None, info: ValidationInfo) -> float | None:
        has_file = info.data.get("file") is not None
        if has_file and value is None:
            raise ValueError("a number, white over black in um, since there is a file")
        if not has_file and value is not None:
            raise ValueError("no such field where there is no file")
        return value

    @field_validator("deviation_deg")
    @classmethod
    def _without_a_file(cls, value: float | None, info: ValidationInfo) -> float | None:
        has_file = info.data.get("file") is not None
        if has_file and value is not None:
            raise ValueError("no such field where there is a file")
        if not has_file and value is None:
            raise ValueError("a number of degrees, or a file of heights instead")
        return value

    @field_validator("length_mm", "seed")
    @classmethod
    def _of_random_ones(cls, value: float | None, info: ValidationInfo) -> float | None:
        if not info.data.get("deviation_deg"):
            if value is not None:
                raise ValueError("no such field without a deviation_deg above 0")
            return None
        if value is None and info.field_name == "length_mm":
            raise ValueError("a number, the bumps' correlation length in mm")
        return 1 if value is None else value


Edit: TypeAlias = (
    PeriodEdit
    | MaskEdit
    | CropEdit
    | RepeatEdit
    | RotateEdit
    | RescaleEdit
    | OffsetEdit
    | BumpsEdit
)
_EDIT: TypeAdapter[Edit] = TypeAdapter(Annotated[Edit, Field(discriminator="kind")])


def parsed(line: str) -> Edit:
    """An edit from its line.

    Raises:
        InputError: It has no or an unknown kind, or a field is unknown, missing or out of range.

    >>> parsed("rotate degrees=90")
    RotateEdit(kind='rotate', degrees=90.0)
    """
    name = f'edit "{line}"'
    try:
        words = shlex.split(line)
    except ValueError as failure:
        raise InputError(name, "quotes", line, str(failure)) from failure
    contents: dict[str, Any] = {}
    if words and "=" not in words[0]:
        contents["kind"] = words.pop(0)
    for word in words:
        field, equals, value = word.partition("=")
        if not (field and equals) or field in contents:
            raise InputError(name, "fields", word, "FIELD=VALUE, each field once")
        contents[field] = value
    try:
        return _EDIT.validate_python(contents)
    except ValidationError as failure:
        raise first_failure(name, failure, contents) from failure
