"""The recipe of a height field: where the relief comes from and how it is prepared.

Lengths are in µm, angles in radians.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, TypeAlias

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PositiveInt,
    ValidationInfo,
    field_validator,
)

from precompute.spectra import Metal

MethodName = Literal["taylor", "jacobi-anger", "baked"]
Length = Annotated[float, Field(ge=1e-4, le=1e4)]
"""µm: from an ångström to a centimetre."""

Seed = Annotated[int, Field(ge=0)]
Level: TypeAlias = Literal["none", "mean", "plane"] | Annotated[int, Field(ge=2, le=5)]


def _one_complaint_about_the_level(value: Any) -> Any:
    # Of a union pydantic would complain about each member, in a field's path of its own.
    order = isinstance(value, int) and not isinstance(value, bool) and 2 <= value <= 5
    if value not in (None, "none", "mean", "plane") and not order:
        raise ValueError("none, mean, plane, the order of a polynomial, 2 to 5, or null")
    return value


def _pair(value: Any) -> Any:
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return (value, value) if number else value


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Bumps(_Part):
    """One smooth bump in each cell, h = height·cos²(πx/size_x)·cos²(πy/size_y) about its middle.

    Attributes:
        height: Of the bump, µm.
        size: Of its foot along x and y, µm.
        cell: Distance to the next bump along x and y, µm: the patch.
    """

    kind: Literal["bumps"] = "bumps"
    height: Length = 0.15
    size: tuple[Length, Length] = (1.0, 0.5)
    cell: tuple[Length, Length] = (2.5, 2.5)

    @field_validator("cell")
    @classmethod
    def _holds_the_bump(cls, value: tuple[float, float], info: ValidationInfo) -> Any:
        size = info.data.get("size", value)
        if value[0] < size[0] or value[1] < size[1]:
            raise ValueError(f"a cell no smaller than the bump's size, {size}")
        return value


class Blazed(_Part):
    """A sawtooth that rises along +x and falls back over an edge, both straight.

    Attributes:
        height: From valley to ridge, µm.
        period: Along x, µm. The patch is a square of this side.
        edge: Width of the falling flank, µm; a step could not be sampled.
    """

    kind: Literal["blazed"] = "blazed"
    height: Length = 0.25
    period: Length = 2.5
    edge: Length = 0.1

    @field_validator("edge")
    @classmethod
    def _fits_the_period(cls, value: float, info: ValidationInfo) -> float:
        period = info.data.get("period")
        if period is not None and value >= period:
            raise ValueError(f"less than the period, {period} um")
        return value


class Cosine(_Part):
    """h = height·(1 + cos 2πx/period)/2.

    Attributes:
        height: From valley to ridge, µm.
        period: Along x, µm. The patch is a square of this side.
    """

    kind: Literal["cosine"] = "cosine"
    height: Length = 0.15
    period: Length = 2.5


class Pits(_Part):
    """Tracks of pits along y, as on a compact disc; its spiral is straight over so small a patch.

    Pits and the lands between them are whole numbers of channel bits long, with the shares that
    let runs of such lengths carry the most information.

    Attributes:
        depth: Of a pit, µm.
        track_pitch: Distance between tracks, µm.
        width: Of a pit at half its depth, µm.
        channel_bit: Length of a channel bit along the track, µm.
        runs: Shortest and longest run of a pit or a land, channel bits.
        tracks: How many the patch holds.
        bits: Length of the patch along the tracks, channel bits.
        edge: Width of a pit's flank, from top to bottom, µm; a step could not be sampled.
        seed: Of the random runs.
    """

    kind: Literal["pits"] = "pits"
    depth: Length = 0.11
    track_pitch: Length = 1.6
    width: Length = 0.5
    channel_bit: Length = 0.278
    runs: tuple[Annotated[int, Field(ge=1, le=31)], Annotated[int, Field(ge=2, le=32)]] = (3, 11)
    tracks: Annotated[int, Field(ge=1, le=256)] = 8
    bits: Annotated[int, Field(ge=8, le=4096)] = 48
    edge: Length = 0.1
    seed: Seed = 1

    @field_validator("runs")
    @classmethod
    def _rise(cls, value: tuple[int, int]) -> tuple[int, int]:
        if value[0] >= value[1]:
            raise ValueError("a shortest run that is shorter than the longest")
        return value

    @field_validator("bits")
    @classmethod
    def _hold_runs(cls, value: int, info: ValidationInfo) -> int:
        longest = info.data.get("runs", (0, 0))[1]
        if value < 4 * longest:
            raise ValueError(f"four of the longest runs or more, {4 * longest} channel bits")
        return value

    @field_validator("edge")
    @classmethod
    def _leaves_room(cls, value: float, info: ValidationInfo) -> float:
        found = info.data
        if {"track_pitch", "width", "channel_bit", "runs"} <= found.keys():
            width, shortest = found["width"], found["runs"][0] * found["channel_bit"]
            room = min(width, shortest, found["track_pitch"] - width)
            if value > room:
                raise ValueError(f"no wider than pits and the lands around them, {room:.4g} um")
        return value


class Fingers(_Part):
    """Columns of rounded ridges that point along +x, as on scales of iridescent snakes.

    Attributes:
        height: Of a ridge, on average, µm.
        length: Distance between columns, µm; a ridge is a little longer.
        spacing: Distance between the ridges of a column, µm.
        columns: How many the patch holds.
        rows: Ridges in a column.
        jitter: How far the tips and the middles of ridges are strewn, as a share of length and of
            spacing.
        seed: Of the jitter.
    """

    kind: Literal["fingers"] = "fingers"
    height: Length = 0.2
    length: Length = 2.2
    spacing: Length = 0.8
    columns: Annotated[int, Field(ge=3, le=128)] = 6
    rows: Annotated[int, Field(ge=3, le=256)] = 17
    jitter: Annotated[float, Field(ge=0, le=0.5)] = 0.12
    seed: Seed = 1

    @field_validator("spacing")
    @classmethod
    def _no_wider_than_long(cls, value: float, info: ValidationInfo) -> float:
        length = info.data.get("length")
        if length is not None and value > length:
            raise ValueError(f"no more than the length, {length} um")
        return value


class Roughness(_Part):
    """A Gaussian random surface whose correlation is exp(−r²/correlation²).

    Attributes:
        rms: Root mean square of the height, µm; the patch has exactly that.
        correlation: Correlation length, µm.
        period: Side of the square patch, µm; eight correlation lengths or more.
        seed: Of the random phases and amplitudes.
    """

    kind: Literal["roughness"] = "roughness"
    rms: Length = 0.05
    correlation: Length = 0.8
    period: Length = 12.8
    seed: Seed = 1

    @field_validator("period")
    @classmethod
    def _holds_the_correlation(cls, value: float, info: ValidationInfo) -> float:
        correlation = info.data.get("correlation")
        if correlation is not None and value < 8 * correlation:
            raise ValueError(f"eight correlation lengths or more, {8 * correlation:.4g} um")
        return value


class FileSource(_Part):
    """A measured or drawn patch.

    Attributes:
        path: The file, beside the recipe (`precompute.height_fields.read.read_height_field`).
        pitch_um: Distance between its samples, µm, or a pair along x and y; ``null`` where the
            file has a scale of its own.
        height_um: Height of full white over black, or of the number 1 in a file of numbers, µm;
            likewise.
        channel: Which channel of an instrument's file; ``null`` for its first heights.
        whole_periods: The patch is known to hold whole periods, perhaps only one: it is not asked
            for two, and not levelled unless that is asked for.
    """

    kind: Literal["file"]
    path: Annotated[str, Field(min_length=1)]
    pitch_um: Annotated[tuple[Length, Length] | None, BeforeValidator(_pair)] = None
    height_um: Length | None = None
    channel: str | None = None
    whole_periods: bool = False


Generated: TypeAlias = Bumps | Blazed | Cosine | Pits | Fingers | Roughness
Source: TypeAlias = Annotated[Generated | FileSource, Field(discriminator="kind")]


class Crop(_Part):
    """A rectangle of the patch.

    Attributes:
        x: Of its lower left corner from that of the patch, µm.
        y: Likewise, µm.
        width: µm.
        height: µm.
    """

    x: Annotated[float, Field(ge=0)]
    y: Annotated[float, Field(ge=0)]
    width: Length
    height: Length


class HeightFieldRecipe(_Part):
    """A patch of relief, prepared to repeat, and the tables that are baked from it.

    Generated fields repeat as they are: `level`, `outlier_rows` and `crop` are for files alone.

    Attributes:
        source: Where the relief comes from.
        level: What is taken off the heights of a file: nothing, their mean, the plane or the
            polynomial of this order that fits them best; ``null`` for the plane, or for nothing
            where the file holds whole periods.
        outlier_rows: Replace scan lines that depart from their neighbours.
        crop: What part of the file's patch is kept; ``null`` for all of it.
        tiling: ``periodic``, the patch repeats as it is, or ``mirrored``, the patch and its
            reflections, twice as large along both axes, repeat without a seam.
        pitch: Largest distance between samples, µm; ``null`` for the source's own, or where a
            file is far finer than theory asks, half of what it asks.
        methods: What is baked.
        terms: How many terms of a series; ``null`` for as many as `error` asks for.
        error: Largest relative error of exp(ikwh).
        roughness: Standard deviation of the normal's tilt, rad; this and the rest for ``baked``.
        angular_radius: Standard deviation of the light's disc, rad.
        coherence: σ of the Gaussian coherence window exp(−r²/2σ²), µm.
        tiles: How many patches the window is cut to along x and y; one number stands for both.
            ``null``: the patch repeats for ever.
        metal: The metal, which gives R(λ); ``null`` for R = 1.
        illuminant: Name or CSV path of the light's spectrum.
    """

    kind: Literal["height-field"]
    source: Source
    level: Annotated[Level | None, BeforeValidator(_one_complaint_about_the_level)] = None
    outlier_rows: bool = False
    crop: Crop | None = None
    tiling: Literal["periodic", "mirrored"] = "periodic"
    pitch: Length | None = None
    methods: Annotated[tuple[MethodName, ...], Field(min_length=1)] = ("jacobi-anger",)
    terms: Annotated[int, Field(ge=1, le=256)] | None = None
    error: Annotated[float, Field(gt=0, le=0.5)] = 1e-3
    roughness: Annotated[float, Field(ge=0, le=0.5)] = 0.0
    angular_radius: Annotated[float, Field(ge=0, le=0.5)] = 0.0
    coherence: Length = 16.25
    tiles: Annotated[tuple[PositiveInt, PositiveInt] | None, BeforeValidator(_pair)] = None
    metal: Metal | None = "aluminium"
    illuminant: str = "D65"

    @field_validator("level", "outlier_rows", "crop")
    @classmethod
    def _for_files_alone(cls, value: Any, info: ValidationInfo) -> Any:
        source = info.data.get("source")
        asked = value not in (None, False, "none")
        if asked and source is not None and not isinstance(source, FileSource):
            raise ValueError(f"no such field where the field is generated ({source.kind})")
        return value

    @field_validator("methods")
    @classmethod
    def _each_once(cls, value: tuple[MethodName, ...]) -> tuple[MethodName, ...]:
        if len(set(value)) < len(value):
            raise ValueError("each method once")
        return value
