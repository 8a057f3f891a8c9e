"""Pictures of the steps from photographs through a polariser to a map."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from matplotlib.colors import hsv_to_rgb
from matplotlib.figure import Figure
from numpy.typing import NDArray

from precompute.acquisition.map_figure import map_figure
from precompute.acquisition.phase_circle import modulations
from precompute.acquisition.polarization import Polarized, confidences
from precompute.files import written_aside
from precompute.progress import tracked

Array = NDArray[np.float64]

LONGEST = 800
"""Points along the longer side of a picture."""

STREWN = 20000
"""Pixels that are shown about the circle, most."""


def write_pictures(acquired: Polarized, folder: Path) -> list[Path]:
    """Draw every step.

    Args:
        acquired: What came of a capture.
        folder: Where; made if missing.

    Returns:
        The files ``mean``, ``correlation``, ``mask``, ``circle``, ``orientation``, ``noise``,
        ``confidence`` and ``period``.
    """
    written = []
    for name, figure in tracked(_figures(acquired), "Drawing", 8):
        file = folder / f"{name}.png"
        with written_aside(file) as aside:
            figure.savefig(aside, format="png", dpi=120)
        written.append(file)
    return written


def _figures(acquired: Polarized) -> Iterator[tuple[str, Figure]]:
    found, fit = acquired.found, acquired.found.fit
    step = max(1, -(-max(found.mask.shape) // LONGEST))
    few = np.s_[::step, ::step]
    width, height = np.broadcast_to(acquired.foil.constants["tile_mm"], 2).tolist()
    extent = (-width / 2, width / 2, -height / 2, height / 2)
    white = float(np.nanpercentile(fit.mean[few], 99))
    yield "mean", map_figure(fit.mean[few], extent, "light over its mean", "gray", (0, white))
    yield "correlation", map_figure(fit.correlation[few], extent, "correlation", "magma", (0, 1))
    yield "mask", map_figure(found.mask[few], extent, "diffracts", "gray", (0, 1))
    yield "circle", _circle(acquired)
    cosine, sine, frequency, _ = np.moveaxis(acquired.foil.tables["grating"].values[few], -1, 0)
    orientation = np.mod(np.arctan2(sine, cosine) / 2, np.pi)
    full = np.ones_like(orientation)
    hsv = np.stack([orientation / np.pi, full, found.mask[few] * full], axis=-1)
    yield "orientation", map_figure(hsv_to_rgb(hsv), extent, "orientation (deg)", "hsv", (0, 180))
    noise = np.where(found.mask[few], np.degrees(found.noise[few]) / 2, np.nan)
    yield (
        "noise",
        map_figure(noise, extent, "orientations' deviation (deg)", "viridis", (0, 5)),
    )
    yield "confidence", map_figure(confidences(found)[few], extent, "confidence", "magma", (0, 1))
    period = np.where(found.mask[few], 1 / frequency, np.nan)
    yield "period", map_figure(period, extent, "period (µm)", "viridis", None)


def _circle(acquired: Polarized) -> Figure:
    """Pixels' modulations about the circle that was fitted to them, those that diffract in red."""
    found, circle = acquired.found, acquired.found.circle
    points, mask = modulations(found.fit).ravel(), found.mask.ravel()
    step = max(1, points.size // STREWN)
    figure = Figure((7, 7), layout="constrained")
    axes = figure.subplots()
    for kind, colour in ((~mask, "grey"), (mask, "firebrick")):
        some = points[::step][kind[::step]] + np.complex64(circle.centre)
        axes.plot(some.real, some.imag, ",", color=colour)
    around = circle.centre + circle.radius * np.exp(1j * np.linspace(0, 2 * np.pi, 200))
    axes.plot(around.real, around.imag, color="black", linewidth=0.8)
    axes.plot(circle.centre.real, circle.centre.imag, "+", color="black")
    reach = 2 * circle.radius
    axes.set(
        xlabel="cos η · A/c",
        ylabel="sin η · A/c",
        xlim=(circle.centre.real - reach, circle.centre.real + reach),
        ylim=(circle.centre.imag - reach, circle.centre.imag + reach),
        aspect="equal",
    )
    return figure
