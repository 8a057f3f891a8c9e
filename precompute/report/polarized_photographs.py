"""Simulated photographs in polarised light, and what is made of them."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from precompute.acquisition.polarization import PolarizationOptions, Polarized, acquire_polarization
from precompute.acquisition.polarization_simulation import read_polarization_simulation
from precompute.acquisition.simulate_polarization import simulated_polarization
from precompute.acquisition.taking import SensorNoise
from precompute.maps import Map
from precompute.report.browser import ROOT
from precompute.report.map_errors import MapErrors
from precompute.report.rows import Acquisition

Array = NDArray[np.float64]

CAPTURES = ROOT / "maps" / "captures"


@dataclass(frozen=True)
class PolarizedPhotographs:
    """A simulated capture and the foil that it shows.

    Attributes:
        capture: Its file.
        truth: The foil.
        offset: θ less half the phase of what is seen, rad.
        photographs: How many.
        noise_db: Signal to noise at full scale, None without noise.
    """

    capture: Path
    truth: Map
    offset: float
    photographs: int
    noise_db: float | None

    @staticmethod
    def of(design: str, folder: Path, **changes: Any) -> PolarizedPhotographs:
        """Simulate ``polarization-DESIGN``, into a folder that may be deleted afterwards.

        Args:
            design: Of the shipped captures.
            folder: Where it goes.
            changes: Fields of its recipe that have other values; ``noise`` stands for white noise
                of so much of full scale, ``bumps_deg`` for the sheet's.
        """
        file = CAPTURES / f"polarization-{design}.json"
        simulation = read_polarization_simulation(file)
        if "noise" in changes:
            changes["sensor"] = SensorNoise(noise_db=float(-20 * np.log10(changes.pop("noise"))))
        if "bumps_deg" in changes:
            bumps = {"bumps_deg": changes.pop("bumps_deg")}
            changes["sheet"] = simulation.sheet.model_copy(update=bumps)
        simulation = simulation.model_copy(update=changes)
        capture = simulated_polarization(simulation, file, folder)
        told = json.loads((folder / "truth" / "polarization.json").read_text("utf-8"))
        return PolarizedPhotographs(
            capture,
            Map.read(folder / "truth" / "foil"),
            float(np.radians(told["offset_deg"])),
            len(simulation.polariser_deg),
            simulation.sensor.signal_to_noise_db,
        )

    @property
    def periods(self) -> tuple[float, float]:
        """Shortest and longest of the foil, µm."""
        high, low = (self.truth.constants[f"{end}_frequency"] for end in ("max", "min"))
        return 1 / float(np.ravel(high)[0]), 1 / float(np.ravel(low)[0])

    def acquired(self, **options: Any) -> Polarized:
        """Solve it, its offset being given."""
        told = PolarizationOptions(**{"offset": self.offset, **options})
        return acquire_polarization(self.capture, told, lambda _: None)

    def off(self, acquired: Polarized) -> Array:
        """Errors of orientations, degrees, of texels that are seen to diffract, and do."""
        errors = MapErrors.of(acquired.foil, self.truth)
        return errors.orientation[acquired.found.mask.ravel()[errors.diffracts]]

    def row(self, case: str, figure: str, unit: str, value: float, **more: Any) -> Acquisition:
        """A row about these photographs, of what should be 0 unless it is told."""
        return Acquisition(
            case=f"polarization-{case}",
            figure=figure,
            unit=unit,
            value=value,
            photographs=self.photographs,
            noise_db=self.noise_db,
            **{"truth": 0, "spread": 0, **more},
        )
