"""Asking a method directly: BRDF, colour or order efficiencies at the directions of a CSV file."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from precompute.closed_form import ClosedForm
from precompute.columns import Columns, Rows
from precompute.errors import InputError
from precompute.gratings import Grating
from precompute.profiles import efficiency
from precompute.recipes import GratingRecipe
from precompute.reference import (
    colour_brdf,
    energy_factor,
    order_direction,
    reflectance,
    spectral_brdf,
)
from precompute.spectra import WAVELENGTH_MAX, WAVELENGTH_MIN
from precompute.wavelength_loop import WavelengthLoop

Array = NDArray[np.float64]
Cells = list[str | int | float]

DIRECTIONS = ("wi_x", "wi_y", "wi_z", "wo_x", "wo_y", "wo_z")
INCIDENCE = ("theta_i_deg", "phi_i_deg")
WAVELENGTH = "wavelength_um"
XYZ = ("X", "Y", "Z")
ORDERS = ("m", "wo_x", "wo_y", "wo_z", "efficiency", "e_m")

UNIT_TOLERANCE = 1e-3
"""How far a direction's length may be from 1: three decimals. It is then scaled to 1."""


def evaluate(
    recipe: GratingRecipe, beside: Path, file: Path, lines: Iterable[str], orders: bool = False
) -> Iterator[list[Cells]]:
    """What the recipe's method says of each row of a CSV file.

    Args:
        recipe: The grating, the light and the method.
        beside: Folder of the recipe, where a CSV illuminant is looked for.
        file: The file's name, for errors.
        lines: Its lines. Directions are unit vectors in the grating's frame: t across the grooves,
            b along them, n the normal.
        orders: Ask for the propagating orders of a plane wave, instead of for directions.

    Returns:
        Rows in pieces, the header first: the file's own columns, and then

        - for columns ``wi_x`` to ``wo_z``: ``X``, ``Y``, ``Z``, ∫ S(λ) (x̄, ȳ, z̄) f_r dλ in 1/sr;
        - with a column ``wavelength_um``: ``brdf``, f_r(λ) in 1/sr;
        - with `orders`, for columns ``theta_i_deg``, ``phi_i_deg`` and ``wavelength_um``, a row an
          order: ``m``, its direction ``wo_x`` to ``wo_z``, its scalar ``efficiency`` η_m, and
          ``e_m``, which has the metal and the choice of energy in it.

    Raises:
        InputError: A column is missing, a number is none or out of range, a direction is not a
            unit vector, or the method has no answer of this kind.
    """
    table = Columns(file, lines)
    is_spectral = orders or WAVELENGTH in table.header
    if is_spectral and recipe.method != "reference":
        asked = "order efficiencies" if orders else f"a column {WAVELENGTH}"
        raise InputError(file, "method", recipe.method, f"reference, for {asked}")
    if orders:
        names, added = (*INCIDENCE, WAVELENGTH), ORDERS
    elif is_spectral:
        names, added = (*DIRECTIONS, WAVELENGTH), ("brdf",)
    else:
        names, added = DIRECTIONS, XYZ
    table.require(names)
    for name in added:
        if name in table.header:
            raise InputError(file, "header", name, "another name: this column is added")
    grating = recipe.grating()
    colour = None if is_spectral else _colour(recipe, beside)

    def answer(rows: Rows) -> list[Cells]:
        if orders:
            return _propagating(grating, file, rows)
        wi, wo = _unit(file, rows, "wi"), _unit(file, rows, "wo")
        if colour is not None:
            found = colour(wi, wo)
        else:
            λ = _wavelength(file, rows)
            found = spectral_brdf(grating, wi, wo, λ, recipe.angular_radius)[:, None]
        return [[*c, *f] for c, f in zip(rows.cells, found.tolist(), strict=True)]

    return _below_header([*table.header, *added], map(answer, table.read(names)))


def _below_header(header: Cells, pieces: Iterable[list[Cells]]) -> Iterator[list[Cells]]:
    """The header goes with the first rows: if those are bad, nothing is written."""
    above = [header]
    for piece in pieces:
        yield above + piece
        above = []


def _colour(recipe: GratingRecipe, beside: Path) -> Callable[[Array, Array], Array]:
    grating, light = recipe.grating(), recipe.light(beside)
    match recipe.method:
        case "reference":
            return lambda wi, wo: colour_brdf(grating, wi, wo, light)
        case "closed-form":
            return ClosedForm(grating, light).colour_brdf
        case "wavelength-loop":
            is_taylor = recipe.efficiencies == "taylor"
            return WavelengthLoop(grating, light, recipe.wavelength_step, is_taylor).colour_brdf


def _propagating(grating: Grating, file: Path, rows: Rows) -> list[Cells]:
    θ, φ = (rows.numbers[name] for name in INCIDENCE)
    _within(file, rows, INCIDENCE[0], (θ >= 0) & (θ < 90), "0 or more and less than 90")
    λ = _wavelength(file, rows)
    θ, φ = np.deg2rad(θ), np.deg2rad(φ)
    wi = np.stack([np.sin(θ) * np.cos(φ), np.sin(θ) * np.sin(φ), np.cos(θ)], axis=-1)
    found: list[list[Cells]] = [[] for _ in rows.cells]
    limit = int(np.ceil(2 * grating.period / λ.min()))
    for m in range(-limit, limit + 1):
        wo = order_direction(wi, m, λ, grating.period)
        open_ = np.flatnonzero(~np.isnan(wo[:, 2]))
        i, o, at = wi[open_], wo[open_], λ[open_]
        η = efficiency(grating.profile, m, 2 * np.pi * (i[:, 2] + o[:, 2]) * grating.height / at)
        e = reflectance(grating, at) * energy_factor(grating, i, o, at) * η
        numbers_of = np.column_stack([o, η, e]) + 0.0  # −0 becomes 0
        for row, numbers in zip(open_, numbers_of.tolist(), strict=True):
            found[row].append([*rows.cells[row], m, *numbers])
    return [order for row in found for order in row]


def _unit(file: Path, rows: Rows, name: str) -> Array:
    vectors = np.stack([rows.numbers[f"{name}_{axis}"] for axis in "xyz"], axis=-1)
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    bad = np.flatnonzero(np.abs(length - 1) > UNIT_TOLERANCE)
    if len(bad) > 0:
        field = f"{name}_x, {name}_y, {name}_z, line {rows.lines[bad[0]]}"
        expected = f"a unit vector; its length is {float(length[bad[0], 0]):.6g}"
        raise InputError(file, field, vectors[bad[0]].tolist(), expected)
    return vectors / length


def _wavelength(file: Path, rows: Rows) -> Array:
    λ = rows.numbers[WAVELENGTH]
    visible = (λ >= WAVELENGTH_MIN) & (λ <= WAVELENGTH_MAX)
    _within(file, rows, WAVELENGTH, visible, f"{WAVELENGTH_MIN} to {WAVELENGTH_MAX} um")
    return λ


def _within(file: Path, rows: Rows, name: str, good: NDArray[np.bool_], expected: str) -> None:
    bad = np.flatnonzero(~good)
    if len(bad) > 0:
        row = bad[0]
        value = float(rows.numbers[name][row])
        raise InputError(file, f"{name}, line {rows.lines[row]}", value, expected)
