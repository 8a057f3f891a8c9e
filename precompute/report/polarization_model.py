"""What light through a turning polariser tells of orientations, without camera and noise."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import get_args

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from precompute.acquisition.jones import (
    Plastic,
    fresnel_ratio,
    global_offset,
    intensity,
    reflected,
)
from precompute.acquisition.polarization_fit import Harmonics, fit_block
from precompute.files import written_aside
from precompute.report.rows import Acquisition
from precompute.spectra import IndexedMetal, refractive_index

Array = NDArray[np.float64]

PICTURE = "acquisition-polarization.png"

POLARISER: Array = np.arange(17) * np.pi / 17
"""ψ, rad: as many photographs as the 2018 paper takes at most."""

ORIENTATIONS: Array = np.arange(180) * np.pi / 180

PLASTIC_INDEX, ANGLE, WAVELENGTH = 1.468, np.radians(10), 0.55
"""Of the plastic; of facets against the light, rad; µm."""

RETARDATIONS_DEG = (0, 10)
"""Of the plastic, each way."""

ZETAS_DEG = (164, 172, 176)
"""Phases of a ratio of 1.001, degrees, under plastic of `PAPER_RETARDATION` (Fig. 15)."""

PAPER_RETARDATION = 3

NORMALISED = {"as photographed": False, "over their means": True}


def polarization_model_rows(pictures: Path) -> Iterator[Acquisition]:
    """Rows of the 2018 paper's model, 5 and 7.

    Args:
        pictures: Folder for `PICTURE`.
    """
    yield _row("sine, r of 0.5 to 1.5", "RMS from it, over the mean", "1", _off_sine())
    for metal in get_args(IndexedMetal):
        index = refractive_index(metal, WAVELENGTH)
        ratio = complex(fresnel_ratio(index, PLASTIC_INDEX, ANGLE))
        for retardation in RETARDATIONS_DEG:
            yield from _orientation_rows(metal, ratio, retardation)
    for zeta in ZETAS_DEG:
        yield from _orientation_rows(f"ζ = {zeta}°", _ratio(zeta), PAPER_RETARDATION)
    _draw(pictures / PICTURE)


def found_orientations(ratio: complex, plastic: Plastic, is_normalised: bool) -> Array:
    """θ by half the phase of each of `ORIENTATIONS`, rad, the offset being known.

    Args:
        ratio: R of the gratings.
        plastic: Over them.
        is_normalised: Whether photographs are divided by their means.
    """
    seen = _photographs(ratio, plastic)
    means = seen.mean(axis=1) if is_normalised else None
    fit = fit_block(seen.astype(np.float32), Harmonics.of(POLARISER, means))
    return fit.phase / 2 + global_offset(ratio, plastic)


def _photographs(ratio: complex, plastic: Plastic) -> Array:
    """What each orientation shows at each ψ, shape (photographs, orientations)."""
    return intensity(reflected(ORIENTATIONS, ratio, plastic), POLARISER[:, None])


def _off_sine() -> float:
    """The largest RMS distance from a sine, over its mean, of ratios of many r and ζ."""
    worst = 0.0
    for r in np.linspace(0.5, 1.5, 11):
        for zeta in np.radians([150, 164, 172, 176, 180]):
            seen = _photographs(r * np.exp(1j * zeta), Plastic(np.radians(PAPER_RETARDATION)))
            sines = [np.ones_like(POLARISER), np.cos(2 * POLARISER), np.sin(2 * POLARISER)]
            sine = np.stack(sines, axis=1)
            rest = seen - sine @ np.linalg.lstsq(sine, seen)[0]
            worst = max(worst, float(np.max(rest.std(axis=0) / seen.mean(axis=0))))
    return worst


def _orientation_rows(case: str, ratio: complex, retardation_deg: float) -> Iterator[Acquisition]:
    plastic = Plastic(np.radians(retardation_deg))
    for name, is_normalised in NORMALISED.items():
        found = found_orientations(ratio, plastic, is_normalised)
        off = np.abs(np.mod(found - ORIENTATIONS + np.pi / 2, np.pi) - np.pi / 2)
        where = f"{case}, plastic of {retardation_deg}°, {name}"
        yield _row(where, "orientation, largest error", "deg", float(np.degrees(off.max())))


def _row(case: str, figure: str, unit: str, value: float) -> Acquisition:
    return Acquisition(
        case=f"polarization-model, {case}",
        figure=figure,
        unit=unit,
        truth=0,
        value=value,
        spread=0,
        photographs=len(POLARISER),
        noise_db=None,
    )


def _ratio(zeta_deg: float) -> complex:
    return complex(1.001 * np.exp(1j * np.radians(zeta_deg)))


def _draw(file: Path) -> None:
    """θ found over θ, before and after photographs are divided by their means (Fig. 15)."""
    figure = Figure((9, 3.7), 100, layout="constrained")
    plastic = Plastic(np.radians(PAPER_RETARDATION))
    for axes, zeta in zip(figure.subplots(1, len(ZETAS_DEG)), ZETAS_DEG, strict=True):
        for is_normalised in NORMALISED.values():
            found = found_orientations(_ratio(zeta), plastic, is_normalised)
            dots = np.degrees(np.mod(found, np.pi))
            axes.plot(np.degrees(ORIENTATIONS), dots, ".", markersize=3)
        axes.set(title=f"ζ = {zeta}°", xlabel="θ (deg)", ylabel="found (deg)", aspect="equal")
    figure.legend(NORMALISED, loc="outside lower center", ncols=2, fontsize=8)
    with written_aside(file) as aside:
        figure.savefig(aside, format="png")
