"""Lobe tables: the colour of a diffraction lobe in closed form (docs/theory/lights.md).

For a light that is not an environment, the integral over wavelength of one order's lobe is a
Gaussian average of the spectrum over wavenumber s = 1/λ, about s* with standard deviation q:

    T(s*, q) = ∫ W(1/s) N(s; s*, q) ds,        W(λ) = S(λ)·(x̄, ȳ, z̄)(λ), a mirror's Y = 1,

and the mean wavenumber s̄ over the lobe, at which everything that varies slowly is looked up. Order
0 stays at s* = 0 and is seen only where lobes are wide; wide lobes and the environment are sums
over spectral nodes, bands whose weights are differences of the cumulative table ``weights``.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from precompute.axes import Axis
from precompute.maps import Map, Table
from precompute.recipes import LobesRecipe, MetalsRecipe
from precompute.spectra import (
    METALS,
    WAVELENGTH_MAX,
    WAVELENGTH_MIN,
    WAVELENGTH_STEP,
    WAVELENGTHS,
    colour_weights,
    metal_reflectance,
    tint_basis,
    white_xyz,
    xyz_to_linear_srgb,
)

Array = NDArray[np.float64]

WAVENUMBER_MIN = 1 / WAVELENGTH_MAX
WAVENUMBER_MAX = 1 / WAVELENGTH_MIN
MARGIN = 3.0
"""How many standard deviations beyond the visible range a lobe's middle still finds its colour."""

WIDTH_MIN, WIDTH_MAX = 0.004, 0.08
"""q of a lobe: below the first it is as good as monochromatic; above the second a sum over a few
spectral nodes is exact enough, and order 0 is only ever seen so."""

EXPONENT_CUT = 14.0
"""exp(−14) = 8e-7: a lobe is left out where it has fallen below that share of its peak."""

WIDE_LOBE_NODES = 20
"""Bands of the sum for wide lobes: enough for lobes of more than WIDTH_MAX, and for order 0, whose
efficiency and N vary over the whole spectrum."""

BAND_DEVIATION = 12**-0.5
"""Standard deviation of a band, a box, over its width."""

LAYERS = ("white", "red", "green")
"""Tints in the table; the blue basis is white less red less green."""


def lobes_map(recipe: LobesRecipe, folder: Path) -> Map:
    """Bake T, the cumulative weights and the colour matrices for one illuminant and observer.

    Args:
        recipe: What to bake.
        folder: Where a CSV illuminant is looked for.

    Returns:
        A map of kind ``lobes`` with arrays ``lobe`` (layers × q × s*; X, Y, Z, s̄) and ``weights``
        (edges; XYZ of the bases red, green, blue).

    Raises:
        InputError: The illuminant is unknown or its file unreadable.
    """
    light = recipe.illuminant
    if light.endswith(".csv"):
        light = str(folder / light)
    weights = colour_weights(recipe.observer, light)
    basis = tint_basis()
    widths = Axis(
        name="lobe width",
        symbol="q",
        unit="1/um",
        size=recipe.widths,
        mapping="log",
        first=WIDTH_MIN,
        last=WIDTH_MAX,
    )
    # The range of s* grows with q: x = (s* − s_min + 3q)/(s_max − s_min + 6q).
    position = Axis(
        name="position of the lobe's wavenumber in its range",
        symbol="x",
        unit="1",
        size=recipe.wavenumbers,
        first=0,
        last=1,
    )
    layers = Axis(name="tint", symbol="i", unit="1", size=3, first=0, last=2)
    tints = np.stack([np.ones(len(basis)), basis[:, 0], basis[:, 1]])
    lobe = _gaussian_averages(
        tints[:, :, None] * weights, widths.parameters(), position.parameters()
    )
    table = Table(lobe, (layers, widths, position), ("X", "Y", "Z", "mean wavenumber"))
    edges = Axis(
        name="wavelength",
        symbol="lambda",
        unit="um",
        size=len(WAVELENGTHS) + 1,
        first=WAVELENGTH_MIN - WAVELENGTH_STEP / 2,
        last=WAVELENGTH_MAX + WAVELENGTH_STEP / 2,
    )
    cells = (basis[:, :, None] * weights[:, None, :]).reshape(len(weights), 9) * WAVELENGTH_STEP
    cumulative = np.concatenate([np.zeros((1, 9)), np.cumsum(cells, axis=0)])
    channels = tuple(f"{c} of {b}" for b in ("red", "green", "blue") for c in "XYZ")
    matrix = xyz_to_linear_srgb(recipe.observer, light)
    return Map(
        kind="lobes",
        quantity="colour of a diffraction lobe, a mirror's Y = 1",
        symbol="T(s*, q)",
        tables={
            "lobe": table,
            "weights": Table(cumulative, (edges,), channels, dtype="float32"),
        },
        error=_error_of_interpolation(table, weights),
        recipe=recipe.model_dump(),
        constants={
            "white_xyz": tuple(white_xyz(recipe.observer, light).tolist()),
            "xyz_to_rgb": tuple(matrix.ravel().tolist()),
            "wavenumber_min": WAVENUMBER_MIN,
            "wavenumber_max": WAVENUMBER_MAX,
            "margin": MARGIN,
            "exponent_cut": EXPONENT_CUT,
            "wide_lobe_nodes": WIDE_LOBE_NODES,
        },
    )


def metals_map(recipe: MetalsRecipe) -> Map:
    """Bake R(1/s) of all metals, one a channel, over wavenumber."""
    axis = Axis(
        name="wavenumber",
        symbol="s",
        unit="1/um",
        size=recipe.wavenumbers,
        first=WAVENUMBER_MIN,
        last=WAVENUMBER_MAX,
    )
    row = Axis(name="row", symbol="i", unit="1", size=1, first=0, last=0)

    def reflectances(wavenumber: Array) -> Array:
        return np.stack([metal_reflectance(m, 1 / wavenumber) for m in METALS], axis=-1)

    table = Table(reflectances(axis.parameters())[None], (row, axis), METALS)
    between = axis.parameter_from_texel(np.arange(axis.size - 1) + 0.5)
    found = _as_stored(table).sample(np.zeros_like(between), between)
    return Map(
        kind="metals",
        quantity="reflectance at normal incidence in air",
        symbol="R(s)",
        tables={"reflectance": table},
        error=_relative(found, reflectances(between), "indices of refraction, between texels"),
        recipe=recipe.model_dump(),
    )


def lobe_position(wavenumber: Array, width: Array) -> Array:
    """x of T's axis, no unit, for a lobe at s* of width q; outside [0, 1] the lobe is invisible.

    Args:
        wavenumber: s*, 1/µm, any shape.
        width: q, its standard deviation, 1/µm, that shape.
    """
    low = WAVENUMBER_MIN - MARGIN * width
    return (wavenumber - low) / (WAVENUMBER_MAX - WAVENUMBER_MIN + 2 * MARGIN * width)


def lobe_wavenumber(position: Array, width: Array) -> Array:
    """s*, 1/µm: the inverse of `lobe_position`.

    Args:
        position: x, no unit, any shape.
        width: q, 1/µm, that shape.


    >>> s, q = np.array([1.8]), np.array([0.05])
    >>> lobe_wavenumber(lobe_position(s, q), q).round(12).tolist()
    [1.8]
    """
    low = WAVENUMBER_MIN - MARGIN * width
    return low + position * (WAVENUMBER_MAX - WAVENUMBER_MIN + 2 * MARGIN * width)


def _gaussian_averages(weights: Array, widths: Array, positions: Array) -> Array:
    """T and s̄ for every (tint, q, x), from weights of shape (tints, 401, 3).

    Returns:
        Shape (tints, widths, positions, 4).

    The spectrum between its samples is a straight line; trapezoids on a grid of s fine enough
    for the narrowest lobe.
    """
    s = np.linspace(WAVENUMBER_MIN, WAVENUMBER_MAX, 3001)
    step = s[1] - s[0]
    spectra = [
        np.stack([np.interp(1 / s, WAVELENGTHS, w) for w in tint.T], axis=-1) for tint in weights
    ]
    trapezoid = np.full(len(s), step)
    trapezoid[[0, -1]] /= 2
    result = np.zeros((len(weights), len(widths), len(positions), 4))
    for row, q in enumerate(widths):
        centre = lobe_wavenumber(positions, q)
        exponent = -((s - centre[:, None]) ** 2) / (2 * q**2)
        kernel = np.exp(exponent) * trapezoid / (np.sqrt(2 * np.pi) * q)
        # Shifted so that its largest value is 1: the mean exists where the colour underflows.
        shifted = np.exp(exponent - exponent.max(axis=1, keepdims=True)) * trapezoid
        for tint, spectrum in enumerate(spectra):
            result[tint, row, :, :3] = kernel @ spectrum
            energy = shifted * (spectrum.sum(axis=1) + 1e-12)
            result[tint, row, :, 3] = (energy @ s) / energy.sum(axis=1)
    return result


def _error_of_interpolation(table: Table, weights: Array) -> dict[str, float | str]:
    """The stored table of white light, interpolated between texels, against direct averages."""
    widths, position = table.axes[1:]
    q = widths.parameter_from_texel(np.arange(widths.size - 1) + 0.5)
    x = position.parameter_from_texel(np.arange(position.size - 1) + 0.5)
    (exact,) = _gaussian_averages(weights[None], q, x)
    stored = _as_stored(table)
    found = stored.sample(np.zeros((len(q), len(x))), *np.meshgrid(q, x, indexing="ij"))
    return _relative(found[..., :3], exact[..., :3], "direct averages, midway between texels")


def _as_stored(table: Table) -> Table:
    rounded = table.values.astype(table.dtype).astype(np.float64)
    return Table(rounded, table.axes, table.channels, table.dtype)


def _relative(found: Array, exact: Array, against: str) -> dict[str, float | str]:
    error = np.sqrt(np.mean((found - exact) ** 2) / np.mean(exact**2))
    return {"relative_rms": float(error), "against": against}
