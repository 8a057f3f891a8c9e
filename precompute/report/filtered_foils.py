"""What the filter of orientations does: errors over its passes, and how foils look by then."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from precompute.acquisition.orientation_filter import FilterOptions, filtered_orientation
from precompute.acquisition.pattern import Gratings, gratings_of, texel_indices
from precompute.acquisition.radiance import Lamp, Relief, foil_radiance
from precompute.files import written_aside
from precompute.foils.bumps import random_bumps
from precompute.maps import Map
from precompute.profiles import Sinusoidal
from precompute.report.polarized_photographs import PolarizedPhotographs
from precompute.report.rows import Acquisition
from precompute.spectra import WAVELENGTH_STEP, colour_weights, xyz_to_linear_srgb

Array = NDArray[np.float64]

PICTURE = "acquisition-filtered.png"

DESIGN = "logo"
BUMPS_DEG, NOISE = 0.3, 0.03
"""Of the sheet that is filtered, and of its photographs, of full scale."""

BUMP_MM = 3.0
"""Correlation length of bumps that are drawn."""

PASSES = (0, 1, 3, 10, 50)

STEP_DEG, STEP_NOISE_DEG, STEP_SIZE = 30.0, 5.0, 64
"""A step between two orientations, and independent errors of both; of so many texels a side."""

WORN_DEG = 5.0
"""A texel that is so far off belongs to neither side any more: ten times the noise that is left."""

FILTERS = {
    "step of 30°": FilterOptions(),
    "step of 30°, constant width": FilterOptions(range=0.35, deviations=0),
}
"""Ours, and one whose width is the 2018 paper's σ_θ whatever is known of texels."""

LIGHTS_MM = ((70.0, 20.0, 150.0), (-20.0, 75.0, 150.0), (-60.0, -50.0, 150.0))
"""Flashes under which maps are drawn, and the camera."""

EYE_MM = (0.0, 0.0, 250.0)

ACROSS = 200
"""Points across a drawn sheet."""


def filter_rows(work: Path, pictures: Path) -> Iterator[Acquisition]:
    """Rows of the 2018 paper's 5.3 and 6.2.

    Args:
        work: A folder for photographs, which may be deleted afterwards.
        pictures: Folder for `PICTURE`.
    """
    taken = PolarizedPhotographs.of(DESIGN, work / "filtered", noise=NOISE, bumps_deg=BUMPS_DEG)
    for name, options in FILTERS.items():
        for passes, away in step_wear(options).items():
            figure = f"worn texels' largest distance from it, {passes} passes"
            row = taken.row(name, figure, "px", away)
            is_seed = options.deviations == 0
            yield row.model_copy(update={"photographs": 1, "noise_db": None, "seed": is_seed})
    maps = {"photographed": taken.truth}
    case = f"{DESIGN}, bumps of {BUMPS_DEG}°, noise of {NOISE:.0%}"
    for passes in PASSES:
        acquired = taken.acquired(passes=passes, periods=taken.periods)
        maps[f"{passes} passes"] = acquired.foil
        off = taken.off(acquired)
        figure = f"orientation, mean error, {passes} passes"
        yield taken.row(case, figure, "deg", float(off.mean()), spread=float(off.std()))
    del maps["1 passes"], maps["3 passes"]
    _draw(maps, pictures / PICTURE)


def step_wear(options: FilterOptions) -> dict[int, float]:
    """How far from a step texels are `WORN_DEG` off, px, after each of `PASSES`."""
    rng = np.random.default_rng(1)
    σ = np.radians(STEP_NOISE_DEG)
    column = np.arange(STEP_SIZE) - STEP_SIZE / 2 + 0.5
    truth = np.radians(STEP_DEG) * (column > 0) + np.zeros((STEP_SIZE, 1))
    worn: dict[int, float] = {}

    def measure(passes: int, θ: NDArray[np.float32]) -> None:
        if passes in PASSES:
            off = np.abs(np.mod(θ - truth + np.pi / 2, np.pi) - np.pi / 2)
            wrong = (off > np.radians(WORN_DEG)).any(axis=0)
            worn[passes] = float(np.abs(column[wrong]).max() + 0.5) if wrong.any() else 0.0

    noisy = truth + σ * rng.standard_normal(truth.shape)
    many = FilterOptions(**{**vars(options), "iterations": max(PASSES)})
    filtered_orientation(noisy, σ, np.ones(truth.shape, bool), many, measure)
    return worn


def _draw(maps: dict[str, Map], file: Path) -> None:
    """Maps under flashes (Fig. 18), the last of them with bumps too."""
    last = list(maps)[-1]
    shown = [(name, foil, 0.0) for name, foil in maps.items()]
    shown.append((f"{last}, bumps", maps[last], BUMPS_DEG))
    figure = Figure((2 * len(shown), 2.1 * len(LIGHTS_MM)), 100, layout="constrained")
    rows = figure.subplots(len(LIGHTS_MM), len(shown))
    for row, light in zip(rows, LIGHTS_MM, strict=True):
        pictures = [_rendered(foil, bumps, light) for _, foil, bumps in shown]
        white = np.percentile(pictures[0].max(axis=-1), 97)
        for axes, picture, (name, _, _) in zip(row, pictures, shown, strict=True):
            axes.imshow(np.clip(picture / white, 0, 1) ** (1 / 2.2))
            axes.set(xticks=[], yticks=[])
            if light == LIGHTS_MM[0]:
                axes.set_title(name, fontsize=9)
    with written_aside(file) as aside:
        figure.savefig(aside, format="png")


def _rendered(foil: Map, bumps_deg: float, light: tuple[float, float, float]) -> Array:
    """A tile under a flash by the reference, linear sRGB, shape (rows, columns, 3)."""
    size = np.broadcast_to(foil.constants["tile_mm"], 2)
    along = (np.arange(ACROSS) + 0.5) / ACROSS
    place = np.stack(np.meshgrid(along, 1 - along), axis=-1).reshape(-1, 2)
    texels = gratings_of(foil)
    flat = Gratings(*(part.ravel() for part in vars(texels).values()))
    gratings = flat[texel_indices(texels.orientation.shape, place)]
    points = (place - 0.5) * size
    tilts = np.zeros_like(points)
    if bumps_deg > 0:
        slope = np.tan(np.radians(bumps_deg))
        bumps = random_bumps((ACROSS, ACROSS), (float(size[0]), float(size[1])), slope, BUMP_MM, 2)
        tilts = -bumps.normal.reshape(-1, 2)
    weights = colour_weights("1931-2", "D65") @ xyz_to_linear_srgb("1931-2", "D65").T
    lamp = Lamp(np.array(light), np.radians(0.7), weights * WAVELENGTH_STEP)
    height = float(np.ravel(foil.constants["height_um"])[0])
    relief = Relief(height, Sinusoidal(), 16.25, np.radians(0.2))
    picture = foil_radiance(points, tilts, gratings, relief, np.array(EYE_MM), lamp, step=8)
    return np.maximum(picture, 0).reshape(ACROSS, ACROSS, 3)
