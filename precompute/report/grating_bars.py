"""The bars of gratings and foils."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf

from precompute.report.bars import Bar, worst
from precompute.report.measurements import SceneResult
from precompute.report.rows import Report
from precompute.report.timing import IRIDESCENT, WITHOUT

TIMED_SCENE = "plane-directional"
"""The scene whose times are held against the bars: a plane under one directional light."""

ARC_ERROR = 0.2
"""Largest share of the error of the papers' arcs of an environment, in no more than their time."""

ARC_TIME = 0.25
"""Largest share of the time that those arcs add, at no more than their error."""


def grating_bars(report: Report, results: dict[str, SceneResult]) -> Iterator[Bar]:
    """Errors of each method, the white furnace, and the closed form's times."""
    closed = [row for row in report.rows if row.method == "closed-form"]
    lit = [row for row in closed if row.lighting in ("directional", "point")]
    around = [
        row
        for row in closed
        if row.lighting in ("environment", "mixed") and "environment_nodes" not in row.knobs
    ]
    loops = [row for row in report.rows if row.method == "wavelength-loop"]
    fine = [row for row in loops if row.knobs.get("wavelength_step") == 0.001]
    arcs = [row for row in report.rows if row.knobs.get("environment_nodes") == 401]
    for asked, rows, figure, limit in (
        ("closed form under lights, relative RMSE", lit, "rel_rmse", 0.01),
        ("closed form under lights, ΔE2000 p95", lit, "delta_e2000_p95", 1),
        ("closed form in environments, relative RMSE", around, "rel_rmse", None),
        ("closed form in environments, ΔE2000 p95", around, "delta_e2000_p95", None),
        ("loop at 1 nm, relative RMSE", fine, "rel_rmse", 0.01),
        ("environment by 401 nodes, relative RMSE", arcs, "rel_rmse", 0.005),
    ):
        yield from worst(asked, [(row.scene, getattr(row, figure)) for row in rows], limit)
    albedos = [(e.case, e.max_albedo) for e in report.furnaces() if e.max_albedo is not None]
    yield from worst("white furnace, largest albedo over the metal's", albedos, 1.001, ".5f")
    for asked, figure in (("not finite", "non_finite"), ("negative", "negative_energy")):
        counts = [(entry.case, getattr(entry, figure)) for entry in report.edges()]
        yield from worst(f"closed form at the edges, {asked}", counts, 0)
    arcs_of = {
        name: result
        for name, result in results.items()
        if result.scene.surface != "height_field" and result.scene.lighting == "environment"
    }
    shares = [(name, share) for name, result in arcs_of.items() for share in _arc_shares(result)]
    for index, asked, limit in (
        (0, "error over that of the papers' arcs, in their time", ARC_ERROR),
        (1, "added time over that of the papers' arcs, at their error", ARC_TIME),
    ):
        yield from worst(asked, [(name, both[index]) for name, both in shares], limit)
    flat = {row.scene for row in closed if not row.knobs.get("planar", True)}
    tabled = [row for row in closed if row.scene in flat and "planar" not in row.knobs]
    for asked, figure, limit in (
        ("flat and 0.7 to 1° rough in an environment, relative RMSE", "rel_rmse", 0.02),
        ("flat and 0.7 to 1° rough in an environment, frame over standard", "time_ratio", 2),
    ):
        yield from worst(asked, [(row.scene, getattr(row, figure)) for row in tabled], limit)
    if TIMED_SCENE in results:
        frame, share = _frame_and_share(results[TIMED_SCENE])
        yield Bar("added time, closed form over loop of 5 nm", 0.1, share, TIMED_SCENE)
        yield Bar("whole frame over iridescent MeshPhysicalMaterial", 1.2, frame, TIMED_SCENE)
    filtered = [entry for entry in report.minified if entry.shown == "filtered"]
    for asked, figure, limit, digits in (
        ("foils from afar, error over mean radiance", "mean_error", 0.05, ".3g"),
        ("foils from afar, flicker over the mean's", "flicker", 1.01, ".4f"),
    ):
        figures = [
            (f"{e.foil}, {e.texels:g} texels to a pixel", getattr(e, figure)) for e in filtered
        ]
        yield from worst(asked, figures, limit, digits)
    ratios = {
        name: _frame_and_share(result)
        for name, result in results.items()
        if result.scene.surface != "height_field"
        and result.scene.lighting in ("directional", "point")
    }
    for index, asked in ((1, "added time"), (0, "whole frame")):
        asked = f"{asked}, likewise, of all scenes under lights"
        yield from worst(asked, [(name, both[index]) for name, both in ratios.items()], None)


def _frame_and_share(result: SceneResult) -> tuple[float, float]:
    """The closed form's frame over the iridescent one, and its added time over the loop's."""
    ours, loop = result.first("closed-form"), result.first("wavelength-loop")
    return (
        result.times.ratio(ours, over=IRIDESCENT),
        result.times.ratio(ours, over=loop, beyond=WITHOUT),
    )


def _arc_shares(result: SceneResult) -> Iterator[tuple[float, float]]:
    """The best settings of the closed form over each of the papers' loops.

    Yields:
        The least error in no more than the loop's time, over the loop's, and the least added time
        at no more than its error, likewise; infinite where no setting is as fast or as good.
    """
    rows, times = result.rows(), result.times
    ours = [i for i, row in enumerate(rows) if row.method == "closed-form"]
    for index, seed in enumerate(rows):
        if not seed.seed or seed.method != "wavelength-loop":
            continue
        added = {i: times.ratio(str(i), over=str(index), beyond=WITHOUT) for i in ours}
        errors = (rows[i].rel_rmse / seed.rel_rmse for i in ours if added[i] <= 1)
        fast = (added[i] for i in ours if rows[i].rel_rmse <= seed.rel_rmse)
        yield min(errors, default=inf), min(fast, default=inf)
