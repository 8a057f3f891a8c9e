"""From flash photographs of a repeating foil to its map (2018 paper, section 4)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from precompute.acquisition.alignment import aligned
from precompute.acquisition.calibration import Calibration, calibrated
from precompute.acquisition.capture import Capture, read_capture
from precompute.acquisition.chance import over_chance
from precompute.acquisition.completion import NOISE, Completed, completed
from precompute.acquisition.flash_report import FlashReport, PhotographSeen, Shares
from precompute.acquisition.layout import tiling_of
from precompute.acquisition.lobe_fit import Fit
from precompute.acquisition.observations import Shot, observed, strips, texel_places
from precompute.acquisition.shots import Taken, read_shots
from precompute.acquisition.thresholds import brightest
from precompute.acquisition.tiling import Tiling
from precompute.errors import InputError
from precompute.foils.foil_map import foil_axes, foil_map
from precompute.maps import Map, Table
from precompute.spectra import WAVELENGTHS

Array = NDArray[np.float64]

MOST_TEXELS = 1024
"""Along a side of a map whose size is not asked for."""

ALIGNED_TEXELS = 128
"""Along a side, most, when tiles are aligned: a tenth of one of these is seen."""

OVER_CHANCE = 1.4
"""How much better gratings have to explain what is lit than what is lit elsewhere: of a foil it is
1.8 to 10 times as much, of anything else 0.9 to 1.1."""

CHANCE = 1.05
"""Ratio of the periods that photographs show each, up to which they agree."""


@dataclass(frozen=True)
class FlashOptions:
    """How photographs are solved.

    Attributes:
        size: Columns and rows of the map; the photographs' resolution if None.
        height: h0 of the gratings, µm, which photographs do not tell.
        is_one_period: Whether all gratings have one period; found out if None.
        method: ``lobes``, which fits them, or ``thresholds``, the seed's.
        align: Whether tiles are moved to where the pattern is.

    Raises:
        InputError: A number is out of range.
    """

    size: tuple[int, int] | None = None
    height: float = 0.15
    is_one_period: bool | None = None
    method: Literal["lobes", "thresholds"] = "lobes"
    align: bool = True

    def __post_init__(self) -> None:
        if self.size is not None and not all(8 <= side <= 4096 for side in self.size):
            raise InputError("options", "size", self.size, "8 to 4096 columns and rows")
        if not 0 < self.height <= 1:
            raise InputError("options", "height", self.height, "above 0, up to 1 µm")


@dataclass(frozen=True)
class Acquired:
    """What came of photographs.

    Attributes:
        capture: What was told of them.
        foil: The map.
        completed: What it was made from.
        calibration: What the photographs say of themselves.
        tiling: Where the tiles are.
        report: What was seen and what was filled in.
    """

    capture: Capture
    foil: Map
    completed: Completed
    calibration: Calibration
    tiling: Tiling
    report: FlashReport


def acquire_flash(file: Path, options: FlashOptions, say: Callable[[str], None]) -> Acquired:
    """Solve a capture.

    Args:
        file: The capture file.
        options: How.
        say: Takes remarks as they arise.

    Raises:
        InputError: The capture or a photograph cannot be used: see `read_capture` and `read_shots`;
            no tile repeats; nothing is lit beyond the highlight or stands out from noise; or what
            is lit are no lobes.
    """
    remarks: list[str] = []

    def remark(text: str) -> None:
        remarks.append(text)
        say(text)

    capture = read_capture(file, "flash")
    taken = read_shots(capture, file.parent, remark)
    for error in taken.left_out.values():
        remark(f"left out: {error}")
    tiling, reference = tiling_of(capture, taken.shots, str(file), remark)
    size = options.size or _resolution(taken.shots[0], tiling)
    places = texel_places(size)
    calibration = calibrated(taken.shots, tiling, places, options.height, options.is_one_period)
    if calibration is None:
        found = "darkness outside the highlights"
        raise InputError(file, "photographs", found, "lit points of a foil")
    apparent = calibration.apparent
    if apparent.max() > CHANCE * apparent.min():
        shown = ", ".join(
            f"{shot.name} {factor:.3f}" for shot, factor in zip(taken.shots, apparent, strict=True)
        )
        remark(f"photographs disagree on periods, which light.position_mm may be why: {shown}")
    better = over_chance(calibration, tiling, places)
    if better < OVER_CHANCE:
        found = f"light that gratings explain {better:.2f} times as well as chance"
        raise InputError(file, "photographs", found, f"{OVER_CHANCE:g} times or more, as of a foil")
    if NOISE * calibration.noise >= 1:
        raise _nothing_stands_out(file)
    if options.align:
        small = _at_most(size, ALIGNED_TEXELS)
        tiling = aligned(calibration, tiling, small, reference)
        again = calibrated(taken.shots, tiling, places, options.height, options.is_one_period)
        calibration = again or calibration
    fit = calibration.fit(tiling, places, "Fitting gratings")
    explained = float(fit.gain.sum() / max(fit.shown.sum(), 1e-30))
    if options.method == "thresholds":
        fit = _by_thresholds(calibration, tiling, places, fit)
    whole = completed(fit, size, calibration.noise)
    if not whole.seen.any():
        raise _nothing_stands_out(file)
    is_relative = not taken.shots[0].rectification.is_scaled
    report = _report(taken, calibration, tiling, whole, explained, is_relative, remarks)
    return Acquired(
        capture,
        _map(capture, whole, tiling, options, report),
        whole,
        calibration,
        tiling,
        report,
    )


def _nothing_stands_out(file: Path) -> InputError:
    found = "no grating that stands out from the noise"
    return InputError(file, "photographs", found, "lit points of a foil")


def _resolution(shot: Shot, tiling: Tiling) -> tuple[int, int]:
    """Columns and rows of a map as fine as the photograph."""
    pixels = tiling.size * shot.rectification.pixels_per_mm()
    columns, rows = np.maximum(np.round(pixels), 8).astype(int)
    return _at_most((int(columns), int(rows)), MOST_TEXELS)


def _at_most(size: tuple[int, int], most: int) -> tuple[int, int]:
    factor = min(1.0, most / max(size))
    return max(1, round(size[0] * factor)), max(1, round(size[1] * factor))


def _by_thresholds(calibration: Calibration, tiling: Tiling, places: Array, fit: Fit) -> Fit:
    """The fit with the seed's orientations and periods, and its thresholds as what it is worth."""
    shots = calibration.shots
    weights = sum(shot.weights.sum(axis=1) for shot in shots)
    wavelength = float(np.average(WAVELENGTHS, weights=weights))
    found = [
        brightest(observed(shots, tiling, places[part], calibration.highlight), wavelength)
        for part in strips(len(places), len(tiling.tiles()) * len(shots))
    ]
    orientation, period, threshold = (np.concatenate(column) for column in zip(*found, strict=True))
    return replace(
        fit,
        orientation=orientation,
        frequency=1 / np.maximum(period, 1e-3),
        strength=np.ones_like(threshold),
        gain=threshold,
        margin=np.ones_like(threshold),
    )


def _map(
    capture: Capture,
    whole: Completed,
    tiling: Tiling,
    options: FlashOptions,
    report: FlashReport,
) -> Map:
    gratings = whole.gratings
    foil = foil_map(
        gratings.orientation,
        gratings.frequency,
        gratings.strength,
        height=options.height,
        tile_mm=(float(tiling.size[0]), float(tiling.size[1])),
        recipe={
            "kind": "foil",
            "design": "acquired",
            "profile": "sinusoidal",
            "method": options.method,
            "report": report.model_dump(mode="json"),
            "capture": capture.model_dump(mode="json", exclude_none=True),
        },
    )
    confidence = whole.confidence[..., None]
    foil.tables["confidence"] = Table(
        confidence, foil_axes(*whole.confidence.shape), ("confidence",), "float16"
    )
    return foil


def _report(
    taken: Taken,
    calibration: Calibration,
    tiling: Tiling,
    whole: Completed,
    explained: float,
    is_relative: bool,
    remarks: list[str],
) -> FlashReport:
    frequency = whole.gratings.frequency[whole.seen]
    shifts = np.linalg.norm(tiling.shifts, axis=2)
    return FlashReport(
        photographs=[
            PhotographSeen(
                name=shot.name,
                highlight_px=(float(found.pixel[0]), float(found.pixel[1])),
                light_mm=(float(found.light[0]), float(found.light[1]), float(found.light[2])),
                light_off_mm=found.offset_mm,
                period_over_all=float(factor),
            )
            for shot, found, factor in zip(
                taken.shots, taken.highlights, calibration.apparent, strict=True
            )
        ],
        left_out={name: str(error) for name, error in taken.left_out.items()},
        tile_mm=(float(tiling.size[0]), float(tiling.size[1])),
        tiles=(tiling.shifts.shape[1], tiling.shifts.shape[0]),
        shift_mm=float(np.median(shifts)),
        largest_shift_mm=float(shifts.max()),
        roughness_deg=float(np.degrees(calibration.roughness)),
        is_one_period=calibration.is_one_period,
        is_relative=is_relative,
        periods_um=_periods(frequency),
        texels=Shares(
            **{
                name: float(getattr(whole, name).mean())
                for name in ("seen", "unsure", "dark", "hidden")
            }
        ),
        explained=explained,
        remarks=remarks,
    )


def _periods(frequency: Array) -> tuple[float, float, float]:
    shortest, median, longest = 1 / np.percentile(frequency, [99, 50, 1])
    return float(shortest), float(median), float(longest)
