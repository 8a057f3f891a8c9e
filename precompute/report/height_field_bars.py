"""The bars of height fields."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf

from precompute.report.bars import Bar, worst
from precompute.report.measurements import SceneResult
from precompute.report.rows import BakeCost, Report, Row
from precompute.report.timing import IRIDESCENT, WITHOUT

ERROR = 0.01
"""Largest relative RMSE of a method at the cost it chooses."""

SEED_SHARES = {"line-sum": 0.1, "jacobi-anger": 0.5, "baked": 0.01}
"""Largest share of the time that the seed's series adds, at equal error."""

ROUGH_SCENE = "height-field-bumps-rough"
"""Bumps 0.15 µm high at 1° of roughness, whose pattern is baked."""

SERIES_ERROR = 0.02
"""Largest error of a series at any height."""

GIGABYTE = 1e9


def height_field_bars(report: Report, results: dict[str, SceneResult]) -> Iterator[Bar]:
    """Errors, times, memory, stability and the cost of baking."""
    fields = {
        name: result for name, result in results.items() if result.scene.surface == "height_field"
    }
    lit = {
        name: result
        for name, result in fields.items()
        if result.scene.lighting in ("directional", "point")
    }
    for method in ("line-sum", "jacobi-anger", "taylor", "baked"):
        errors = [
            (f"{result.scene.field}, {name}", row.rel_rmse)
            for name, result in lit.items()
            for row in _at_its_best(result, method)
        ]
        yield from worst(f"height fields by {method}, relative RMSE", errors, ERROR)
    around = [
        (name, row.rel_rmse)
        for name, result in fields.items()
        if name not in lit
        for row in result.rows()
    ]
    yield from worst("height fields in environments, relative RMSE", around, None)
    for method, share in SEED_SHARES.items():
        shares = [
            (name, added) for name, result in lit.items() for added in _shares(result, method)
        ]
        yield from worst(f"added time, {method} over the seed's series", shares, share)
    if ROUGH_SCENE in results:
        rough = results[ROUGH_SCENE]
        baked = rough.first("baked")
        frame = rough.times.ratio(baked, over=IRIDESCENT)
        yield Bar("whole frame, baked, over iridescence", 1.5, frame, ROUGH_SCENE)
        memory = rough.methods[int(baked)].texture_bytes / 1e6
        yield Bar("tables of the baked pattern at 1° of roughness, MB", 2, memory, ROUGH_SCENE)
    yield from _stability_bars(report)
    yield from _bake_bars(report.bake_cost)


def _at_its_best(result: SceneResult, method: str) -> list[Row]:
    """The scene's row of a method with the settings that err least, if it has one."""
    rows = [row for row in result.rows() if row.method == method]
    return sorted(rows, key=lambda row: row.rel_rmse)[:1]


def _shares(result: SceneResult, method: str) -> list[float]:
    """The method's added time over each seed's: of its rows within `ERROR` the fastest one's."""
    rows, times = result.rows(), result.times
    # What is asked of the others is asked without roughness.
    is_rough = result.scene.description.get("material", {}).get("roughness", 0) > 0
    if is_rough != (method == "baked"):
        return []
    good = [i for i, row in enumerate(rows) if row.method == method and row.rel_rmse <= ERROR]
    ours = [str(i) for i in sorted(good, key=lambda i: rows[i].time_ratio)[:1]]
    seeds = [str(i) for i, row in enumerate(rows) if row.seed]
    return [times.ratio(one, over=seed, beyond=WITHOUT) for one in ours for seed in seeds]


def _stability_bars(report: Report) -> Iterator[Bar]:
    series = [e for e in report.stability if e.method == "jacobi-anger"]
    asked = "jacobi-anger at x = k w Δ/2 from 0 to 80"
    yield from worst(f"{asked}, not finite", [(e.case, e.non_finite) for e in series], 0)
    errors = [(e.case, inf if e.rel_rmse is None else e.rel_rmse) for e in series]
    yield from worst(f"{asked}, relative RMSE", errors, SERIES_ERROR)
    taken = [
        (e.case, inf if e.rel_rmse is None else e.rel_rmse)
        for e in report.stability
        if e.method == "taylor" and e.float == "fp32" and e.refused is None
    ]
    yield from worst("taylor where the bake takes it, relative RMSE", taken, SERIES_ERROR)


def _bake_bars(costs: list[BakeCost]) -> Iterator[Bar]:
    limits = {512: (20.0, 2.0), 2048: (None, 8.0)}
    for cost in costs:
        if cost.size not in limits:
            continue
        seconds, memory = limits[cost.size]
        asked, where = f"bake of {cost.size}², {cost.terms} terms", f"{cost.size}²"
        yield Bar(f"{asked}, s", seconds, cost.seconds, where)
        yield Bar(f"{asked}, GB", memory, cost.peak_bytes / GIGABYTE, where)
