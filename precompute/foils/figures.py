"""The foil of figures that are painted over one another."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from precompute.foils.copies import Frame, copies
from precompute.foils.distances import bounding_disc, signed_distance
from precompute.foils.figure_recipes import AnyFigure, Figure, FigureGroup
from precompute.foils.foil_map import foil_map
from precompute.foils.recipe import FiguresFoilRecipe
from precompute.foils.variation import values_at
from precompute.maps import Map

Array = NDArray[np.float64]


def figures_foil(recipe: FiguresFoilRecipe) -> Map:
    """A tile of figures; what goes over an edge of it goes on at the opposite one.

    Raises:
        InputError: Nothing diffracts.
    """
    painting = _Painting(recipe.size, recipe.tile_mm)
    rng = np.random.default_rng(recipe.seed)
    for figure in recipe.figures:
        _paint(painting, figure, Frame(), rng)
    return foil_map(
        painting.orientation,
        painting.frequency,
        painting.strength,
        height=recipe.height,
        tile_mm=recipe.tile_mm,
        recipe=recipe.model_dump(),
    )


def _paint(painting: _Painting, figure: AnyFigure, frame: Frame, rng: np.random.Generator) -> None:
    for copy in copies(figure.at, painting.tile_mm, rng):
        inner = frame.holding(copy)
        if isinstance(figure, FigureGroup):
            for part in figure.figures:
                _paint(painting, part, inner, rng)
        else:
            painting.add(figure, inner)


class _Painting:
    """The gratings of a tile so far.

    Attributes:
        tile_mm: Its side; its middle is the origin.
        orientation: θ of each texel, rad, shape (size, size), the first row being the top.
        frequency: 1/a, 1/µm; 0 where nothing has been painted.
        strength: Share of the texel that its grating covers.
    """

    def __init__(self, size: int, tile_mm: float) -> None:
        self.tile_mm = tile_mm
        self.orientation, self.frequency, self.strength = np.zeros((3, size, size))

    def add(self, figure: Figure, frame: Frame) -> None:
        """Paint one copy of a figure, wherever the repeating tile shows it."""
        x, y, radius = bounding_disc(figure)
        x, y = frame.point(x, y)
        reach = radius * frame.scale
        for across, up in itertools.product(self._spans(x, reach), self._spans(y, reach)):
            self._add(figure, frame, across, up)

    def _spans(self, middle: float, reach: float) -> list[NDArray[np.intp]]:
        """Texels along an axis within reach of a place, parted so that none recurs in a part."""
        size = len(self.strength)
        first, last = np.array([middle - reach, middle + reach]) / self._texel + size / 2
        texels = np.arange(np.floor(first) - 1, np.ceil(last) + 1).astype(np.intp)
        return np.split(texels, range(size, texels.size, size))

    @property
    def _texel(self) -> float:
        return self.tile_mm / len(self.strength)

    def _add(
        self, figure: Figure, frame: Frame, across: NDArray[np.intp], up: NDArray[np.intp]
    ) -> None:
        size = len(self.strength)
        columns, rows = np.meshgrid(across.astype(float), up.astype(float))
        middle = (size - 1) / 2
        x, y = frame.within(self._texel * (columns - middle), self._texel * (rows - middle))
        distance = signed_distance(figure, x, y) * frame.scale
        here = np.ix_(size - 1 - up % size, across % size)
        # A texel has the grating that covers most of it, and as much strength as that covers.
        beneath = self.strength[here] * (1 - self._covered(distance))
        self.strength[here] = beneath
        if figure.orientation is None:
            return
        covered = self._covered(distance + figure.seam_mm)
        seen = covered > beneath
        θ = np.deg2rad(values_at(figure.orientation, x, y)) + frame.turn
        for channel, values in (
            (self.orientation, θ),
            (self.frequency, 1 / values_at(figure.period, x, y)),
            (self.strength, covered),
        ):
            channel[here] = np.where(seen, values, channel[here])

    def _covered(self, distance: Array) -> Array:
        """Share of a texel that lies inside an edge at this distance from its middle, mm."""
        return np.clip(0.5 - distance / self._texel, 0, 1)
