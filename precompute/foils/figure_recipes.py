"""The recipes of figures: what they look like, where their copies go, how gratings vary in them.

A figure has a frame of its own, x and y in mm from its origin, which is turned and scaled with
each copy. Its gratings' orientations turn as well; periods and seams stay what they are.
"""

from __future__ import annotations

from typing import Annotated, Any, Generic, Literal, TypeAlias, TypeVar

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationInfo, field_validator

from precompute.gratings import Positive

Count = Annotated[int, Field(ge=1, le=4096)]
NotNegative = Annotated[float, Field(ge=0)]
Point: TypeAlias = tuple[float, float]
Over: TypeAlias = Literal["x", "y", "radius"]
Value = TypeVar("Value", bound=float)


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Constant(_Part, Generic[Value]):
    """One value everywhere; in a recipe the number alone stands for it."""

    kind: Literal["constant"]
    value: Value


class Bands(_Part, Generic[Value]):
    """Values by turns, in equally wide bands along an axis, or in rings.

    Attributes:
        over: Along what they follow one another.
        width_mm: Of each; the first begins at the origin.
        values: Of a band and those after it, then from the first on.
    """

    kind: Literal["bands"]
    over: Over = "radius"
    width_mm: Positive
    values: Annotated[tuple[Value, ...], Field(min_length=1)]


class Ramp(_Part, Generic[Value]):
    """From one value to the next at a steady rate, and constant beyond both ends.

    Attributes:
        over: Along what.
        from_mm: Where it has the first of the values.
        to_mm: Where it has the last, above ``from_mm``; those between lie at equal steps.
        values: Two or more.
    """

    kind: Literal["ramp"]
    over: Over = "radius"
    from_mm: float = 0.0
    to_mm: float
    values: Annotated[tuple[Value, ...], Field(min_length=2)]

    @field_validator("to_mm")
    @classmethod
    def _lies_beyond(cls, value: float, info: ValidationInfo) -> float:
        first = info.data.get("from_mm")
        if first is not None and value <= first:
            raise ValueError(f"above from_mm, {first:g}")
        return value


class Around(_Part):
    """Orientations that turn steadily around the origin.

    Attributes:
        half_turns: By how many, counter-clockwise, once around: under a light there are as many
            spokes. 2 from 0° has grating vectors along the radius.
        start_deg: Where the direction from the origin is +x.
        twist_deg: More for each mm from the origin, which bends the spokes.
    """

    kind: Literal["around"]
    half_turns: Annotated[int, Field(ge=-360, le=360)]
    start_deg: float = 0.0
    twist_deg: float = 0.0


def _number_is_constant(value: Any) -> Any:
    return {"kind": "constant", "value": value} if isinstance(value, int | float) else value


Orientation: TypeAlias = Annotated[
    Constant[float] | Bands[float] | Ramp[float] | Around,
    Field(discriminator="kind"),
    BeforeValidator(_number_is_constant),
]
Period: TypeAlias = Annotated[
    Constant[Positive] | Bands[Positive] | Ramp[Positive],
    Field(discriminator="kind"),
    BeforeValidator(_number_is_constant),
]


class Place(_Part):
    """Where a copy's origin lies.

    Attributes:
        x_mm: To the right of the tile's middle, or of the group's origin.
        y_mm: Upwards.
        turn_deg: Of the copy, counter-clockwise.
        scale: Factor of its lengths.
    """

    x_mm: float = 0.0
    y_mm: float = 0.0
    turn_deg: float = 0.0
    scale: Positive = 1.0


class Points(_Part):
    """Copies at places that are listed."""

    kind: Literal["points"] = "points"
    points: Annotated[tuple[Place, ...], Field(min_length=1)] = (Place(),)


class Row(_Part):
    """Copies in a straight row about the origin.

    Attributes:
        count: How many.
        step_mm: From one to the next, (x, y).
    """

    kind: Literal["row"]
    count: Count
    step_mm: Point


class _Scaled(_Part):
    scale: tuple[Positive, Positive] = (1.0, 1.0)

    @field_validator("scale")
    @classmethod
    def _rises(cls, value: tuple[float, float]) -> tuple[float, float]:
        if value[0] > value[1]:
            raise ValueError("a smallest scale up to the largest")
        return value


class Ring(_Scaled):
    """Copies at equal steps around the origin, each turned so that its +x points away from it.

    Attributes:
        count: How many.
        radius_mm: Distance of their origins.
        start_deg: Direction of the first.
        scale: Smallest and largest of the copies, at equal steps, shuffled.
    """

    kind: Literal["ring"]
    count: Count
    radius_mm: NotNegative = 0.0
    start_deg: float = 0.0


class Strewn(_Scaled):
    """Copies at random over a whole tile, turned at random, clear of one another where they can be.

    Attributes:
        count: How many.
        radius_mm: What is kept clear about each, times its scale.
        scale: Smallest and largest of the copies, at equal steps, the smallest painted last.
    """

    kind: Literal["strewn"]
    count: Count
    radius_mm: Positive


At: TypeAlias = Annotated[Points | Row | Ring | Strewn, Field(discriminator="kind")]


class _Copied(_Part):
    at: At = Points()


class _Figure(_Copied):
    """What all figures but groups have in common.

    Attributes:
        orientation: θ, deg; ``null`` for a figure that leaves bare what lies beneath.
        period: µm.
        seam_mm: Width of a rim within the edge that is bare.
        at: Where its copies go.
    """

    orientation: Orientation | None = Constant[float](kind="constant", value=0.0)
    period: Period = Constant[Positive](kind="constant", value=1.66)
    seam_mm: NotNegative = 0.0


class Disc(_Figure):
    """A disc, or a ring.

    Attributes:
        radius_mm: Of its rim.
        inner_mm: Of the hole.
    """

    kind: Literal["disc"]
    radius_mm: Positive
    inner_mm: Annotated[float, Field(ge=0)] = 0.0

    @field_validator("inner_mm")
    @classmethod
    def _leaves_something(cls, value: float, info: ValidationInfo) -> float:
        radius = info.data.get("radius_mm")
        if radius is not None and value >= radius:
            raise ValueError(f"below radius_mm, {radius:g}")
        return value


class Rectangle(_Figure):
    """An upright rectangle about the origin."""

    kind: Literal["rectangle"]
    width_mm: Positive
    height_mm: Positive


class Polygon(_Figure):
    """A polygon whose sides do not cross.

    Attributes:
        corners_mm: (x, y) of each, in either sense.
    """

    kind: Literal["polygon"]
    corners_mm: Annotated[tuple[Point, ...], Field(min_length=3)]

    @field_validator("corners_mm")
    @classmethod
    def _has_an_inside(cls, value: tuple[Point, ...]) -> tuple[Point, ...]:
        following = value[1:] + value[:1]
        if sum(x * b - a * y for (x, y), (a, b) in zip(value, following, strict=True)) == 0:
            raise ValueError("corners that are not in one line")
        return value


class Star(_Figure):
    """A star, its first point on +x.

    Attributes:
        points: How many.
        radius_mm: Of the points.
        notch: Ratio of the radius of the notches to that of the points; cos(π/points) makes it a
            regular polygon.
    """

    kind: Literal["star"]
    points: Annotated[int, Field(ge=3, le=64)]
    radius_mm: Positive
    notch: Annotated[float, Field(ge=0.05, le=0.99)] = 0.45


class Stroke(_Figure):
    """A stroke along +x with round ends: all between two discs.

    Attributes:
        from_mm: x of the first disc's middle.
        to_mm: Of the second's, further by more than their radii differ.
        width_mm: Diameters of both.
    """

    kind: Literal["stroke"]
    width_mm: tuple[Positive, Positive]
    from_mm: float = 0.0
    to_mm: float

    @field_validator("to_mm")
    @classmethod
    def _has_a_length(cls, value: float, info: ValidationInfo) -> float:
        if {"from_mm", "width_mm"} <= info.data.keys():
            first, last = info.data["width_mm"]
            least = info.data["from_mm"] + abs(first - last) / 2
            if value <= least:
                raise ValueError(f"above {least:g}, where one end holds the other")
        return value


class Rosette(_Figure):
    """A line that waves around the origin at the distance radius + amplitude·cos(lobes·φ).

    Attributes:
        radius_mm: Its mean distance.
        amplitude_mm: Of the waves, below ``radius_mm``.
        lobes: How many waves.
        width_mm: Of the line; ``null`` for all that it encloses.
    """

    kind: Literal["rosette"]
    radius_mm: Positive
    amplitude_mm: Positive
    lobes: Annotated[int, Field(ge=1, le=360)]
    width_mm: Positive | None = None

    @field_validator("amplitude_mm")
    @classmethod
    def _keeps_off_the_origin(cls, value: float, info: ValidationInfo) -> float:
        radius = info.data.get("radius_mm")
        if radius is not None and value >= radius:
            raise ValueError(f"below radius_mm, {radius:g}")
        return value


class FigureGroup(_Copied):
    """Figures that are copied together.

    Attributes:
        figures: Painted over one another; their places are in the group's frame.
        at: Where its copies go.
    """

    kind: Literal["group"]
    figures: Annotated[tuple[AnyFigure, ...], Field(min_length=1)]


Figure: TypeAlias = Disc | Rectangle | Polygon | Star | Stroke | Rosette
AnyFigure: TypeAlias = Annotated[Figure | FigureGroup, Field(discriminator="kind")]
FigureGroup.model_rebuild()
