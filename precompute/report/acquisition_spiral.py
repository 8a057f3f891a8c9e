"""The stochastic spiral, photographed, estimated, woven anew and photographed again."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from precompute.acquisition.calibration import HIGHLIGHT
from precompute.acquisition.capture import read_capture
from precompute.acquisition.lobes import lobe_deviation
from precompute.acquisition.observations import Shot, half_vectors
from precompute.acquisition.shots import ROUGHNESS, read_shots
from precompute.acquisition.simulate import simulated
from precompute.acquisition.simulation import Simulation, read_simulation
from precompute.acquisition.stochastic import Method, estimate_distribution
from precompute.acquisition.transport import distribution_distance, picture_distance
from precompute.foils.distribution import GratingDistribution
from precompute.foils.stochastic import distribution_of
from precompute.progress import tracked
from precompute.recipes import read_recipe
from precompute.report.rows import Acquisition

Array = NDArray[np.float64]

RECIPE = Path("maps/captures/flash-spiral.json")
CASE = "flash-spiral-simulated"
FINE_MM = 0.15
"""Shapes of a second foil, in place of 0.4: seven times as many, so that chance matters less."""

PITCH = 5.0
"""mm between the places on the sample at which photographs are compared, and of their blur."""


@dataclass(frozen=True)
class Taking:
    """A photograph of a foil woven from a distribution.

    Attributes:
        name: Of the distribution.
        shot: The photograph.
        size_mm: Of the sample.
    """

    name: str
    shot: Shot
    size_mm: tuple[float, float]


def spiral_rows(root: Path) -> list[Acquisition]:
    """Rows of the report; some two minutes.

    Earth mover's distances of distributions are in rad (`distribution_distance`), those of
    photographs in mm on the sample (`picture_distance`). Values of estimates are means over two
    photographs of two foils woven from the true distribution. Beside them are the distances of
    distributions that are wrong: even over the same periods, mirrored, of the mean period alone.

    Args:
        root: Folder of the project.
    """
    file = root / RECIPE
    true = _true(file)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        taken = [photographed(file, true, folder, f"true-{seed}", seed) for seed in (1, 2)]
        made: dict[str, list[GratingDistribution]] = {
            method: [estimated(taking, method) for taking in taken]
            for method in ("deconvolution", "threshold")
        }
        made |= {name: [one] for name, one in wrong_distributions(true).items()}
        fine = photographed(file, true, folder, "fine", 1, FINE_MM)
        made |= {
            f"{method}, shapes of {FINE_MM} mm": [estimated(fine, method)]
            for method in ("deconvolution", "threshold")
        }
        distances = {
            name: [distribution_distance(true, one) for one in some] for name, some in made.items()
        }
        again = {
            name: photographed(file, made[name][0], folder, name, 3)
            for name in tracked(("deconvolution", "threshold", "even", "mirrored"), "Weaving anew")
        }
        lights = [light_on_sample(taking) for taking in taken]
        apart = {
            name: [picture_distance(light, light_on_sample(taking), PITCH) for light in lights]
            for name, taking in again.items()
        }
        apart["true, woven anew"] = [picture_distance(lights[0], lights[1], PITCH)]
    simulation = read_simulation(file)
    return [
        *(
            _row(simulation, f"distance of distributions: {n}", "rad", v)
            for n, v in distances.items()
        ),
        *(_row(simulation, f"distance of photographs: {n}", "mm", v) for n, v in apart.items()),
    ]


def wrong_distributions(true: GratingDistribution) -> dict[str, GratingDistribution]:
    """Distributions that are not the true one."""
    θ, f, weights = true.orientation_edges, true.frequency_edges, true.weights
    middle = np.searchsorted(np.cumsum(weights.sum(axis=0)), 0.5)
    single = np.zeros_like(weights)
    single[:, middle] = 1
    return {
        "even": GratingDistribution(θ, f, np.ones_like(weights)),
        "mirrored": GratingDistribution(θ, f, weights[::-1]),
        "one period": GratingDistribution(θ, f, single),
    }


def photographed(
    file: Path,
    distribution: GratingDistribution,
    folder: Path,
    name: str,
    seed: int,
    shape_mm: float | None = None,
) -> Taking:
    """A foil woven from a distribution as the recipe's camera shows it.

    Args:
        file: Recipe of the photograph, of a stochastic foil.
        distribution: In place of its own.
        folder: Where files go.
        name: Of the photograph.
        seed: Of foil, bumps and noise.
        shape_mm: Of the foil in place of its own; pixels are then looked at in four places.
    """
    simulation = read_simulation(file)
    foil = read_recipe(file.parent / simulation.foil).model_dump(mode="json")
    distribution.write(folder / f"{name}.distribution.json")
    foil |= {"distribution": {"kind": "file", "file": f"{name}.distribution.json"}, "seed": seed}
    changes: dict[str, Any] = {"foil": f"{name}.foil.json", "seed": seed}
    if shape_mm is not None:
        foil["shape_mm"] = shape_mm
        changes["subpixels"] = 2
    (folder / f"{name}.foil.json").write_text(json.dumps(foil), "utf-8")
    changed = simulation.model_copy(update=changes)
    capture_file = simulated(changed, folder / f"{name}.json", folder / name)
    capture = read_capture(capture_file, "flash")
    (shot,) = read_shots(capture, capture_file.parent, lambda _: None).shots
    return Taking(name, shot, capture.sample.size_mm)


def estimated(taking: Taking, method: Method) -> GratingDistribution:
    """The distribution by its photograph."""
    return estimate_distribution([taking.shot], taking.size_mm, method=method).distribution


def light_on_sample(taking: Taking) -> Array:
    """What gratings show beyond the highlight, over irradiance, blurred and read every `PITCH`.

    Returns:
        Shape (rows, columns), from the sample's lower left corner, summing to 1.
    """
    shot, half = taking.shot, np.array(taking.size_mm) / 2
    row, column = np.nonzero(shot.usable)
    points = shot.rectification.on_sample(np.stack([column, row], axis=1).astype(np.float64))
    h, irradiance = half_vectors(points, shot.rectification.eye, shot.light)
    good = np.hypot(h[:, 0], h[:, 1]) > HIGHLIGHT * lobe_deviation(shot.radius, ROUGHNESS)
    good &= np.all(np.abs(points) < half, axis=1)
    light = (shot.values[row, column].sum(axis=1) / irradiance)[good]
    columns, rows = (round(2 * side / PITCH) for side in half)
    across, up = np.floor((points[good] + half) / PITCH).astype(np.intp).T
    lit = np.maximum(light - np.median(light), 0)
    binned = np.bincount(up * columns + across, lit, rows * columns).reshape(rows, columns)
    blurred = gaussian_filter(binned, 1, mode="constant")
    return blurred / blurred.sum()


def _true(file: Path) -> GratingDistribution:
    foil = read_simulation(file).foil
    recipe = read_recipe(file.parent / foil)
    assert recipe.kind == "foil" and recipe.design == "stochastic"
    return distribution_of(recipe, (file.parent / foil).parent)


def _row(simulation: Simulation, figure: str, unit: str, values: Iterable[float]) -> Acquisition:
    found = np.array(list(values))
    electrons = simulation.sensor.full_well
    assert electrons is not None
    return Acquisition(
        case=CASE,
        figure=f"earth mover's {figure}",
        unit=unit,
        truth=0.0,
        value=float(found.mean()),
        spread=float(found.std()),
        photographs=1,
        noise_db=10 * float(np.log10(electrons)),  # √n of n electrons, at white
    )
