"""Spectra: observers, illuminants, tint bases and metals, all on one grid of 1 nm.

All colour data come from colour-science; refractive indices of metals from the publications named
in the first line of each file of ``precompute/data/metals``. Wavelengths are in micrometres.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from importlib import resources
from pathlib import Path
from typing import Literal, get_args

import colour
import numpy as np
from numpy.typing import ArrayLike, NDArray

from precompute.columns import Columns
from precompute.errors import InputError, unreadable

Array = NDArray[np.float64]
Observer = Literal["1931-2", "2015-2"]
Metal = Literal["aluminium", "silver", "gold", "copper"]
IndexedMetal = Literal["aluminium", "silver", "brass", "iron", "gold", "copper", "platinum"]

OBSERVERS: dict[Observer, str] = {
    "1931-2": "CIE 1931 2 Degree Standard Observer",
    "2015-2": "CIE 2015 2 Degree Standard Observer",
}
METALS: tuple[Metal, ...] = get_args(Metal)
"""Whose reflectances are baked for the material."""
INDEXED_METALS: tuple[IndexedMetal, ...] = get_args(IndexedMetal)
"""Whose refractive indices are known."""
ILLUMINANTS = ("D65", "A", "inverse-A", "LED-B1", "LED-B2", "LED-B3", "LED-B4", "LED-B5")

WAVELENGTH_MIN = 0.38
WAVELENGTH_MAX = 0.78
WAVELENGTH_STEP = 0.001
WAVELENGTHS: Array = np.arange(380, 781) / 1000
"""The visible range, 380 to 780 nm by 1 nm, in µm. Shape (401,)."""


def colour_matching_functions(observer: Observer = "1931-2") -> Array:
    """Colour-matching functions x̄, ȳ, z̄ on `WAVELENGTHS`.

    Args:
        observer: ``1931-2`` or ``2015-2``. The 2015 data start at 390 nm; below it is zero.

    Returns:
        Shape (401, 3), no unit.

    Raises:
        InputError: The observer is unknown.

    >>> colour_matching_functions().shape
    (401, 3)
    >>> round(float(colour_matching_functions()[:, 1].max()), 3)  # ȳ peaks at 1 by definition
    1.0
    """
    if observer not in OBSERVERS:
        raise InputError("spectrum", "observer", observer, f"one of {', '.join(OBSERVERS)}")
    data = colour.MSDS_CMFS[OBSERVERS[observer]]
    return _on_grid(data.wavelengths / 1000, data.values)


def illuminant(name: str | Path) -> Array:
    """Relative spectral power of a light on `WAVELENGTHS`, scaled to 1 at its largest.

    Args:
        name: One of `ILLUMINANTS`, or the path of a CSV with columns ``wavelength_um`` (or
            ``wavelength_nm``) and ``power``. ``inverse-A`` is the reciprocal of illuminant A, the
            cool blue of a phone's flash. Power outside a CSV's range counts as zero.

    Returns:
        Shape (401,), relative power per wavelength, in [0, 1].

    Raises:
        InputError: The name is neither an illuminant nor a CSV that can be read.

    >>> bool(illuminant("A")[0] < illuminant("A")[-1])  # incandescent light is red
    True
    >>> bool(illuminant("inverse-A")[0] > illuminant("inverse-A")[-1])
    True
    """
    if str(name).endswith(".csv"):
        power = _illuminant_from_csv(Path(name))
    elif name == "inverse-A":
        power = 1 / illuminant("A")
    elif name in ILLUMINANTS:
        data = colour.SDS_ILLUMINANTS[str(name)]
        power = _on_grid(data.wavelengths / 1000, data.values)
    else:
        choices = f"one of {', '.join(ILLUMINANTS)} or a .csv file"
        raise InputError("spectrum", "illuminant", str(name), choices)
    return power / power.max()


def tint_basis() -> Array:
    """Reflectance bases of the three linear sRGB primaries (Mallett and Yuksel 2019).

    A tint (r, g, b) has the spectrum r·ρ_r + g·ρ_g + b·ρ_b; white is 1 at every wavelength.

    Returns:
        Shape (401, 3), no unit.

    >>> bool(np.allclose(tint_basis().sum(axis=1), 1, atol=2e-5))
    True
    """
    data = colour.recovery.MSDS_BASIS_FUNCTIONS_sRGB_MALLETT2019
    return _on_grid(data.wavelengths / 1000, data.values)


def metal_reflectance(metal: Metal, wavelength: ArrayLike = WAVELENGTHS) -> Array:
    """Reflectance R(λ) of a polished metal in air at normal incidence.

    R = |(n + ik − 1)/(n + ik + 1)|² from published refractive indices, interpolated linearly.

    Args:
        metal: One of `METALS`.
        wavelength: µm, 0.37 to 0.79.

    Returns:
        A share of the light, of the shape of `wavelength`.

    Raises:
        InputError: The metal is unknown.

    >>> gold = metal_reflectance("gold", [0.45, 0.65])
    >>> bool(gold[0] < 0.45 < 0.9 < gold[1])
    True
    """
    if metal not in METALS:
        raise InputError("spectrum", "metal", metal, f"one of {', '.join(METALS)}")
    index = refractive_index(metal, wavelength)
    return np.abs((index - 1) / (index + 1)) ** 2


def refractive_index(metal: IndexedMetal, wavelength: ArrayLike) -> NDArray[np.complex128]:
    """N = n + ik of a metal, for waves that go with exp(−iωt); interpolated linearly.

    Args:
        metal: One of `INDEXED_METALS`.
        wavelength: µm, 0.38 to 0.78.

    Returns:
        No unit, of the shape of `wavelength`.

    >>> print(f"{complex(refractive_index('iron', 0.549)):.2f}")
    2.95+2.93j
    """
    wavelength_um, n, k = _refractive_index(metal)
    λ = np.asarray(wavelength, dtype=np.float64)
    return np.interp(λ, wavelength_um, n) + 1j * np.interp(λ, wavelength_um, k)


def colour_weights(observer: Observer, light: str | Path) -> Array:
    """S(λ)·(x̄, ȳ, z̄), scaled so that a perfect mirror has Y = 1.

    Returns:
        Shape (401, 3), per µm: sum over `WAVELENGTHS` times 0.001 µm is the light's XYZ.

    Raises:
        InputError: The observer or the light is unknown.

    >>> xyz = colour_weights("1931-2", "D65").sum(axis=0) * WAVELENGTH_STEP
    >>> [round(float(c), 3) for c in xyz]
    [0.95, 1.0, 1.089]
    """
    weights = illuminant(light)[:, None] * colour_matching_functions(observer)
    return weights / (weights[:, 1].sum() * WAVELENGTH_STEP)


def white_xyz(observer: Observer, light: str | Path) -> Array:
    """XYZ of a perfect mirror under the light, Y = 1. Shape (3,)."""
    return colour_weights(observer, light).sum(axis=0) * WAVELENGTH_STEP


def xyz_to_linear_srgb(observer: Observer, light: str | Path) -> Array:
    """Matrix from XYZ under a light to linear sRGB in which a perfect mirror is (1, 1, 1).

    The light's white is adapted to that of sRGB (Bradford), as a camera's white balance does: a
    three.js light of colour white looks white, whichever its spectrum.

    Returns:
        Shape (3, 3).
    """
    to_srgb = colour.RGB_COLOURSPACES["sRGB"].matrix_XYZ_to_RGB
    srgb_white = np.linalg.solve(to_srgb, np.ones(3))
    adaptation = colour.adaptation.matrix_chromatic_adaptation_VonKries(
        white_xyz(observer, light), srgb_white, transform="Bradford"
    )
    return to_srgb @ adaptation


def spectral_columns(file: Path, names: Sequence[str]) -> Array:
    """Columns of a CSV over wavelength on `WAVELENGTHS`, linear between its rows, zero beyond.

    Args:
        file: With a column ``wavelength_um`` (or ``wavelength_nm``), rising, and those of `names`.
        names: Columns to read; none may be negative.

    Returns:
        In the file's unit, shape (401, len(names)).

    Raises:
        InputError: The file cannot be read, a column is missing or holds what it may not.
    """
    try:
        text = file.read_text("utf-8-sig")
    except (OSError, ValueError) as failure:
        raise unreadable(file, failure) from failure
    table = Columns(file, text.splitlines())
    unit = {"wavelength_um": 1.0, "wavelength_nm": 1e-3}
    column = next((name for name in table.header if name in unit), None)
    if column is None or any(name not in table.header for name in names):
        expected = f"columns wavelength_um (or wavelength_nm) and {', '.join(names)}"
        raise InputError(file, "header", ",".join(table.header), expected)
    rows = [rows.numbers for rows in table.read((column, *names))]
    wavelength = np.concatenate([numbers[column] for numbers in rows]) * unit[column]
    if len(wavelength) < 2 or not np.all(np.diff(wavelength) > 0):
        raise InputError(file, column, wavelength.tolist(), "two or more rising wavelengths")
    columns = [np.concatenate([numbers[name] for numbers in rows]) for name in names]
    for name, values in zip(names, columns, strict=True):
        if values.min() < 0:
            raise InputError(file, name, values[values < 0].tolist(), "no negative numbers")
    return _on_grid(wavelength, np.stack(columns, axis=-1))


def _on_grid(wavelength: ArrayLike, values: ArrayLike) -> Array:
    """Linear interpolation to `WAVELENGTHS` (the CIE's own rule for D65), zero outside the data."""
    wavelength, values = np.asarray(wavelength), np.asarray(values)
    columns = [
        np.interp(WAVELENGTHS, wavelength, v, left=0, right=0) for v in np.atleast_2d(values.T)
    ]
    return np.stack(columns, axis=-1).reshape(len(WAVELENGTHS), *values.shape[1:])


@functools.cache
def _refractive_index(metal: IndexedMetal) -> tuple[Array, Array, Array]:
    text = resources.files("precompute").joinpath(f"data/metals/{metal}.csv").read_text("utf-8")
    rows = np.loadtxt(text.splitlines()[2:], delimiter=",")
    return rows[:, 0], rows[:, 1], rows[:, 2]


def _illuminant_from_csv(file: Path) -> Array:
    on_grid = spectral_columns(file, ("power",))[:, 0]
    if on_grid.max() <= 0:
        raise InputError(file, "power", "no light between 0.38 and 0.78 um", "some visible light")
    return on_grid
