"""What is in a height field: sizes, periods, what each method needs, and how it diffracts."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from numpy.typing import NDArray
from rich.table import Table as TextTable

from precompute.files import written_aside
from precompute.height_fields.expansion import (
    CANCELLATION_ALLOWED,
    taylor_cancellation,
    terms_needed,
    worst_phase,
)
from precompute.height_fields.field import HeightField
from precompute.height_fields.optics import HeightFieldOptics
from precompute.height_fields.prepare import prepared
from precompute.height_fields.recipe import HeightFieldRecipe
from precompute.height_fields.reference import spectral_brdf
from precompute.height_fields.spectrum import dominant_frequency, power_spectrum
from precompute.recipes import read_recipe

Array = NDArray[np.float64]

INCIDENCE_DEG = 75.0
"""θ_i of the thesis' evaluation."""

EVALUATED = np.arange(0.38, 0.7801, 0.01)
"""Its wavelengths, µm."""

SHOWN_LINES = 4
"""Strongest lines of the relief's own spectrum that are listed."""


@dataclass(frozen=True)
class PeriodEstimate:
    """The period that the first order's viewing angles state.

    Attributes:
        wavelengths: Those at which a first order leaves the surface, µm, shape (n,).
        angles: θ_r of its peak, rad, positive on the mirror direction's side, shape (n,).
        periods: λ/(sinθ_i − sinθ_r), µm, shape (n,).
    """

    wavelengths: Array
    angles: Array
    periods: Array


def field_of_recipe(file: Path) -> HeightField | None:
    """The prepared field of a height field's recipe; None where the file is something else.

    Raises:
        InputError: It is such a recipe, but the field cannot be made of it.
    """
    try:
        contents = json.loads(file.read_text("utf-8"))
    except (OSError, ValueError):
        return None
    if not isinstance(contents, dict) or contents.get("kind") != "height-field":
        return None
    recipe = read_recipe(file)
    assert isinstance(recipe, HeightFieldRecipe)
    return prepared(recipe, file.parent)


def period_estimate(field: HeightField) -> PeriodEstimate:
    """The thesis' evaluation: light at 75°, the angle of each wavelength's peak, then the period.

    The plane of incidence lies along the strongest spatial frequency; the first order's peak is
    looked for between half and one and a half times the angle's sine that this frequency gives it.
    """
    f = np.array(dominant_frequency(field))
    along = f / np.hypot(*f)
    sine = np.sin(np.deg2rad(INCIDENCE_DEG))
    wavelengths, angles, periods = [], [], []
    for λ in EVALUATED.tolist():
        u = λ * float(np.hypot(*f)) * np.linspace(0.5, 1.5, 801)
        found = _peak(field, λ, along, sine, u[np.abs(sine - u) < 1])
        if found is None:
            continue
        wavelengths.append(λ)
        angles.append(np.arcsin(sine - found))
        periods.append(λ / found)
    return PeriodEstimate(np.array(wavelengths), np.array(angles), np.array(periods))


def description(field: HeightField, name: str) -> TextTable:
    """Size, heights, periods, phases, terms and the period that diffraction shows."""
    facts = TextTable(title=name, title_justify="left", show_header=False, box=None)
    rows, columns = field.heights.shape
    facts.add_row("size", f"{field.period[0]:.6g} × {field.period[1]:.6g} um")
    facts.add_row("samples", f"{columns} × {rows}")
    facts.add_row("pitch", f"{field.pitch[0]:.6g} × {field.pitch[1]:.6g} um")
    facts.add_row("height, lowest to highest", f"{np.ptp(field.heights):.6g} um")
    facts.add_row("height, rms", f"{np.std(field.heights):.6g} um")
    for x, y, share in _strongest(field):
        period, angle = 1 / np.hypot(x, y), np.rad2deg(np.arctan2(y, x))
        facts.add_row("period", f"{period:.6g} um at {angle:.1f} deg, {100 * share:.1f} % of h²")
    for expansion in ("jacobi-anger", "taylor"):
        x = worst_phase(expansion, field)
        facts.add_row(f"{expansion}, largest phase", f"{x:.4g} rad")
        needed = f"{terms_needed(expansion, x, 0.01)} terms for 1 %"
        if expansion == "taylor" and taylor_cancellation(x) > CANCELLATION_ALLOWED:
            needed += ", which cancel beyond float32: refused"
        facts.add_row(expansion, needed)
    estimate = period_estimate(field)
    if len(estimate.periods) > 0:
        facts.add_row(
            f"period by diffraction at {INCIDENCE_DEG:.0f} deg",
            f"{estimate.periods.mean():.4f} um, variance {estimate.periods.var():.2g} um²",
        )
    return facts


def write_pictures(field: HeightField, name: str, folder: Path) -> list[Path]:
    """NAME-heights.png, and NAME-brdf.png over viewing angle and wavelength."""
    written = []
    for key, figure in (("heights", _heights(field)), ("brdf", _brdf_map(field))):
        figure.suptitle(name, fontsize=9)
        picture = folder / f"{name}-{key}.png"
        with written_aside(picture) as aside:
            figure.savefig(aside, format="png", dpi=150)
        written.append(picture)
    return written


def _strongest(field: HeightField) -> list[tuple[float, float, float]]:
    """The strongest lines (f_x, f_y), 1/µm, of one of ±f, and their share of the variance."""
    power = power_spectrum(field)
    rows, columns = power.shape
    fx = np.fft.fftfreq(columns, field.pitch[0])
    fy = np.fft.fftfreq(rows, field.pitch[1])
    half = (fx[None] > 0) | ((fx[None] == 0) & (fy[:, None] > 0))
    power = np.where(half, 2 * power, 0)
    total = power.sum()
    order = np.argsort(-power, axis=None, kind="stable")[:SHOWN_LINES]
    found = [(np.unravel_index(i, power.shape), power.flat[i] / total) for i in order]
    return [
        (float(fx[column]), float(fy[row]), float(share))
        for (row, column), share in found
        if share > 0.01
    ]


def _in_plane(field: HeightField, wavelength: Array, along: Array, sine: float, u: Array) -> Array:
    """f_r in the plane of incidence at (u, 0) along `along`, light from −sinθ_i, shape of u."""
    wi = np.broadcast_to([*(sine * along), np.sqrt(1 - sine**2)], (len(u), 3))
    out = u - sine
    wo = np.column_stack([out[:, None] * along, np.sqrt(1 - out**2)])
    return spectral_brdf(field, HeightFieldOptics(metal=None), wi, wo, wavelength)


def _peak(field: HeightField, λ: float, along: Array, sine: float, u: Array) -> float | None:
    """u of the largest BRDF among u, between its samples; None where there is no top inside."""
    if len(u) < 3:
        return None
    brdf = _in_plane(field, np.full(len(u), λ), along, sine, u)
    top = int(np.argmax(brdf))
    if top in (0, len(u) - 1) or brdf[top] <= 0:
        return None
    before, middle, after = np.log(np.maximum(brdf[top - 1 : top + 2], 1e-300))
    offset = (before - after) / (2 * (before - 2 * middle + after))
    return float(u[top] + offset * (u[1] - u[0]))


def _heights(field: HeightField) -> Figure:
    figure = Figure((5, 4), layout="constrained")
    panel = figure.subplots()
    extent = (0.0, field.period[0], 0.0, field.period[1])
    image = panel.imshow(field.heights, origin="lower", extent=extent, cmap="gray")
    figure.colorbar(image, ax=panel, label="h (µm)")
    panel.set(xlabel="x (µm)", ylabel="y (µm)")
    return figure


def _brdf_map(field: HeightField) -> Figure:
    """The BRDF of a perfect mirror with that relief, the peaks of the evaluation over it."""
    f = np.array(dominant_frequency(field))
    along = f / np.hypot(*f)
    sine = float(np.sin(np.deg2rad(INCIDENCE_DEG)))
    θ = np.deg2rad(np.linspace(-89, 89, 357))
    λ = np.linspace(0.38, 0.78, 81)
    u = np.tile(np.sin(θ) + sine, len(λ))
    brdf = _in_plane(field, np.repeat(λ, len(θ)), along, sine, u).reshape(len(λ), len(θ))
    figure = Figure((7, 4), layout="constrained")
    panel = figure.subplots()
    norm = LogNorm(brdf.max() * 1e-5, brdf.max(), clip=True)
    image = panel.pcolormesh(np.rad2deg(θ), λ, brdf, shading="nearest", cmap="magma", norm=norm)
    estimate = period_estimate(field)
    panel.plot(-np.rad2deg(estimate.angles), estimate.wavelengths, ".", ms=2, color="cyan")
    figure.colorbar(image, ax=panel, label="f_r (1/sr)")
    panel.set(
        xlabel=f"θ_r (deg), light at {INCIDENCE_DEG:.0f} deg", ylabel="λ (µm)", xlim=(-89, 89)
    )
    return figure
