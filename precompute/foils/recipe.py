"""The recipes of foils."""

from __future__ import annotations

from typing import Annotated, Any, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, ValidationInfo, field_validator

from precompute.foils.figure_recipes import AnyFigure
from precompute.gratings import Positive

Share = Annotated[float, Field(ge=0, lt=0.1)]
PeriodRange: TypeAlias = tuple[Positive, Positive]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class FoilRecipe(_Part):
    """What all designs have in common.

    Attributes:
        size: Texels along each side of the tile.
        tile_mm: Its side, mm.
        height: Of all gratings, µm.
        profile: Name of a baked profile.
        seed: Of the random arrangement.
    """

    kind: Literal["foil"]
    size: Annotated[int, Field(ge=16, le=4096)] = 256
    tile_mm: Positive = 25.0
    height: Positive = 0.15
    profile: str = "sinusoidal"
    seed: Annotated[int, Field(ge=0)] = 1


class DrawnFoilRecipe(FoilRecipe):
    """A repeating tile of pieces, each a grating of its own.

    Attributes:
        orientations: How many different ones, at equal steps over 180°.
        period_range: Shortest and longest period, µm, between which they vary; ``null`` for the
            periods listed.
        variation: How periods fill their range: ``pieces``, each piece has one of its own, at
            equal steps; ``smooth``, they rise and fall once along either side of the tile.
        periods: The gratings' periods, µm, equally often; 1.66 where no range is stated.
        border: How far pieces end from where they would meet, as a share of the tile's side: an
            undiffracting seam of twice that width lies between them.
    """

    orientations: Annotated[int, Field(ge=1, le=256)] = 12
    period_range: PeriodRange | None = None
    variation: Literal["pieces", "smooth"] = "pieces"
    periods: Annotated[tuple[Positive, ...] | None, Field(min_length=1, validate_default=True)] = (
        None
    )
    border: Share = 0.004

    @field_validator("period_range")
    @classmethod
    def _rises(cls, value: PeriodRange | None) -> PeriodRange | None:
        if value is not None and value[0] >= value[1]:
            raise ValueError("a shortest period that is below the longest")
        return value

    @field_validator("variation")
    @classmethod
    def _varies_a_range(cls, value: str, info: ValidationInfo) -> str:
        if value == "smooth" and info.data.get("period_range", ()) is None:
            raise ValueError("pieces, no period_range being stated")
        return value

    @field_validator("periods")
    @classmethod
    def _listed_or_a_range(cls, value: Any, info: ValidationInfo) -> Any:
        if info.data.get("period_range", ()) is None:
            return value or (1.66,)
        if value is not None:
            raise ValueError("no such field where period_range is stated")
        return value


class PolygonsFoilRecipe(DrawnFoilRecipe):
    """Polygons, the cells of points scattered over the tile.

    Attributes:
        polygons: How many.
    """

    design: Literal["polygons"]
    polygons: Annotated[int, Field(ge=2, le=4096)] = 48


class StarsFoilRecipe(DrawnFoilRecipe):
    """Faceted stars scattered over the tile, and the ground between them.

    From its middle each star is parted along the lines to its points and to the notches between
    them, so that a point has two facets, each a grating of its own.

    Attributes:
        stars: How many.
        points: Of each star.
        notch: Ratio of the radius of the notches to that of the points.
        ground: Whether the ground diffracts, one grating around each star; bare else.
    """

    design: Literal["stars"]
    border: Share = 0.002
    stars: Annotated[int, Field(ge=2, le=1024)] = 12
    points: Annotated[int, Field(ge=3, le=32)] = 5
    notch: Annotated[float, Field(ge=0.05, le=0.95)] = 0.45
    ground: bool = True


class CirclesFoilRecipe(DrawnFoilRecipe):
    """Discs of concentric rings scattered over the tile, and the ground between them.

    From ring to ring, and on to the ground, the orientation turns by an equal step.

    Attributes:
        circles: How many discs.
        rings: Of each disc, all equally wide, each a grating of its own.
        ground: Whether the ground diffracts, one grating around each disc; bare else.
    """

    design: Literal["circles"]
    border: Share = 0.002
    circles: Annotated[int, Field(ge=2, le=1024)] = 16
    rings: Annotated[int, Field(ge=1, le=64)] = 4
    ground: bool = True


class DiscFoilRecipe(FoilRecipe):
    """One disc of concentric tracks, as on a compact disc: the grating vector is the radius.

    Attributes:
        period: Distance of the tracks, µm.
        inner_mm: Radius of the first.
        outer_mm: Radius of the last; half the tile if left out.
    """

    design: Literal["disc"]
    period: Positive = 1.6
    inner_mm: Annotated[float, Field(ge=0)] = 0.0
    outer_mm: Annotated[float | None, Field(validate_default=True)] = None

    @field_validator("outer_mm")
    @classmethod
    def _has_tracks(cls, value: float | None, info: ValidationInfo) -> float | None:
        if {"tile_mm", "inner_mm"} <= info.data.keys():
            inner, half = info.data["inner_mm"], info.data["tile_mm"] / 2
            if not inner < (half if value is None else value) <= half:
                raise ValueError(f"above inner_mm, {inner:g}, and up to half the tile, {half:g} mm")
        return value


class SpiralDistribution(_Part):
    """Periods that grow with orientation over the half turn, about Gaussian in the period.

    Under one wavelength a lobe lies in its grating's direction at the distance λ/a from the
    highlight: all of them draw a spiral.

    Attributes:
        shortest: Period at orientation 0, µm.
        longest: Period towards orientation 180°, µm.
        spread: Ratio of the standard deviation of the period to the period.
    """

    kind: Literal["spiral"]
    shortest: Positive = 1.2
    longest: Positive = 2.4
    spread: Annotated[float, Field(ge=0.001, le=0.2)] = 0.02

    @field_validator("longest")
    @classmethod
    def _is_longer(cls, value: float, info: ValidationInfo) -> float:
        shortest = info.data.get("shortest")
        if shortest is not None and value <= shortest:
            raise ValueError(f"above the shortest, {shortest} um")
        return value


class FileDistribution(_Part):
    """A distribution that was measured (`precompute.foils.distribution`).

    Attributes:
        file: Its JSON file, beside the recipe.
    """

    kind: Literal["file"]
    file: Annotated[str, Field(min_length=1)]


Shape: TypeAlias = Literal["discs", "squares", "polygons", "mask"]


class StochasticFoilRecipe(FoilRecipe):
    """A texture of shapes whose gratings are drawn from a distribution.

    Attributes:
        distribution: The joint distribution of orientation and period.
        shape: ``discs`` and upright ``squares`` are strewn over one another, and so is the figure
            of a ``mask``; ``polygons`` are the cells of strewn points.
        mask: A PNG beside the recipe, whose light and opaque half is the figure.
        shape_mm: Diameter of the discs, side of the squares, longer side of the mask, mean
            distance of the polygons' points, mm.
        cover: How many times over the shapes would cover the tile side by side; strewn, they
            leave the share exp(−cover) bare. For polygons, which cover it once, ``null``.
    """

    design: Literal["stochastic"]
    size: Annotated[int, Field(ge=16, le=4096)] = 512
    distribution: Annotated[SpiralDistribution | FileDistribution, Field(discriminator="kind")]
    shape: Shape = "squares"
    mask: Annotated[str | None, Field(min_length=1, validate_default=True)] = None
    shape_mm: Annotated[float, Field(validate_default=True)] = 0.4
    cover: Annotated[float | None, Field(gt=0, le=20, validate_default=True)] = None

    @field_validator("mask")
    @classmethod
    def _of_a_mask(cls, value: str | None, info: ValidationInfo) -> str | None:
        shape = info.data.get("shape")
        if shape == "mask" and value is None:
            raise ValueError("a PNG file, the shape being mask")
        if shape not in (None, "mask") and value is not None:
            raise ValueError(f"no such field where the shape is {shape}")
        return value

    @field_validator("shape_mm")
    @classmethod
    def _fits_the_tile(cls, value: float, info: ValidationInfo) -> float:
        if {"size", "tile_mm"} <= info.data.keys():
            tile = info.data["tile_mm"]
            shortest = 2 * tile / info.data["size"]
            if not shortest <= value <= tile / 2:
                raise ValueError(
                    f"two texels to half the tile, {shortest:.4g} to {tile / 2:.4g} mm"
                )
        return value

    @field_validator("cover")
    @classmethod
    def _of_what_is_strewn(cls, value: float | None, info: ValidationInfo) -> float | None:
        if info.data.get("shape") != "polygons":
            return value or 5.0
        if value is not None:
            raise ValueError("no such field where the shape is polygons")
        return value


class FiguresFoilRecipe(FoilRecipe):
    """Figures painted over one another.

    Attributes:
        figures: The first is the lowest (`precompute.foils.figure_recipes`); their places are in
            mm from the middle of the tile, x to the right, y upwards.
    """

    design: Literal["figures"]
    size: Annotated[int, Field(ge=16, le=4096)] = 512
    figures: Annotated[tuple[AnyFigure, ...], Field(min_length=1)]


AnyFoilRecipe: TypeAlias = Annotated[
    PolygonsFoilRecipe
    | StarsFoilRecipe
    | CirclesFoilRecipe
    | DiscFoilRecipe
    | FiguresFoilRecipe
    | StochasticFoilRecipe,
    Field(discriminator="design"),
]
