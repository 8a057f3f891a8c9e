"""Methods for height fields at the edges: reliefs ever higher, and directions that graze.

The series are asked for the amplitudes of lines as the shader sums them, in float32 from the map
that the bake gives (`precompute.height_fields.term_sum`), against float64 transforms of exp(ikwh).
"""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from precompute.errors import InputError
from precompute.gratings import Light
from precompute.height_fields.baked_lookup import BakedLookup
from precompute.height_fields.expansion import Expansion, basis
from precompute.height_fields.field import HeightField
from precompute.height_fields.generate import generated
from precompute.height_fields.lines import line_amplitudes
from precompute.height_fields.optics import HeightFieldOptics
from precompute.height_fields.prepare import prepared
from precompute.height_fields.recipe import Bumps
from precompute.height_fields.reference import colour_brdf
from precompute.height_fields.term_sum import TermsMethod
from precompute.height_fields.terms import terms_map
from precompute.maps import Map
from precompute.metrics import relative_rmse
from precompute.report.rows import Stability
from precompute.spectra import WAVELENGTH_MIN

Array = NDArray[np.float64]
Precision = Literal["fp16", "fp32"]

PHASES = (2.4, 5.0, 6.5, 10.0, 20.0, 40.0, 80.0)
"""Largest x = k w Δ/2 of the reliefs, rad: violet, light and view head-on. Taylor's series, whose x
is twice as large, is refused from 6.8 on."""

PHASE_SAMPLES = 17
"""Values of x from 0 to the largest at which the lines are summed."""

CASES = tuple(product(get_args(Expansion), get_args(Precision), PHASES))
"""What `series_stability` is asked for."""

SERIES_ERROR = 1e-3
"""Of exp(ikwh), by which the number of terms is chosen: what recipes have by default."""

PAIRS = 400
"""Pairs of directions that graze."""

GRAZING = ((60.0, 80.0), (80.0, 89.9))
"""Ranges of degrees from the normal, of light and view."""


def relief(phase: float) -> HeightField:
    """A smooth hump, sampled finely enough at any of `PHASES`, of which violet has a given x.

    Args:
        phase: Largest x = k w Δ/2, rad.
    """
    height = phase * WAVELENGTH_MIN / (2 * np.pi)
    return generated(Bumps(height=height, size=(16.0, 16.0), cell=(18.0, 18.0)))


def series_stability(expansion: Expansion, precision: Precision, phase: float) -> Stability:
    """A series up to a phase.

    Args:
        expansion: Which series.
        precision: Of its tables, whichever the bake chooses.
        phase: Largest x = k w Δ/2, rad.
    """
    field = relief(phase)
    stability = Stability(
        case=f"hump {2 * field.amplitude:.2f} µm high, x = k w Δ/2 from 0 to {phase:g}",
        method=expansion,
        samples=0,
        non_finite=0,
        negative_energy=0,
        max_albedo=None,
        rel_rmse=None,
        float=precision,
    )
    try:
        baked = terms_map(field, expansion, None, SERIES_ERROR, {}, "hump")
    except InputError as refusal:
        return stability.model_copy(update={"refused": refusal.expected})
    method = TermsMethod(with_tables_in(precision, baked, expansion, field), HeightFieldOptics())
    j, l = (grid.ravel() for grid in np.mgrid[tuple(slice(-n, n + 1) for n in method.limit)])  # noqa: E741
    kw = np.linspace(0, phase, PHASE_SAMPLES) / field.amplitude
    found = np.array(
        [method.line_amplitude(np.stack([j, l], axis=1), np.full(len(j), q)) for q in kw]
    )
    # Each series counts heights from a zero of its own.
    low, high = field.heights.min(), field.heights.max()
    zero = low if expansion == "taylor" else (low + high) / 2
    about = HeightField(field.heights - zero, field.pitch)
    exact = np.array([line_amplitudes(about, q)[l, j] for q in kw])
    return stability.model_copy(update=compared(found, exact))


def compared(found: NDArray[np.complex64], exact: NDArray[np.complex128]) -> dict[str, object]:
    """Figures of amplitudes of shape (phases, lines); the worst of the phases."""
    non_finite = int(np.count_nonzero(~np.isfinite(found)))
    figures: dict[str, object] = {"samples": found.size, "non_finite": non_finite}
    if non_finite == 0:
        power = np.sum(np.abs(exact) ** 2, axis=1)
        off = np.sum(np.abs(found - exact) ** 2, axis=1)
        figures["rel_rmse"] = float(np.sqrt(np.max(off / power)))
        figures["max_albedo"] = float(np.max(np.sum(np.abs(found.astype(complex)) ** 2, axis=1)))
    return figures


def with_tables_in(
    precision: Precision, baked: Map, expansion: Expansion, field: HeightField
) -> Map:
    """The map with its terms rounded to halves or to floats, whichever the bake chose."""
    table = baked.tables["terms"]
    dtype = "float16" if precision == "fp16" else "float32"
    along_y, along_x = (np.arange(axis.first, axis.last + 1).astype(int) for axis in table.axes[1:])
    values = np.zeros(table.values.shape, dtype)
    terms = int(np.ravel(baked.constants["terms"])[0])
    for n, function in enumerate(basis(expansion, field, terms)):
        g = 1j**n * np.fft.ifft2(function)[np.ix_(along_y, along_x)]
        channel = 2 * (n % 2)
        values[n // 2, ..., channel], values[n // 2, ..., channel + 1] = g.real, g.imag
    terms_table = replace(table, values=values, dtype=dtype)
    return replace(baked, tables={**baked.tables, "terms": terms_table})


def grazing_stability(maps: Path, degrees: tuple[float, float]) -> Stability:
    """The baked bumps where both directions graze: radiance, which the obliquity blows up there.

    Args:
        maps: Folder of the baked maps.
        degrees: Least and largest angle from the normal, of light and of view.
    """
    lookup = BakedLookup(Map.read(maps / "height-field-bumps-baked"))
    recipe = lookup.recipe
    optics = HeightFieldOptics(
        metal=recipe.metal, coherence=recipe.coherence, roughness=recipe.roughness
    )
    light = Light(illuminant=recipe.illuminant)
    rng = np.random.default_rng(1)
    wi, wo = (_directions(degrees, rng) for _ in range(2))
    found = wi[:, 2:] * lookup.colour_brdf(wi, wo, light)
    exact = wi[:, 2:] * colour_brdf(prepared(recipe, maps), optics, wi, wo, light)
    finite = np.isfinite(found).all(axis=1)
    return Stability(
        case=f"bumps, light and view {degrees[0]:g}° to {degrees[1]:g}° from the normal",
        method="baked",
        samples=PAIRS,
        non_finite=int(np.count_nonzero(~finite)),
        negative_energy=int(np.count_nonzero(found[finite, 1] < 0)),
        max_albedo=None,
        rel_rmse=float(relative_rmse(found, exact)) if finite.all() else None,
        float="fp16",
    )


def _directions(degrees: tuple[float, float], rng: np.random.Generator) -> Array:
    """Unit vectors at angles from the normal in a range, at all azimuths, shape (`PAIRS`, 3)."""
    θ, φ = np.deg2rad(rng.uniform(*degrees, PAIRS)), rng.uniform(0, 2 * np.pi, PAIRS)
    return np.stack([np.sin(θ) * np.cos(φ), np.sin(θ) * np.sin(φ), np.cos(θ)], axis=1)
