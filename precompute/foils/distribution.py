"""How often which gratings occur on a foil: a histogram over orientation and spatial frequency.

Theory: Toisoul, Dhillon and Ghosh 2018, section 4.5, where a stochastic foil is drawn from it.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BaseModel, ConfigDict, TypeAdapter

from precompute.errors import InputError
from precompute.files import written_aside
from precompute.recipes import validated

Array = NDArray[np.float64]


class _Contents(BaseModel):
    """What the file holds; edges and weights are as in `GratingDistribution`."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)

    format: Literal["three-diffraction/grating-distribution"]
    version: Literal[1]
    orientation_edges: list[float]
    frequency_edges: list[float]
    weights: list[list[float]]


_CONTENTS = TypeAdapter(_Contents)


@dataclass(frozen=True)
class GratingDistribution:
    """The joint distribution of a foil's orientations and spatial frequencies, by share of area.

    Within a cell all gratings are as likely.

    Attributes:
        orientation_edges: Edges of cells over θ, rad, rising, over π at most.
            Shape (orientations + 1,).
        frequency_edges: Edges of cells over 1/a, 1/µm, above 0, rising. Shape (frequencies + 1,).
        weights: Share of each cell, shape (orientations, frequencies); made to sum to 1.

    Raises:
        InputError: Edges do not rise or leave their range; or weights are of another shape,
            negative, not finite, or all zero.
    """

    orientation_edges: Array
    frequency_edges: Array
    weights: Array

    def __post_init__(self) -> None:
        θ, f = _edges(self, "orientation_edges"), _edges(self, "frequency_edges")
        if θ[-1] - θ[0] > np.pi + 1e-5:  # π may have been typed as 3.1416
            raise _wrong("orientation_edges", float(θ[-1] - θ[0]), "a span of pi at most")
        if f[0] <= 0:
            raise _wrong("frequency_edges", float(f[0]), "above 0 (1/um)")
        weights = np.asarray(self.weights, float)
        expected = (θ.size - 1, f.size - 1)
        if weights.shape != expected:
            raise _wrong("weights", weights.shape, f"the shape {expected}, a cell between edges")
        bad = ~(np.isfinite(weights) & (weights >= 0))
        if bad.any():
            raise _wrong("weights", float(weights[bad][0]), "finite numbers from 0")
        if not weights.any():
            raise _wrong("weights", 0.0, "one above 0 at least")
        # The largest first, so that no sum overflows.
        shares = weights / weights.max()
        for name, value in (
            ("orientation_edges", θ),
            ("frequency_edges", f),
            ("weights", shares / shares.sum()),
        ):
            object.__setattr__(self, name, value)

    @property
    def orientations(self) -> Array:
        """Centres of the cells, rad. Shape (orientations,)."""
        return (self.orientation_edges[1:] + self.orientation_edges[:-1]) / 2

    @property
    def frequencies(self) -> Array:
        """Centres of the cells, 1/µm. Shape (frequencies,)."""
        return (self.frequency_edges[1:] + self.frequency_edges[:-1]) / 2

    def sample(self, rng: np.random.Generator, count: int) -> tuple[Array, Array]:
        """Draw gratings.

        Args:
            rng: Draws.
            count: How many.

        Returns:
            θ in rad, between the outer edges, and 1/a in 1/µm, each of shape (count,).
        """
        cell = rng.choice(self.weights.size, count, p=self.weights.ravel())
        row, column = np.unravel_index(cell, self.weights.shape)
        θ, f = self.orientation_edges, self.frequency_edges
        across, along = rng.random((2, count))
        return (
            θ[row] + (θ[row + 1] - θ[row]) * across,
            f[column] + (f[column + 1] - f[column]) * along,
        )

    def histogram_of(
        self, orientation: ArrayLike, frequency: ArrayLike, weights: ArrayLike = 1.0
    ) -> Array:
        """How gratings share themselves out among this distribution's cells.

        Args:
            orientation: θ, rad, any number standing for itself modulo π.
            frequency: 1/a, 1/µm, of the same shape.
            weights: How much each counts, of that shape or one for all.

        Returns:
            Sum of the weights in each cell over the sum of all: the rest of 1 lies outside. Shape
            (orientations, frequencies).
        """
        θ, f, w = np.broadcast_arrays(orientation, frequency, weights)
        first = self.orientation_edges[0]
        turned = first + np.mod(np.asarray(θ, float) - first, np.pi)
        edges = (self.orientation_edges, self.frequency_edges)
        sums, _, _ = np.histogram2d(turned.ravel(), np.ravel(f), edges, weights=np.ravel(w))
        return sums / np.sum(w)

    def write(self, file: Path) -> None:
        """Write the distribution as JSON; its folder is made if missing."""
        contents = _Contents(
            format="three-diffraction/grating-distribution",
            version=1,
            orientation_edges=self.orientation_edges.tolist(),
            frequency_edges=self.frequency_edges.tolist(),
            weights=self.weights.tolist(),
        )
        with written_aside(file) as aside:
            aside.write_text(json.dumps(contents.model_dump()) + "\n", "utf-8")

    @staticmethod
    def read(file: Path) -> GratingDistribution:
        """Read what `write` wrote.

        Raises:
            InputError: The file is missing, is no JSON, a field is unknown, missing or of another
                type, or its numbers are no distribution.
        """
        contents = validated(file, _CONTENTS)
        try:
            return GratingDistribution(
                np.array(contents.orientation_edges),
                np.array(contents.frequency_edges),
                _rows(contents.weights),
            )
        except InputError as failure:
            raise InputError(file, failure.field, failure.value, failure.expected) from failure


def _edges(distribution: GratingDistribution, field: str) -> Array:
    edges = np.asarray(getattr(distribution, field), float)
    if edges.ndim != 1 or edges.size < 2:
        raise _wrong(field, edges.shape, "two edges or more")
    if not (np.isfinite(edges).all() and (np.diff(edges) > 0).all()):
        raise _wrong(field, edges.tolist(), "finite numbers that rise")
    return edges


def _rows(weights: list[list[float]]) -> Array:
    lengths = {len(row) for row in weights}
    if len(lengths) > 1:
        raise _wrong("weights", sorted(lengths), "rows of one length")
    return np.array(weights)


def _wrong(field: str, value: object, expected: str) -> InputError:
    return InputError("grating distribution", field, value, expected)
