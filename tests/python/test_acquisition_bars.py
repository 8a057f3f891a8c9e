"""What acquired foils are held against."""

from __future__ import annotations

from typing import Any

import pytest

from precompute.report.acquisition_bars import acquisition_bars
from precompute.report.bars import Bar
from precompute.report.rows import Acquisition


def row(case: str, figure: str, value: float, **more: Any) -> Acquisition:
    numbers: dict[str, Any] = {"truth": 0, "spread": 0, "photographs": 3, "noise_db": 43} | more
    return Acquisition(case=case, figure=figure, unit="deg", value=value, seed=False, **numbers)


def verdicts(rows: list[Acquisition]) -> dict[str, Bar]:
    return {bar.asked: bar for bar in acquisition_bars(rows)}


def test_the_worst_design_decides() -> None:
    figure = "orientation, 95th percentile of error"
    rows = [row("flash-polygons", figure, 2.0), row("flash-stars", figure, 5.1)]
    (bar,) = verdicts(rows).values()
    assert not bar.is_met and bar.where == "flash-stars, 43 dB" and bar.value == 5.1
    rows[1] = rows[1].model_copy(update={"value": 4.9})
    (bar,) = verdicts(rows).values()
    assert bar.is_met


def test_a_period_is_off_in_either_direction_and_spreads() -> None:
    for value, spread, met in (
        (1.67, 0.01, (True, True)),
        (1.64, 0.01, (False, True)),
        (1.68, 0.06, (False, False)),
    ):
        one = row("flash-period-simulated", "mean period", value, truth=1.66, spread=spread)
        assert tuple(bar.is_met for bar in verdicts([one]).values()) == met


def test_rows_of_the_seed_and_of_other_cases_are_held_against_nothing() -> None:
    figure = "orientation, median error"
    seed = row("flash-stars", figure, 9.0).model_copy(update={"seed": True})
    assert verdicts([seed, row("flash-shifted by 3 px, aligned", figure, 9.0)]) == {}
    (bar,) = verdicts([row("flash-shifted by 2 px, aligned", figure, 2.5)]).values()
    assert not bar.is_met


def test_polarised_light() -> None:
    mean = "orientation, mean error, filtered"
    rows = [
        row("polarization-disc, noise of 1%", mean, 0.9),
        row("polarization-disc, noise of 2%", mean, 9.0),
        row("polarization-stars", mean, 1.3),
        row("polarization-step of 30°", "worn texels' largest distance from it, 3 passes", 1.0),
        row("polarization-step of 30°", "worn texels' largest distance from it, 50 passes", 3.0),
        row("polarization-polygons, fused", "offset of orientations", 179.5, truth=0.25),
        row("polarization-polygons, fused", "shortest period", 1.61, truth=1.66),
    ]
    found = {asked: (bar.value, bar.is_met) for asked, bar in verdicts(rows).items()}
    assert found == {
        "polarised light, disc, orientation, mean, degrees": (0.9, True),
        "polarised light, designs, orientation, mean, degrees": (1.3, True),
        "filter, texels worn by a step of 30°, px": (3.0, False),
        "fused, offset, degrees": (0.75, True),
        "fused, period, relative error": (pytest.approx(0.05 / 1.66), False),
    }
