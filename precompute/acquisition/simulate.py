"""Photographs of a foil that nobody took: flash captures from the float64 reference.

Left out: vignetting, defocus and scatter in the lens; demosaicing, each pixel has all channels;
light that is reflected more than once; a source that looks smaller from afar; shadows of bumps.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter, map_coordinates

from precompute.acquisition.capture import Bracket, Capture, Photograph, Sample
from precompute.acquisition.pattern import Gratings, gratings_of, texel_indices
from precompute.acquisition.photographs import write_photograph
from precompute.acquisition.pixel_points import pixel_points
from precompute.acquisition.radiance import Lamp, Relief, foil_radiance
from precompute.acquisition.sensor import channel_weights, noisy, sensitivity, write_response
from precompute.acquisition.simulation import Flash, Simulation, read_simulation
from precompute.acquisition.view import View, corners_of, seen_at
from precompute.bake import baked_maps
from precompute.errors import InputError
from precompute.files import written_aside
from precompute.maps import Map
from precompute.profiles import Profile
from precompute.progress import tracked
from precompute.recipes import ProfileRecipe, read_recipe
from precompute.spectra import WAVELENGTH_STEP

Array = NDArray[np.float64]

ROWS = 64
"""Rows of a photograph that are made at once: some MB of reference."""

UNSEEN = 1e-6
"""Share of a channel's largest response below which a wavelength is left out."""


@dataclass(frozen=True)
class Sheet:
    """A foil's tile repeated over a sheet, with all that is off.

    Attributes:
        size: Width and height, mm.
        tile: Width and height of a tile, mm.
        gratings: The tile's texels, shape (rows, columns).
        shifts: By how much each tile is off its place, mm, shape (tile rows, tile columns, 2).
        warp: A smooth displacement of the pattern, mm.
        slopes: ∂z/∂x and ∂z/∂y of the surface.
    """

    size: Array
    tile: Array
    gratings: Gratings
    shifts: Array
    warp: SmoothField
    slopes: SmoothField

    def inside(self, xy: Array) -> NDArray[np.bool_]:
        """Which points, shape (n, 2), mm, are on the sheet.

        Args:
            xy: Points of the plane, mm, shape (n, 2).
        """
        return np.all(np.abs(xy) <= self.size / 2, axis=1)

    def texels_or_none(self, xy: Array) -> NDArray[np.intp]:
        """`texels`, −1 beside the sheet.

        Args:
            xy: Points of the plane, mm, shape (n, 2).
        """
        return np.where(self.inside(xy), self.texels(xy), -1)

    def texels(self, xy: Array) -> NDArray[np.intp]:
        """The texel that shows at points of the sheet, shape (n, 2), mm: flat indices.

        Args:
            xy: Points of the plane, mm, shape (n, 2).
        """
        place = (xy - self.warp.at(xy) + [self.size[0] / 2, -self.size[1] / 2]) / self.tile
        column = np.clip(np.floor(place[:, 0]), 0, self.shifts.shape[1] - 1).astype(int)
        row = np.clip(np.floor(-place[:, 1]), 0, self.shifts.shape[0] - 1).astype(int)
        shifted = place - self.shifts[row, column] / self.tile
        return texel_indices(self.gratings.orientation.shape, shifted)


class SmoothField:
    """Two smooth random numbers at each point of a sheet.

    Args:
        rng: What it is drawn from.
        size: The sheet's width and height, mm.
        width: Standard deviation of the Gaussian that white noise is blurred with, mm.
        deviation: Standard deviation of each of the two.
    """

    def __init__(
        self, rng: np.random.Generator, size: Array, width: float, deviation: float
    ) -> None:
        self.pitch = width / 4
        margin = 4 * self.pitch
        count = np.ceil((size[::-1] + 2 * margin) / self.pitch).astype(int) + 1
        self.corner = -size / 2 - margin
        noise = rng.standard_normal((2, *count))
        self.values = np.stack([gaussian_filter(layer, 4) for layer in noise])
        self.values *= deviation / self.values.std()

    def at(self, xy: Array) -> Array:
        """The two numbers at points, shape (n, 2), mm; beyond the sheet those of its edge.

        Args:
            xy: Points of the plane, mm, shape (n, 2).
        """
        columns, rows = ((xy - self.corner) / self.pitch).T
        return np.stack(
            [map_coordinates(v, [rows, columns], order=1, mode="nearest") for v in self.values],
            axis=1,
        )


def simulate_flash(file: Path, folder: Path) -> Path:
    """Simulate the capture of a recipe.

    Args:
        file: The recipe.
        folder: Where a folder named as the recipe is made (see `simulated`).

    Returns:
        The capture file.

    Raises:
        InputError: The recipe or one that it names is not one, or a number in it cannot be used.
    """
    return simulated(read_simulation(file), file, folder / file.stem)


def simulated(simulation: Simulation, file: Path, folder: Path) -> Path:
    """Simulate a capture.

    Args:
        simulation: What to photograph, and how.
        file: Its recipe's; other files that it names are looked for beside it.
        folder: Where ``capture.json``, the photographs, the camera's response and, in ``truth``,
            the foil's map and the tiles' shifts are written.

    Returns:
        The capture file.

    Raises:
        InputError: As `simulate_flash`.
    """
    foil, profile = foil_of(file, simulation.foil)
    rng = np.random.default_rng(simulation.seed)
    sheet = _sheet(simulation, foil, rng)
    response = sensitivity(simulation.camera, file.parent)
    size = simulation.size_px
    photographs = []
    for index, flash in enumerate(simulation.photographs):
        weights = channel_weights(flash.light, flash.filter, response, file.parent)
        weights[weights.max(axis=1) < UNSEEN * weights.max()] = 0
        unfiltered = channel_weights(flash.light, None, response, file.parent)
        lamp = Lamp(
            np.array(flash.light.position_mm),
            float(np.radians(flash.light.radius_deg)),
            weights / _white_sheet(unfiltered, flash),
        )
        rows = [
            _strip(simulation, sheet, _relief(simulation, foil, profile), lamp, start)
            for start in tracked(range(0, size[1], ROWS), f"Photograph {index}")
        ]
        photographs.append(
            _written(simulation, flash, np.concatenate(rows), folder, f"flash-{index}", rng)
        )
        if flash.light.spectrum.endswith(".csv"):
            copied(file.parent / flash.light.spectrum, folder)
    _write_truth(foil, sheet, folder / "truth")
    stochastic = foil.recipe["design"] == "stochastic"
    capture = _capture(simulation, sheet, stochastic, photographs, response, folder)
    capture.write(folder / "capture.json")
    return folder / "capture.json"


def foil_of(file: Path, named: str) -> tuple[Map, Profile]:
    """The map of the foil that a capture's recipe names, and its gratings' profile.

    Args:
        file: The capture's recipe.
        named: The foil's, relative to it.

    Raises:
        InputError: It cannot be read, or is no foil's.
    """
    recipe = read_recipe(file.parent / named)
    if recipe.kind != "foil":
        raise InputError(file, "foil", named, "the recipe of a foil")
    _, foil = next(iter(baked_maps(recipe, file.parent / named)))
    profile = ProfileRecipe.model_validate({"kind": "profile", "profile": recipe.profile}).profile
    return foil, profile


def _relief(simulation: Simulation, foil: Map, profile: Profile) -> Relief:
    height = foil.constants["height_um"]
    assert isinstance(height, float)
    return Relief(height, profile, simulation.surface.coherence_um, simulation.roughness)


def _sheet(simulation: Simulation, foil: Map, rng: np.random.Generator) -> Sheet:
    surface = simulation.surface
    size, tile = np.array(surface.size_mm), np.array(foil.constants["tile_mm"])
    columns, rows = (int(n) for n in np.ceil(size / tile))
    turn = rng.uniform(0, 2 * np.pi, (rows, columns))
    shifts = surface.shift_mm * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    return Sheet(
        size,
        tile,
        gratings_of(foil),
        shifts - shifts[*_middle(shifts)],  # the reference tile is where it belongs
        SmoothField(rng, size, float(tile.max()) / 2, surface.warp_mm),
        SmoothField(rng, size, surface.bump_mm, np.radians(surface.bumps_deg)),
    )


def _middle(shifts: Array) -> tuple[int, int]:
    return (shifts.shape[0] - 1) // 2, (shifts.shape[1] - 1) // 2


def _white_sheet(weights: Array, flash: Flash) -> float:
    """What the most sensitive channel sees of a white matt sheet at the sample's centre."""
    position = np.array(flash.light.position_mm)
    cosine = position[2] / np.linalg.norm(position)
    return float(WAVELENGTH_STEP * weights.sum(axis=0).max() * cosine / np.pi)


def _strip(simulation: Simulation, sheet: Sheet, relief: Relief, lamp: Lamp, start: int) -> Array:
    """Rows of a photograph from `start` on, in full scales per second, (rows, width, channels)."""
    width, height = simulation.size_px
    stop = min(start + ROWS, height)
    x, y = np.meshgrid(np.arange(width), np.arange(start, stop))
    pixels = np.stack([x.ravel(), y.ravel()], axis=1).astype(np.float64)
    view = View.of(simulation.camera, simulation.size_px)
    points = pixel_points(
        pixels, view.on_sample, sheet.texels_or_none, sheet.gratings, simulation.subpixels
    )
    radiance = _points(simulation, sheet, relief, lamp, points.xy, points.texels)
    return points.gathered(radiance).reshape(stop - start, width, -1)


def _points(
    simulation: Simulation,
    sheet: Sheet,
    relief: Relief,
    lamp: Lamp,
    points: Array,
    texels: NDArray[np.intp],
) -> Array:
    """Radiance of points of the sheet, and of the table where there is no texel (−1)."""
    assert simulation.camera.position_mm is not None
    towards = lamp.position - np.concatenate([points, np.zeros((len(points), 1))], axis=1)
    squared = np.sum(towards**2, axis=1)
    irradiance = lamp.position[2] / np.sqrt(squared) * np.sum(lamp.position**2) / squared
    on_sheet = texels >= 0
    albedo = np.where(on_sheet, simulation.surface.haze, simulation.surface.table)
    matt = (albedo * irradiance / np.pi)[:, None] * WAVELENGTH_STEP * lamp.weights.sum(axis=0)
    rows = np.flatnonzero(on_sheet)
    flat = Gratings(*(part.ravel() for part in vars(sheet.gratings).values()))
    matt[rows] += foil_radiance(
        points[rows],
        sheet.slopes.at(points[rows]),
        flat[texels[rows]],
        relief,
        np.array(simulation.camera.position_mm),
        lamp,
        simulation.step_nm,
    )
    return matt


def _written(
    simulation: Simulation,
    flash: Flash,
    radiance: Array,
    folder: Path,
    name: str,
    rng: np.random.Generator,
) -> Photograph:
    """The photograph's files, and what the capture says of it."""
    sensor = simulation.sensor
    brackets = []
    for index, exposure in enumerate(flash.exposures_s):
        values = noisy(exposure * radiance, sensor, rng)
        mark = f"-{index}" if len(flash.exposures_s) > 1 else ""
        file = folder / f"{name}{mark}.{sensor.file}"
        write_photograph(file, values, sensor.bits, simulation.camera, exposure)
        brackets.append(Bracket(file=file.name, exposure_s=exposure))
    view = View.of(simulation.camera, simulation.size_px)
    corners = seen_at(view, corners_of(simulation.surface.size_mm))
    light = flash.light.model_copy(update={"spectrum": Path(flash.light.spectrum).name})
    fields = {"light": light, "filter": flash.filter}
    if "photographs.corners_px" not in simulation.omit:
        fields["corners_px"] = corners
    if len(brackets) > 1:
        return Photograph(brackets=tuple(brackets), **fields)
    return Photograph(file=brackets[0].file, exposure_s=brackets[0].exposure_s, **fields)


def _capture(
    simulation: Simulation,
    sheet: Sheet,
    stochastic: bool,
    photographs: list[Photograph],
    response: Array,
    folder: Path,
) -> Capture:
    omit = {name.split(".")[1] for name in simulation.omit}
    row, column = _middle(sheet.shifts)
    left, top = sheet.tile * [column, -row] + [-sheet.size[0] / 2, sheet.size[1] / 2]
    right, bottom = left + sheet.tile[0], top - sheet.tile[1]
    corners = [(left, top), (right, top), (right, bottom), (left, bottom)]
    tile = seen_at(View.of(simulation.camera, simulation.size_px), corners)
    sample = {
        "size_mm": simulation.surface.size_mm,
        "stochastic": stochastic,
        # That what was strewn over a tile repeats is no pattern to look for.
        "tile_mm": None if stochastic else tuple(sheet.tile.tolist()),
        "reference_tile_px": None if stochastic else tile,
    }
    camera = simulation.camera.model_dump(exclude={"spectral_response_csv"})
    if "spectral_response_csv" not in omit:
        camera["spectral_response_csv"] = "camera.csv"
        write_response(folder / "camera.csv", simulation.camera, response)
    return Capture(
        method="flash",
        sample=Sample(**{k: v for k, v in sample.items() if k not in omit}),
        camera=type(simulation.camera)(**{k: v for k, v in camera.items() if k not in omit}),
        photographs=tuple(photographs),
    )


def copied(file: Path, folder: Path) -> None:
    """A file that the recipe names, beside the capture, which names it too."""
    with written_aside(folder / file.name) as aside:
        aside.write_bytes(file.read_bytes())


def _write_truth(foil: Map, sheet: Sheet, folder: Path) -> None:
    foil.write(folder, "foil")
    with written_aside(folder / "tiles.json") as aside:
        aside.write_text(json.dumps({"shifts_mm": sheet.shifts.tolist()}) + "\n", "utf-8")
