"""The bars of acquired foils."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

from precompute.report.bars import Bar, worst
from precompute.report.rows import Acquisition

MEAN_PERIOD, PERIOD_SPREAD = 0.01, 0.05
"""Relative error of a sample's mean period, and the deviation of its texels', µm."""

SHIFTED = 2.0
"""Median error of orientations, degrees, where tiles are 2 pixels off their places."""

MEDIAN, LARGE = 1.0, 5.0
"""Median and 95th percentile of errors of orientations, degrees."""

NOT_SEEN = 0.02
"""Share of texels that diffract of which photographs show nothing."""

VARYING_PERIOD = 0.03
"""Relative error of a period that varies over the tile."""

SINE = 0.002
"""RMS distance from a sine of what a polariser lets through, over its mean."""

DISC = 1.0
"""Mean error of orientations of a disc in polarised light, degrees, the noise being a hundredth."""

WORN = 2.0
"""Texels from a step of 30° that the filter of orientations may wear, px."""

FUSED_OFFSET, FUSED_PERIOD = 1.0, 0.02
"""Error of an offset by a flash photograph, degrees, and relative one of a period."""

DESIGNS = ("flash-polygons", "flash-stars", "flash-circles", "flash-periods")


def acquisition_bars(rows: list[Acquisition]) -> Iterator[Bar]:
    """Rows of the seed's method are held against none."""
    ours = [row for row in rows if not row.seed]
    yield from _flash_bars(ours)
    yield from _polarized_bars(ours)


def _flash_bars(rows: list[Acquisition]) -> Iterator[Bar]:
    held = partial(_held, rows)
    period = ("mean period", "flash-period-simulated")
    off = "period at one wavelength, relative error of its mean"
    yield from held(off, MEAN_PERIOD, *period, of=_relative)
    spread = "period at one wavelength, standard deviation, µm"
    yield from held(spread, PERIOD_SPREAD, *period, of=lambda row: row.spread)
    median, large = (f"orientation, {name} error" for name in ("median", "95th percentile of"))
    shifted = "flash-shifted by 2 px, aligned"
    yield from held("tiles 2 pixels off, orientation, median, degrees", SHIFTED, median, shifted)
    yield from held("designs, orientation, median, degrees", MEDIAN, median, *DESIGNS)
    yield from held("designs, orientation, 95th percentile, degrees", LARGE, large, *DESIGNS)
    not_seen = "share of texels not seen"
    yield from held("designs, share of texels not seen", NOT_SEEN, not_seen, *DESIGNS)
    varying = "varying period, relative error, "
    for name, limit in (("median", VARYING_PERIOD), ("95th percentile of", None)):
        yield from held(varying + name.split(" of")[0], limit, f"period, {name} error", DESIGNS[-1])
    another = "relative RMSE under another light"
    yield from held("designs, relative RMSE under another light", None, another, *DESIGNS)


def _polarized_bars(rows: list[Acquisition]) -> Iterator[Bar]:
    held = partial(_held, rows)
    sine = ("RMS from it, over the mean", "polarization-model, sine, r of 0.5 to 1.5")
    yield from held("polarised light, RMS from a sine", SINE, *sine)
    mean = "orientation, mean error, filtered"
    disc = "polarization-disc, noise of 1%"
    yield from held("polarised light, disc, orientation, mean, degrees", DISC, mean, disc)
    polarised = _cases(rows, mean)
    asked = "polarised light, designs, orientation, mean, degrees"
    yield from held(asked, None, mean, *(case for case in polarised if "noise of" not in case))
    step = "polarization-step of 30°"
    off = [(row.figure, row.value) for row in rows if row.case == step]
    yield from worst("filter, texels worn by a step of 30°, px", off, WORN)
    for asked, limit, figure, of in (
        ("fused, offset, degrees", FUSED_OFFSET, "offset of orientations", _turned),
        ("fused, period, relative error", FUSED_PERIOD, "shortest period", _relative),
    ):
        yield from held(asked, limit, figure, *_cases(rows, figure), of=of)


def _held(
    rows: list[Acquisition],
    asked: str,
    limit: float | None,
    figure: str,
    *cases: str,
    of: Callable[[Acquisition], float] = lambda row: row.value,
) -> Iterator[Bar]:
    matching = (row for row in rows if row.figure == figure and row.case in cases)
    yield from worst(asked, [(_where(row), of(row)) for row in matching], limit)


def _cases(rows: list[Acquisition], figure: str) -> list[str]:
    return [row.case for row in rows if row.figure == figure]


def _relative(row: Acquisition) -> float:
    return abs(row.value / row.truth - 1)


def _turned(row: Acquisition) -> float:
    """Degrees between two orientations."""
    return abs((row.value - row.truth + 90) % 180 - 90)


def _where(row: Acquisition) -> str:
    noise = "no noise" if row.noise_db is None else f"{row.noise_db:.0f} dB"
    return f"{row.case}, {noise}"
