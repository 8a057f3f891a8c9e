"""Foils acquired from simulated photographs, against the foils that were photographed."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from precompute.acquisition.flash import Acquired, FlashOptions, acquire_flash
from precompute.acquisition.observations import half_vectors
from precompute.acquisition.pictures import rendering, sample_grid
from precompute.acquisition.simulate import simulated
from precompute.acquisition.simulation import Simulation, read_simulation
from precompute.acquisition.tiling import Tiling
from precompute.maps import Map
from precompute.metrics import relative_rmse
from precompute.report.acquisition_spiral import spiral_rows
from precompute.report.browser import ROOT
from precompute.report.filtered_foils import filter_rows
from precompute.report.fused_foils import fusion_rows
from precompute.report.map_errors import MapErrors
from precompute.report.polarization_model import polarization_model_rows
from precompute.report.polarized_foils import polarized_rows
from precompute.report.rows import Acquisition

Array = NDArray[np.float64]

CAPTURES = ROOT / "maps" / "captures"
DESIGNS = ("polygons", "stars", "circles", "periods")
SHIFTS_PX = (0, 1, 2, 3)
COUNT = 4 + 6 * len(SHIFTS_PX) + 12 * len(DESIGNS)
"""Of rows of flash photographs, which take the longest."""

PIXEL_MM = 0.25
"""Of flash-shifted: by how much tiles are off in pixels."""

NOISE_DB = 40.0
NEW_LIGHT = (15.0, 55.0, 160.0)
"""Position, mm, from which no capture is lit."""

PAPER_PERIOD, PAPER_SPREAD = 1.939, 0.15
"""Period and its deviation, µm, that the 2018 paper finds of 1.66 (7.1)."""

ACROSS = 400
"""Points across the sample in a round trip: half a millimetre apart."""

SEED = FlashOptions(method="thresholds", align=False, is_one_period=False)
"""The papers' method: the brightest observation decides, tiles lie where they are marked."""


@dataclass(frozen=True)
class Photographed:
    """A simulated capture and the foil that it shows.

    Attributes:
        capture: Its file.
        truth: The foil.
        photographs: How many.
        noise_db: Signal to noise at full scale, None without noise.
    """

    capture: Path
    truth: Map
    photographs: int
    noise_db: float | None

    @staticmethod
    def of(simulation: Simulation, file: Path, folder: Path) -> Photographed:
        """Simulate, into a folder that may be deleted afterwards."""
        capture = simulated(simulation, file, folder)
        truth = Map.read(folder / "truth" / "foil")
        noise = simulation.sensor.signal_to_noise_db
        return Photographed(capture, truth, len(simulation.photographs), noise)

    def acquired(self, options: FlashOptions) -> Acquired:
        """Solve it."""
        return acquire_flash(self.capture, options, lambda _: None)

    def errors(self, acquired: Acquired) -> MapErrors:
        """How far what was acquired is from the truth."""
        return MapErrors.of(acquired.foil, self.truth)

    def row(self, case: str, figure: str, unit: str, values: Array, seed: bool) -> Acquisition:
        """A row whose value is the mean of numbers that should be 0."""
        return Acquisition(
            case=case,
            figure=figure,
            unit=unit,
            truth=0,
            value=float(np.mean(values)),
            spread=float(np.std(values)),
            photographs=self.photographs,
            noise_db=self.noise_db,
            seed=seed,
        )


def acquisition_rows(pictures: Path) -> Iterator[Acquisition]:
    """All rows as they are measured: some twenty minutes.

    Args:
        pictures: Folder for pictures.
    """
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        yield from _period_rows(work)
        yield from _shift_rows(work)
        for design in DESIGNS:
            yield from _design_rows(design, work, pictures)
        yield from fusion_rows(work)
        yield from polarized_rows(work / "polarized", pictures)
        yield from filter_rows(work / "polarized", pictures)
    yield from polarization_model_rows(pictures)
    yield from spiral_rows(ROOT)


def _period_rows(work: Path) -> Iterator[Acquisition]:
    """The 2018 paper, 7.1: one wavelength, 1.66 µm, each texel by itself."""
    simulation, file = _recipe("flash-period")
    for noise in (None, NOISE_DB):
        sensor = simulation.sensor.model_copy(update={"noise_db": noise})
        taken = Photographed.of(
            simulation.model_copy(update={"sensor": sensor}), file, work / f"period-{noise}"
        )
        for options in (FlashOptions(is_one_period=False), SEED):
            acquired = taken.acquired(options)
            errors = taken.errors(acquired)
            periods = errors.periods[_seen(acquired)[errors.diffracts]]
            row = taken.row("flash-period-simulated", "mean period", "µm", periods, options is SEED)
            yield row.model_copy(
                update={"truth": 1.66, "paper": PAPER_PERIOD, "paper_spread": PAPER_SPREAD}
            )


def _shift_rows(work: Path) -> Iterator[Acquisition]:
    """The 2018 paper, 7.2: orientation where tiles are not where they are marked."""
    simulation, file = _recipe("flash-shifted")
    for pixels in SHIFTS_PX:
        update = {"shift_mm": pixels * PIXEL_MM}
        surface = simulation.surface.model_copy(update=update)
        taken = Photographed.of(
            simulation.model_copy(update={"surface": surface}), file, work / f"shift-{pixels}"
        )
        for name, options in (
            ("aligned", FlashOptions()),
            ("not aligned", FlashOptions(align=False)),
            ("seed", SEED),
        ):
            off = taken.errors(taken.acquired(options)).orientation
            case = f"flash-shifted by {pixels} px, {name}"
            yield from _quantiles(taken, case, "orientation", "deg", off, options is SEED)


def _design_rows(design: str, work: Path, pictures: Path) -> Iterator[Acquisition]:
    """Designs with all that is not ideal, and what they show under another light."""
    simulation, file = _recipe(f"flash-{design}")
    taken = Photographed.of(simulation, file, work / design)
    for options in (FlashOptions(), SEED):
        acquired = taken.acquired(options)
        errors, is_seed = taken.errors(acquired), options is SEED
        case = f"flash-{design}" + (", seed" if is_seed else "")
        yield from _quantiles(taken, case, "orientation", "deg", errors.orientation, is_seed)
        yield from _quantiles(taken, case, "period", "1", errors.period, is_seed)
        missed = np.where(_seen(acquired)[errors.diffracts], 0.0, 1.0)
        yield taken.row(case, "share of texels not seen", "1", missed, is_seed)
        picture = pictures / f"acquisition-{design}{'-seed' if is_seed else ''}.png"
        error = round_trip(taken.truth, acquired, picture)
        yield taken.row(case, "relative RMSE under another light", "1", np.array([error]), is_seed)


def _seen(acquired: Acquired) -> NDArray[np.bool_]:
    """Which texels have a grating from the photographs, shape (texels,)."""
    return (acquired.completed.seen | acquired.completed.unsure).ravel()


def _quantiles(
    taken: Photographed, case: str, name: str, unit: str, off: Array, is_seed: bool
) -> Iterator[Acquisition]:
    """A row each for the median and the 95th percentile of errors; their spread is that of all."""
    for figure, quantile in (("median error", 50), ("95th percentile of error", 95)):
        row = taken.row(case, f"{name}, {figure}", unit, off, is_seed)
        yield row.model_copy(update={"value": float(np.percentile(off, quantile))})


def round_trip(truth: Map, acquired: Acquired, file: Path) -> float:
    """Relative RMSE of the map against the truth under a light that was not photographed.

    Outside the highlight, which is ten times as bright as all else and tells nothing of gratings.

    Both are evaluated by the reference on a grid over the sample, their tiles in their places. The
    lamp's power being unknown, the map is given the exposure at which it errs least.

    Args:
        truth: The foil.
        acquired: What was made of it.
        file: For a picture of both.
    """
    tiling = acquired.tiling
    ideal = Tiling.covering(tiling.sample, tiling.size, tiling.corner)
    shot = replace(acquired.calibration.shots[0], light=np.array(NEW_LIGHT))
    points, shape = sample_grid(ideal, ACROSS)
    both = [
        rendering(foil, ideal, shot, points, acquired.calibration.roughness)
        for foil in (truth, acquired.foil)
    ]
    true, found = both
    h, _ = half_vectors(points, shot.rectification.eye, shot.light)
    outside = np.hypot(h[:, 0], h[:, 1]) > acquired.calibration.highlight
    found *= np.sum(true[outside] * found[outside]) / np.sum(found[outside] ** 2)
    white = np.percentile(true, 99)
    panels = [np.clip(part.reshape(*shape, -1) / white, 0, 1) ** (1 / 2.2) for part in both]
    gap = np.ones((shape[0], 4, panels[0].shape[2]))
    joined = np.concatenate([panels[0], gap, panels[1]], axis=1)
    if joined.shape[2] == 1:
        joined = np.repeat(joined, 3, axis=2)
    Image.fromarray(np.round(255 * joined).astype(np.uint8)).save(file, optimize=True)
    return relative_rmse(found[outside], true[outside])


def _recipe(name: str) -> tuple[Simulation, Path]:
    file = CAPTURES / f"{name}.json"
    return read_simulation(file), file
