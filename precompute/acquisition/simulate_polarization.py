"""Photographs of a foil that nobody took: a panel's polarised light through a turning polariser.

Each point returns the panel's light as Eq. 4 to 6 of the 2018 paper have it (`jones`), brighter by
the square of its period: what the paper concludes from its Eq. 11, a heuristic, since the same
area of a finer grating holds more lines, which return the same light altogether.

Left out: orders other than the mirror's, which a large panel's rim may send into the camera;
interference within the plastic but for one reflection at its upper side; what a grating's profile
and period do to R, which is the same for all; vignetting, defocus and scatter in the lens, a
polariser that lets through some of what it should stop, a panel not quite circularly polarised;
demosaicing; shadows of bumps.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from precompute.acquisition.capture import Bracket, Capture, Photograph, Sample
from precompute.acquisition.jones import (
    Obliquity,
    Plastic,
    fresnel_ratio,
    global_offset,
    intensity,
    reflected,
)
from precompute.acquisition.pattern import Gratings, gratings_of, texel_indices
from precompute.acquisition.photographs import write_photograph
from precompute.acquisition.pixel_points import pixel_points
from precompute.acquisition.polarization_simulation import (
    PolarizationSimulation,
    read_polarization_simulation,
)
from precompute.acquisition.sensor import noisy, sensitivity, transmittance, write_response
from precompute.acquisition.simulate import SmoothField, foil_of
from precompute.acquisition.view import View, corners_of, seen_at
from precompute.files import written_aside
from precompute.progress import tracked
from precompute.spectra import WAVELENGTHS, illuminant, refractive_index

Array = NDArray[np.float64]

ROWS = 64
"""Rows of a photograph that are made at once."""

UNSEEN = 1e-3
"""Share of a channel's largest response below which a wavelength is left out."""

NOMINAL = 0.55
"""Wavelength of stated retardations, µm."""


@dataclass(frozen=True)
class Optics:
    """What one wavelength meets.

    Attributes:
        metal: Its complex index.
        ratio: R of the gratings.
        plastic: Over them.
        weights: Of the wavelength in each channel, shape (channels,).
    """

    metal: complex
    ratio: complex
    plastic: Plastic
    weights: Array


@dataclass(frozen=True)
class Pose:
    """How one photograph departs from what is noted of it.

    Attributes:
        polariser: The polariser's own ψ, rad.
        shift: What the camera shows is so far off, px, shape (2,).
        turn: And turned by so much about the picture's middle, clockwise as it is seen, rad.
        light: Brightness of the panel.
    """

    polariser: float
    shift: Array
    turn: float
    light: float

    def steady(self, pixels: Array, size_px: tuple[int, int]) -> Array:
        """Where a camera that had not moved shows, px, what pixels x, y, shape (n, 2), show."""
        middle = (np.array(size_px) - 1) / 2
        x, y = (pixels - self.shift - middle).T
        cosine, sine = np.cos(self.turn), np.sin(self.turn)
        return np.stack([cosine * x + sine * y, cosine * y - sine * x], axis=1) + middle


def simulate_polarization(file: Path, folder: Path) -> Path:
    """Simulate the capture of a recipe.

    Args:
        file: The recipe.
        folder: Where a folder named as the recipe is made (see `simulated_polarization`).

    Returns:
        The capture file.

    Raises:
        InputError: The recipe or one that it names is not one, or a number in it cannot be used.
    """
    recipe = read_polarization_simulation(file)
    return simulated_polarization(recipe, file, folder / file.stem)


def simulated_polarization(simulation: PolarizationSimulation, file: Path, folder: Path) -> Path:
    """Simulate a capture.

    Args:
        simulation: What to photograph, and how.
        file: Its recipe's; other files that it names are looked for beside it.
        folder: Where ``capture.json``, the photographs, the camera's response and, in ``truth``,
            the foil's map and how photographs depart from what is noted are written.

    Returns:
        The capture file.

    Raises:
        InputError: As `simulate_polarization`.
    """
    foil, _ = foil_of(file, simulation.foil)
    rng = np.random.default_rng(simulation.seed)
    tile = foil.constants["tile_mm"]
    scene = Scene(simulation, gratings_of(foil), np.array(tile), rng)
    response = sensitivity(simulation.camera, file.parent)
    optics = optics_of(simulation, response, file.parent)
    poses = [_pose(simulation, index, rng) for index in range(len(simulation.polariser_deg))]
    photographs = []
    for index, pose in enumerate(poses):
        rows = range(0, simulation.size_px[1], ROWS)
        strips = [
            scene.strip(pose, optics, start) for start in tracked(rows, f"Photograph {index}")
        ]
        light = np.concatenate(strips)
        photographs.append(_written(simulation, index, light, folder, rng))
    foil.write(folder / "truth", "foil")
    _write_truth(simulation, poses, optics, folder / "truth" / "polarization.json")
    _capture(simulation, photographs, response, folder).write(folder / "capture.json")
    return folder / "capture.json"


def optics_of(simulation: PolarizationSimulation, response: Array, folder: Path) -> list[Optics]:
    """The wavelengths that are seen, and what they meet.

    Args:
        simulation: Panel, filter, metal and plastic.
        response: The camera's sensitivity, shape (401, channels).
        folder: Where a spectrum's CSV is.

    Returns:
        In all a mirror weighs 1 in the most sensitive channel.

    Raises:
        InputError: The spectrum's CSV cannot be read or used.
    """
    named = simulation.panel.spectrum
    panel = illuminant(folder / named if named.endswith(".csv") else named)
    weights = (panel * transmittance(simulation.filter))[:, None] * response
    # From the brightest wavelength on: a narrow filter's may lie between steps from the first.
    brightest = int(weights.max(axis=1).argmax())
    used = np.arange(brightest % simulation.step_nm, len(WAVELENGTHS), simulation.step_nm)
    used = used[weights[used].max(axis=1) >= UNSEEN * weights.max()]
    weights = weights / weights[used].sum(axis=0).max()
    return [_at_wavelength(simulation, float(WAVELENGTHS[i]), weights[i]) for i in used]


def _at_wavelength(simulation: PolarizationSimulation, λ: float, weights: Array) -> Optics:
    metal, layer = simulation.metal, simulation.plastic
    index = complex(refractive_index(metal.kind, λ))
    if metal.ratio is None:
        ratio = complex(fresnel_ratio(index, layer.index, np.radians(metal.angle_deg)))
    else:
        ratio = metal.ratio.r * np.exp(1j * np.radians(metal.ratio.zeta_deg))
    plastic = Plastic(
        retardation=np.radians(layer.retardation_deg) * NOMINAL / λ,
        axis=np.radians(layer.axis_deg),
        first_surface=simulation.first_surface,
        first_phase=np.radians(layer.first_surface_phase_deg),
        first_retardation=np.radians(layer.first_surface_retardation_deg) * NOMINAL / λ,
    )
    return Optics(index, ratio, plastic, weights)


class Scene:
    """A sheet under a panel, before a camera.

    Args:
        simulation: What is where.
        gratings: The tile's texels, shape (rows, columns).
        tile: Its width and height, mm.
        rng: Draws the bumps.
    """

    def __init__(
        self,
        simulation: PolarizationSimulation,
        gratings: Gratings,
        tile: Array,
        rng: np.random.Generator,
    ) -> None:
        self.simulation = simulation
        self.view = View.of(simulation.camera, simulation.size_px)
        self.gratings = gratings
        self.tile = tile
        sheet = simulation.sheet
        self.size = np.array(sheet.size_mm)
        self.slopes = SmoothField(rng, self.size, sheet.bump_mm, np.radians(sheet.bumps_deg))
        lowest = gratings.frequency[gratings.strength > 0].min()
        with np.errstate(divide="ignore", invalid="ignore"):
            period = np.where(gratings.strength > 0, lowest / gratings.frequency, 0.0)
        self.brightness = (period**2).ravel()

    def texels(self, xy: Array) -> NDArray[np.intp]:
        """The texel at points of the plane, shape (n, 2), mm: flat indices, −1 beside the sheet.

        Args:
            xy: Points of the plane, mm, shape (n, 2).
        """
        place = (xy + self.size * [0.5, -0.5]) / self.tile
        texels = texel_indices(self.gratings.orientation.shape, place)
        return np.where(np.all(np.abs(xy) <= self.size / 2, axis=1), texels, -1)

    def strip(self, pose: Pose, optics: list[Optics], start: int) -> Array:
        """Rows of a photograph from `start` on, full scales per s, (rows, width, channels)."""
        width, height = self.simulation.size_px
        stop = min(start + ROWS, height)
        x, y = np.meshgrid(np.arange(width), np.arange(start, stop))
        points = pixel_points(
            np.stack([x.ravel(), y.ravel()], axis=1).astype(np.float64),
            lambda pixels: self.view.on_sample(pose.steady(pixels, (width, height))),
            self.texels,
            self.gratings,
            self.simulation.subpixels,
        )
        values = points.gathered(self.light(points.xy, points.texels, pose.polariser, optics))
        return pose.light * values.reshape(stop - start, width, -1)

    def light(
        self, xy: Array, texels: NDArray[np.intp], polariser: float, optics: list[Optics]
    ) -> Array:
        """What points show through the polariser, over a mirror before the panel's middle.

        Args:
            xy: On the plane of the sheet, mm, shape (n, 2).
            texels: The texel there, −1 beside the sheet, shape (n,).
            polariser: ψ, rad.
            optics: The wavelengths.

        Returns:
            A ratio, shape (n, channels).
        """
        sheet, panel = self.simulation.sheet, self.simulation.panel
        total = np.sum([part.weights for part in optics], axis=0)
        # The share of the panel's disc in all that shines on a point, from the middle of the sheet.
        disc = panel.radius_mm**2
        shine = disc / (disc + panel.position_mm[2] ** 2)
        on_sheet = texels >= 0
        matte = np.where(on_sheet, sheet.haze, sheet.table)
        strength = np.where(on_sheet, self.gratings.strength.ravel()[texels], 0.0)
        if sheet.bare == "matte":
            matte = matte + np.where(on_sheet, (1 - strength) * sheet.bare_albedo, 0.0)
        result = (shine * matte)[:, None] * total

        rows = np.flatnonzero(on_sheet)
        radiance, φ, plane = self._mirrored(xy[rows])
        strength = strength[rows]
        orientation = self.gratings.orientation.ravel()[texels[rows]]
        shown = [(strength * self.brightness[texels[rows]], True)]
        if sheet.bare == "mirror":
            shown.append((1 - strength, False))
        for part in optics:
            oblique = Obliquity(plane, fresnel_ratio(part.metal, self.simulation.plastic.index, φ))
            for share, diffracts in shown:
                seen = np.flatnonzero(share)
                if not len(seen):
                    continue
                wave = reflected(
                    orientation[seen],
                    part.ratio if diffracts else -1,
                    part.plastic,
                    Obliquity(oblique.plane[seen], oblique.ratio[seen]),
                )
                values = share[seen] * radiance[seen] * intensity(wave, polariser)
                result[rows[seen]] += values[:, None] * part.weights
        return result

    def _mirrored(self, xy: Array) -> tuple[Array, Array, Array]:
        """What the panel sends by the mirror's law: radiance, angle and plane of incidence, rad."""
        panel, eye = self.simulation.panel, self.simulation.camera.position_mm
        assert eye is not None
        position = np.concatenate([xy, np.zeros((len(xy), 1))], axis=1)
        to_eye = eye - position
        to_eye /= np.linalg.norm(to_eye, axis=1, keepdims=True)
        n = np.concatenate([-self.slopes.at(xy), np.ones((len(xy), 1))], axis=1)
        n /= np.linalg.norm(n, axis=1, keepdims=True)
        cosine = np.sum(n * to_eye, axis=1)
        to_light = 2 * cosine[:, None] * n - to_eye
        across = (to_eye - cosine[:, None] * n)[:, :2]
        up = np.maximum(to_light[:, 2], 1e-6)
        met = xy + to_light[:, :2] * (panel.position_mm[2] / up)[:, None]
        inside = np.hypot(*(met - panel.position_mm[:2]).T) <= panel.radius_mm
        radiance = np.where(inside, up**panel.falloff, 0.0)
        return radiance, np.arccos(np.minimum(cosine, 1)), np.arctan2(across[:, 1], across[:, 0])


def _pose(simulation: PolarizationSimulation, index: int, rng: np.random.Generator) -> Pose:
    handling = simulation.handling
    noted = np.radians(simulation.polariser_deg[index])
    ψ, x, y, turn, light = rng.standard_normal(5) * (index > 0)
    return Pose(
        polariser=float(noted + np.radians(handling.polariser_deg) * ψ),
        shift=handling.shift_px * np.array([x, y]),
        turn=float(np.radians(handling.turn_deg) * turn),
        light=float(np.exp(handling.light * light)),
    )


def _written(
    simulation: PolarizationSimulation,
    index: int,
    light: Array,
    folder: Path,
    rng: np.random.Generator,
) -> Photograph:
    """The photograph's files, and what the capture says of it."""
    sensor = simulation.sensor
    brackets = []
    for number, exposure in enumerate(simulation.exposures_s):
        mark = f"-{number}" if len(simulation.exposures_s) > 1 else ""
        file = folder / f"polarization-{index}{mark}.{sensor.file}"
        values = noisy(exposure * light, sensor, rng)
        write_photograph(file, values, sensor.bits, simulation.camera, exposure)
        brackets.append(Bracket(file=file.name, exposure_s=exposure))
    fields = {"polariser_deg": simulation.polariser_deg[index], "filter": simulation.filter}
    if "photographs.corners_px" not in simulation.omit:
        view = View.of(simulation.camera, simulation.size_px)
        fields["corners_px"] = seen_at(view, corners_of(simulation.sheet.size_mm))
    if len(brackets) > 1:
        return Photograph(brackets=tuple(brackets), **fields)
    return Photograph(file=brackets[0].file, exposure_s=brackets[0].exposure_s, **fields)


def _capture(
    simulation: PolarizationSimulation,
    photographs: list[Photograph],
    response: Array,
    folder: Path,
) -> Capture:
    omit = {name.split(".")[1] for name in simulation.omit}
    camera = simulation.camera.model_dump(exclude={"spectral_response_csv"})
    if "spectral_response_csv" not in omit:
        camera["spectral_response_csv"] = "camera.csv"
        write_response(folder / "camera.csv", simulation.camera, response)
    return Capture(
        method="polarization",
        sample=Sample(size_mm=simulation.sheet.size_mm),
        camera=type(simulation.camera)(**{k: v for k, v in camera.items() if k not in omit}),
        photographs=tuple(photographs),
    )


def _write_truth(
    simulation: PolarizationSimulation, poses: list[Pose], optics: list[Optics], file: Path
) -> None:
    """What a solver should find besides the map: the offset from phases to θ, and the poses."""
    brightest = max(optics, key=lambda part: float(part.weights.max()))
    contents = {
        "offset_deg": np.degrees(global_offset(brightest.ratio, brightest.plastic)),
        "photographs": [
            {
                "polariser_deg": np.degrees(pose.polariser),
                "shift_px": pose.shift.tolist(),
                "turn_deg": np.degrees(pose.turn),
                "light": pose.light,
            }
            for pose in poses
        ],
    }
    with written_aside(file) as aside:
        aside.write_text(json.dumps(contents, indent=1) + "\n", "utf-8")
