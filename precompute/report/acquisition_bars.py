"""The bars of acquired foils."""

from __future__ import annotations

from collections.abc import Callable, Iterator

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

DESIGNS = ("flash-polygons", "flash-stars", "flash-circles", "flash-periods")


def acquisition_bars(rows: list[Acquisition]) -> Iterator[Bar]:
    """Those of flash photographs; rows of the seed's method are held against none."""
    ours = [row for row in rows if not row.seed]

    def held(
        asked: str,
        limit: float | None,
        figure: str,
        *cases: str,
        of: Callable[[Acquisition], float] = lambda row: row.value,
    ) -> Iterator[Bar]:
        matching = (row for row in ours if row.figure == figure and row.case in cases)
        yield from worst(asked, [(_where(row), of(row)) for row in matching], limit)

    period = ("mean period", "flash-period-simulated")
    off = "period at one wavelength, relative error of its mean"
    yield from held(off, MEAN_PERIOD, *period, of=lambda row: abs(row.value / row.truth - 1))
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
    sine = ("RMS from it, over the mean", "polarization-model, sine, r of 0.5 to 1.5")
    yield from held("polarised light, RMS from a sine", SINE, *sine)
    another = "relative RMSE under another light"
    yield from held("designs, relative RMSE under another light", None, another, *DESIGNS)


def _where(row: Acquisition) -> str:
    noise = "no noise" if row.noise_db is None else f"{row.noise_db:.0f} dB"
    return f"{row.case}, {noise}"
