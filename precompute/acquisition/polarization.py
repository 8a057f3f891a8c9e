"""From photographs through a turning polariser to a foil's map (2018 paper, section 5)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_erosion

from precompute.acquisition.blocks import Run, in_threads
from precompute.acquisition.capture import Capture, read_capture
from precompute.acquisition.diffracting import Diffracting, diffracting
from precompute.acquisition.evidence import Evidence, PhotographError
from precompute.acquisition.orientation_filter import FilterOptions, filtered_orientation
from precompute.acquisition.polarization_fit import Pixels, distinct_angles, repeated_angles
from precompute.acquisition.polarization_report import (
    Circle,
    PhotographLaid,
    PolarizationReport,
)
from precompute.acquisition.registered_light import RegisteredLight, registered_light
from precompute.errors import InputError
from precompute.foils.foil_map import foil_axes, foil_map
from precompute.maps import Map, Table

Array = NDArray[np.float64]

DOUBT = 0.5
"""Standard deviation of a phase, rad, from which an orientation is not to be believed: 14°. Of
noise alone one pixel in eight seems better."""

PERIOD = 1.0
"""Of gratings of which nobody said it, µm."""

SHARPEST = 1e-5
"""Uncertainty of orientations, rad, below which none is: that of single precision."""

ODD, FOREIGN = 2.0, 3.0
"""How far a photograph may be off what the others foretell, over how far these are themselves:
beyond the first it is remarked on, beyond the second refused. Simulated ones are within 1.4; where
noise is a thirtieth of the modulation an angle that is wrong by 13° makes 2.2, by 27° 4, a
photograph upside down 6."""

EDGE = 2
"""Texels along edges of what diffracts that may be partly bare, and as bright as that."""

EXTREMES = (1, 99)
"""Percentiles of brightness that are taken for that of the shortest and the longest period."""


@dataclass(frozen=True)
class PolarizationOptions:
    """How photographs are solved.

    Attributes:
        size: Columns and rows of the map; the photographs' resolution if None.
        height: h0 of the gratings, µm, which photographs do not tell.
        offset: Added to half of phases, rad; unknown if None, and orientations are relative.
        periods: Shortest and longest, µm, which the darkest and brightest gratings get; equal where
            all have one. Unknown if None, and all are taken to have `PERIOD`.
        passes: Of the filter that takes noise and bumps out of orientations; ten take off another
            tenth of what three leave.

    Raises:
        InputError: A number is out of range.
    """

    size: tuple[int, int] | None = None
    height: float = 0.15
    offset: float | None = None
    periods: tuple[float, float] | None = None
    passes: int = 3

    def __post_init__(self) -> None:
        if self.size is not None and not all(8 <= side <= 8192 for side in self.size):
            raise InputError("options", "size", self.size, "8 to 8192 columns and rows")
        if not 0 < self.height <= 1:
            raise InputError("options", "height", self.height, "above 0, up to 1 µm")
        if self.offset is not None and not np.isfinite(self.offset):
            raise InputError("options", "offset", self.offset, "a finite angle")
        if self.periods is not None and not 0.1 <= self.periods[0] <= self.periods[1] <= 100:
            raise InputError("options", "periods", self.periods, "0.1 to 100 µm, the shorter first")
        if not 0 <= self.passes <= 100:
            raise InputError("options", "passes", self.passes, "0 to 100")


@dataclass(frozen=True)
class Polarized:
    """What came of photographs.

    Attributes:
        foil: The map.
        registered: The photographs on its texels.
        found: What they show.
        report: What was seen.
    """

    foil: Map
    registered: RegisteredLight
    found: Diffracting
    report: PolarizationReport


def acquire_polarization(
    file: Path,
    options: PolarizationOptions,
    say: Callable[[str], None],
    run: Run = in_threads,
) -> Polarized:
    """Solve a capture.

    Args:
        file: The capture file.
        options: How.
        say: Takes remarks as they arise.
        run: Fits and filters blocks.

    Raises:
        InputError: The capture or a photograph cannot be used: see `read_capture`,
            `registered_light` and `diffracting`; its files are not as many as it says; fewer
            than three angles differ; or a photograph does not go with four or more others.
    """
    remarks: list[str] = []

    def remark(text: str) -> None:
        remarks.append(text)
        say(text)

    capture = read_capture(file, "polarization")
    _check_files(file, capture)
    _check_angles(file, capture, remark)
    registered = registered_light(capture, file.parent, options.size, remark)
    try:
        found = diffracting(registered.light, registered.polariser, run)
    except InputError as error:
        about = InputError(file, error.field, error.value, error.expected)
        first = np.nan_to_num(np.asarray(registered.light[0]))[..., None]
        raise PhotographError(about, Evidence.of(registered.names[0], first)) from error
    _check_misfits(file.parent, registered, found.misfits, remark)
    if not found.circle.known:
        remark(
            "orientations are too few, or noise too much, to tell what all pixels have in common: "
            "which are bare and how gratings lie is a guess, and confidence is 0"
        )
    clipped = max(registered.clipped)
    if clipped > 0:
        remark(f"up to {clipped:.1%} of the sample is clipped in a photograph, and left unknown")
    if options.offset is None:
        remark("--offset is not given: orientations are right but for one angle for all")
    periods = options.periods or (PERIOD, PERIOD)
    if options.periods is None:
        remark(f"neither --period nor --periods is given: all are taken to be {PERIOD:g} µm")
    elif periods[0] < periods[1]:
        remark("periods go with the root of brightness, the 2018 paper's heuristic")
    report = _report(registered, found, options, periods, remarks)
    foil = _map(capture, found, options, periods, report, run)
    return Polarized(foil, registered, found, report)


def confidences(found: Diffracting) -> Pixels:
    """What orientations are worth, no unit: 0 where nothing diffracts or all is noise, else to 1.

    All are worth nothing where the circle is unknown: they are counted from no place in particular.
    """
    with np.errstate(invalid="ignore", over="ignore"):
        worth = np.clip(1 - (found.noise / DOUBT) ** 2, 0, 1)
    return np.where(found.mask & found.circle.known, worth, 0).astype(np.float32)


def relative_periods(found: Diffracting, periods: tuple[float, float]) -> Array:
    """The paper's heuristic (5.4): periods that go with the root of brightness, in given limits.

    Args:
        found: What photographs show.
        periods: Of the gratings that one in a hundred is darker, or brighter, than, µm.

    Returns:
        µm, shape (rows, columns); the middle one where nothing diffracts.
    """
    shortest, longest = periods
    if shortest == longest:
        return np.full(found.mask.shape, shortest)
    root = np.sqrt(np.where(found.mask, found.fit.mean, 0), dtype=np.float64)
    inside = np.asarray(binary_erosion(found.mask, iterations=EDGE), bool)
    low, high = np.percentile(root[inside if inside.any() else found.mask], EXTREMES)
    along = np.clip((root - low) / max(high - low, 1e-12), 0, 1)
    return shortest + (longest - shortest) * np.where(found.mask, along, 0.5)


def _check_files(file: Path, capture: Capture) -> None:
    """Each photograph has a file of its own, before any of them is read."""
    names = [
        source.file
        for photograph in capture.photographs
        for source in photograph.brackets or (photograph,)
    ]
    there = sorted({name for name in names if name and (file.parent / name).is_file()})
    if len(there) == len(names):
        return
    missing = sorted({str(name) for name in names} - set(there))
    which = f"without {', '.join(missing)}" if missing else "some named twice"
    found = f"{len(there)} files of {len(names)}, {which}"
    raise InputError(file, "photographs", found, f"{len(names)} files, one for each")


def _check_angles(file: Path, capture: Capture, say: Callable[[str], None]) -> None:
    stated = [photograph.polariser_deg or 0.0 for photograph in capture.photographs]
    angles = np.radians(stated)
    apart = distinct_angles(angles)
    if apart < 3:
        expected = f"three angles that differ modulo 180°, not {apart}"
        raise InputError(file, "photographs.polariser_deg", stated, expected)
    for group in repeated_angles(angles):
        which = ", ".join(map(str, group[:-1]))
        say(f"photographs {which} and {group[-1]} are at one angle modulo 180° and count as one")


def _check_misfits(
    folder: Path, registered: RegisteredLight, misfits: Array, say: Callable[[str], None]
) -> None:
    """The photograph that goes least with the others, where it is off by much."""
    worst = int(np.argmax(misfits))
    name, misfit = registered.names[worst], float(misfits[worst])
    if misfit > FOREIGN:
        error = InputError(
            folder / name,
            f"photographs.{worst}",
            f"light {misfit:.1f} times as far off what the others foretell as these are",
            f"{FOREIGN:g} times at most, at {np.degrees(registered.polariser[worst]):g}°",
        )
        seen = np.nan_to_num(np.asarray(registered.light[worst]))[..., None]
        raise PhotographError(error, Evidence.of(name, seen))
    if misfit > ODD:
        say(
            f"{name} is {misfit:.1f} times as far off what the others foretell as these are: "
            "its angle may be another"
        )


def _map(
    capture: Capture,
    found: Diffracting,
    options: PolarizationOptions,
    periods: tuple[float, float],
    report: PolarizationReport,
    run: Run,
) -> Map:
    seen = found.fit.phase / 2 + (options.offset or 0.0)
    known = np.maximum(found.noise / 2, SHARPEST)
    passes = FilterOptions(iterations=options.passes)
    smooth = filtered_orientation(seen, known, found.mask, passes, run=run)
    foil = foil_map(
        np.where(found.mask, smooth.orientation, 0),
        1 / relative_periods(found, periods),
        found.mask.astype(np.float32),
        height=options.height,
        tile_mm=capture.sample.size_mm,
        recipe={
            "kind": "foil",
            "design": "acquired",
            "profile": "sinusoidal",
            "method": "polarization",
            "report": report.model_dump(mode="json"),
            "capture": capture.model_dump(mode="json", exclude_none=True),
        },
    )
    confidence = confidences(found)
    foil.tables["confidence"] = Table(
        confidence[..., None], foil_axes(*confidence.shape), ("confidence",), "float16"
    )
    return foil


def _report(
    registered: RegisteredLight,
    found: Diffracting,
    options: PolarizationOptions,
    periods: tuple[float, float],
    remarks: list[str],
) -> PolarizationReport:
    mask, fit, circle = found.mask, found.fit, found.circle
    residual = None
    if len(registered.names) > 3:
        residual = float(np.nanmedian(fit.residual[mask] / fit.mean[mask]))
    return PolarizationReport(
        photographs=[
            PhotographLaid(
                name=name,
                polariser_deg=float(np.degrees(ψ)),
                shift_px=(float(move.shift[0]), float(move.shift[1])),
                turn_deg=float(np.degrees(move.turn)),
                quality=move.quality,
                misfit=float(misfit),
                clipped=clipped,
            )
            for name, ψ, move, misfit, clipped in zip(
                registered.names,
                registered.polariser,
                registered.moves,
                found.misfits,
                registered.clipped,
                strict=True,
            )
        ],
        angles=distinct_angles(registered.polariser),
        size=(mask.shape[1], mask.shape[0]),
        diffracting=float(mask.mean()),
        unknown=float(np.mean(~np.isfinite(fit.mean))),
        doubtful=float(np.mean(confidences(found)[mask] == 0)),
        correlation=float(np.nanmean(fit.correlation[mask], dtype=np.float64)),
        residual=residual,
        noise_deg=float(np.degrees(np.median(found.noise[mask])) / 2),
        circle=Circle(
            centre=(circle.centre.real, circle.centre.imag),
            radius=circle.radius,
            is_known=circle.known,
        ),
        offset_deg=float(np.degrees(options.offset or 0.0)),
        is_relative=options.offset is None,
        periods_um=periods,
        remarks=remarks,
    )
