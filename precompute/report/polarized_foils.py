"""Foils acquired from simulated photographs in polarised light, against those photographed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator

from precompute.files import written_aside
from precompute.report.map_errors import MapErrors
from precompute.report.polarized_photographs import PolarizedPhotographs
from precompute.report.rows import Acquisition

PICTURE = "acquisition-polarized.png"

DESIGNS = (
    *("polygons", "stars", "circles", "periods"),
    *("gradient-stars", "kinematic-discs", "fireworks", "emblem", "logo"),
)

PAPER_CORRELATION = {"kinematic-discs": 0.942, "logo": 0.984}
"""Of photographs and fit, which the 2018 paper finds of real foils of such designs (7.3)."""

PAPER_ERROR, PAPER_SPREAD = 3.616, 3.016
"""Mean error of orientations and its deviation, degrees, that it finds of a compact disc (7.3)."""

DISC_NOISES = (0.01, 0.02, 0.04, 0.06, 0.08)
"""Of full scale. From some 0.1 on photographs of the disc are not registered."""

NUMBERS = (4, 5, 6, 8, 12, 17)
"""Of photographs, at equal steps over the half turn."""

NOISE = 0.01
"""Of full scale, where photographs are counted."""

PASSES = {"as seen": 0, "filtered": 3}
"""Passes of the filter over orientations."""


def polarized_rows(work: Path, pictures: Path) -> Iterator[Acquisition]:
    """Rows of the 2018 paper's 7.3, and of the shipped captures.

    Args:
        work: A folder for photographs, which may be deleted afterwards.
        pictures: Folder for `PICTURE`.
    """
    for design in DESIGNS:
        yield from _design_rows(design, work / design)
    disc: list[tuple[str, Acquisition]] = []
    for noise in DISC_NOISES:
        taken = PolarizedPhotographs.of("disc", work / f"disc-{noise}", noise=noise)
        for name, row in _error_rows(taken, f"disc, noise of {noise:.0%}"):
            beside = row.model_copy(update={"paper": PAPER_ERROR, "paper_spread": PAPER_SPREAD})
            disc.append((name, beside))
            yield beside
    yield from _reached_rows(disc)
    counted: list[tuple[str, Acquisition]] = []
    for number in NUMBERS:
        angles = tuple((180 * np.arange(number) / number).tolist())
        taken = PolarizedPhotographs.of(
            "polygons", work / f"polygons-{number}", noise=NOISE, polariser_deg=angles
        )
        for name, row in _error_rows(taken, f"polygons, noise of {NOISE:.0%}"):
            counted.append((name, row))
            yield row
    _draw(disc, counted, pictures / PICTURE)


def _reached_rows(disc: list[tuple[str, Acquisition]]) -> Iterator[Acquisition]:
    """The noise at which errors are the paper's, where they come to as much."""
    for name in PASSES:
        errors = [row.value for kind, row in disc if kind == name]
        reached = crossing(DISC_NOISES, errors, PAPER_ERROR)
        if reached is not None:
            yield Acquisition(
                case="polarization-disc",
                figure=f"noise at which the mean error is the paper's, {name}",
                unit="of full scale",
                truth=0,
                value=reached,
                spread=0,
                photographs=disc[0][1].photographs,
                noise_db=None,
            )


def crossing(places: Sequence[float], values: Sequence[float], level: float) -> float | None:
    """Where rising values reach a level, by lines through their logarithms; None if they do not.

    >>> round(crossing([1, 2, 4], [1, 4, 16], 8) ** 2, 9)
    8.0
    """
    if not values[0] <= level <= values[-1]:
        return None
    return float(np.exp(np.interp(np.log(level), np.log(values), np.log(places))))


def _design_rows(design: str, folder: Path) -> Iterator[Acquisition]:
    """What is made of a shipped capture."""
    taken = PolarizedPhotographs.of(design, folder)
    for _, row in _error_rows(taken, design):
        yield row
    acquired = taken.acquired()
    diffracts = MapErrors.of(acquired.foil, taken.truth).diffracts
    missed = 1 - acquired.found.mask.ravel()[diffracts].mean()
    yield taken.row(design, "share of texels not seen", "1", float(missed))
    correlation = acquired.found.fit.correlation[acquired.found.mask].astype(float)
    yield taken.row(
        design,
        "correlation of photographs and fit",
        "1",
        float(np.nanmean(correlation)),
        truth=1,
        spread=float(np.nanstd(correlation)),
        paper=PAPER_CORRELATION.get(design),
    )


def _error_rows(taken: PolarizedPhotographs, case: str) -> Iterator[tuple[str, Acquisition]]:
    """The mean error over texels that are seen to diffract, and do, without and with the filter."""
    for name, passes in PASSES.items():
        off = taken.off(taken.acquired(passes=passes))
        figure = f"orientation, mean error, {name}"
        yield name, taken.row(case, figure, "deg", float(off.mean()), spread=float(off.std()))


def _draw(
    disc: list[tuple[str, Acquisition]], counted: list[tuple[str, Acquisition]], file: Path
) -> None:
    """Error over noise, and over the number of photographs."""
    figure = Figure((9, 3.6), 100, layout="constrained")
    left, right = figure.subplots(1, 2)
    percents = [100 * noise for noise in DISC_NOISES]
    for axes, places, rows in ((left, percents, disc), (right, NUMBERS, counted)):
        for name in PASSES:
            errors = [row.value for kind, row in rows if kind == name]
            axes.plot(places, errors, "o-", markersize=3, label=name)
        axes.set(ylabel="mean error of orientation (deg)", xscale="log", yscale="log")
        axes.set_xticks(places, [f"{place:g}" for place in places])
        axes.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axes.yaxis.set_major_formatter("{x:g}")
        axes.minorticks_off()
        axes.legend(fontsize=8)
    left.axhline(PAPER_ERROR, color="grey", linestyle=":")
    left.text(1, 1.05 * PAPER_ERROR, "the 2018 paper's, of a real disc", color="grey", fontsize=8)
    left.set(title="disc, 17 photographs", xlabel="noise (% of full scale)")
    right.set(title=f"polygons, noise of {NOISE:.0%}", xlabel="photographs")
    with written_aside(file) as aside:
        figure.savefig(aside, format="png")
