"""Something of each point of a sample, drawn."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray


def map_figure(
    values: NDArray[np.floating] | NDArray[np.bool_],
    extent: tuple[float, float, float, float],
    label: str,
    colours: str,
    limits: tuple[float, float] | None,
) -> Figure:
    """A picture with a scale beside it.

    Args:
        values: Shape (rows, columns), or (rows, columns, 3) for colours themselves.
        extent: Left, right, bottom and top, mm.
        label: Of the scale.
        colours: Name of matplotlib's colour map.
        limits: Of the scale, numbers as the values are; those of the values if None.
    """
    figure = Figure((7, 6), layout="constrained")
    axes = figure.subplots()
    low, high = limits or (None, None)
    image = axes.imshow(values, extent=extent, cmap=colours, vmin=low, vmax=high)
    figure.colorbar(image, ax=axes, label=label)
    axes.set(xlabel="mm", ylabel="mm")
    return figure
