"""Foils acquired in polarised light and made absolute by a flash photograph, both simulated."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from precompute.acquisition.fuse import acquire_fused
from precompute.report.map_errors import MapErrors
from precompute.report.polarized_photographs import PolarizedPhotographs
from precompute.report.rows import Acquisition

DESIGNS = ("polygons", "periods")
"""Of one period, and of many."""

SHORTEST = 1.0
"""What the relative map takes the shortest period to be, µm."""


def fusion_rows(work: Path) -> Iterator[Acquisition]:
    """Offset and periods of shipped captures, of which polarised light tells neither.

    Args:
        work: A folder that may be deleted afterwards, with flash captures of `DESIGNS` in folders
            of their names.
    """
    for design in DESIGNS:
        yield from _rows(design, work)


def _rows(design: str, work: Path) -> Iterator[Acquisition]:
    taken = PolarizedPhotographs.of(design, work / f"polarised-{design}")
    shortest, longest = taken.periods
    relative = taken.acquired(offset=None, periods=(SHORTEST, SHORTEST * longest / shortest))
    relative.foil.write(work, f"relative-{design}")
    foil, fusion = acquire_fused(
        work / f"relative-{design}",
        work / design / "capture.json",
        lambda _: None,
        lambda error: error,
    )
    case = f"{design}, made absolute by a flash photograph"
    offset = (np.degrees(fusion.offset), np.degrees(taken.offset) % 180)
    yield taken.row(case, "offset of orientations", "deg", float(offset[0]), truth=float(offset[1]))
    yield taken.row(case, "shortest period", "µm", SHORTEST * fusion.scale, truth=shortest)
    errors = MapErrors.of(foil, taken.truth)
    seen = relative.found.mask.ravel()[errors.diffracts]
    for figure, unit, off in (
        ("orientation, mean error", "deg", errors.orientation[seen]),
        ("period, median error", "1", errors.period[seen]),
    ):
        middle = np.median(off) if "median" in figure else np.mean(off)
        yield taken.row(case, figure, unit, float(middle), spread=float(off.std()))
