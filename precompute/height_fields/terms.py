"""The map of terms: Fourier transforms of powers or polynomials of the height, line by line.

The shaders sum exp(ikwh) = Σ_n c_n(x) i^n B_n(h) (`precompute.height_fields.expansion`) at the few
lines (j/T_x, l/T_y) near a direction. Stored are

    G_n(j, l) = i^n · mean over the patch of B_n exp(+2πi (j x/T_x + l y/T_y)),

two terms to a texel, and c_n(x). B_n is real, so that G_n(−j, −l) = (−1)^n times the conjugate of
G_n(j, l), and half of the plane, j ≥ 0, serves.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from precompute.axes import Axis
from precompute.height_fields.cells import spectrum_cells
from precompute.height_fields.expansion import (
    Expansion,
    basis,
    check_taylor,
    coefficients,
    phase_length,
    terms_needed,
    worst_phase,
)
from precompute.height_fields.field import HeightField
from precompute.height_fields.term_sum import even_and_odd_sums, interpolated_coefficients
from precompute.maps import Map, Table
from precompute.progress import tracked
from precompute.spectra import WAVELENGTH_MIN

Array = NDArray[np.float64]
Lines = tuple[int, int]
"""(J, L): lines from −J to J along x and from −L to L along y."""

FREQUENCY_MAX = 2 / WAVELENGTH_MIN + 1
"""Largest |f| that is kept, 1/µm: |d| = 2 at the shortest wavelength, and how far a lobe reaches
that is as wide as a coherence of 0.6 µm or as 10° of roughness make it."""

POWER_LEFT_OUT = 1e-6
"""Largest share of the power in lines that can be seen but are left out of the table."""

PHASES = 6
"""Values of kw, up to the worst, by which lines are chosen and the error is measured."""

PHASE_MARGIN = 1.01
"""Extent of the coefficients' table over the largest phase."""

COEFFICIENT_ERROR = 1e-4
"""Largest error of linear interpolation between the samples of c_n.

With the step δ of x it is δ²/8 times the largest second derivative: at most 1 for each Bessel
coefficient, and for the sum of the series exp(ixt), |t| ≤ 1, whichever the series; a table of
Taylor's coefficients is off by more, but its errors cancel as they do in the sum."""


def terms_map(
    field: HeightField,
    expansion: Expansion,
    terms: int | None,
    error: float,
    recipe: dict[str, Any],
    file: str | Path,
) -> Map:
    """Bake the terms of one series.

    Args:
        field: The relief.
        expansion: Which series.
        terms: How many; ``None`` for as many as `error` asks for.
        error: Largest error of exp(ikwh), no unit.
        recipe: What the map is baked from, for its sidecar.
        file: The recipe's file, for errors.

    Returns:
        A map of kind ``height-field-terms`` with the arrays ``terms`` (pairs × lines along y ×
        lines along x; half floats, for Taylor floats), ``coefficients`` (terms × x) and those of
        `Cells.tables`.

    Raises:
        InputError: Taylor's terms would cancel beyond use.
    """
    if expansion == "taylor":
        check_taylor(field, file)
    worst = worst_phase(expansion, field)
    count = terms_needed(expansion, worst, error) if terms is None else terms
    phases = worst * np.arange(1, PHASES + 1) / PHASES
    length = phase_length(expansion, field)
    exact = [_visible_amplitudes(field, x / length) for x in phases]
    lines = _lines_kept(field, exact)
    tables = {
        "terms": _terms_table(field, expansion, count, lines),
        "coefficients": _coefficients_table(expansion, count, worst * PHASE_MARGIN),
        **spectrum_cells(field).tables(),
    }
    return Map(
        kind="height-field-terms",
        quantity="terms of the spectrum of exp(ikwh)",
        symbol="G_n(j, l)",
        tables=tables,
        error={
            "relative_rms": _relative_rms(tables, phases, exact),
            "against": "|A_jl(kw)| by direct Fourier transforms, over lines that can be seen",
        },
        recipe=recipe,
        constants={
            "period_x": field.period[0],
            "period_y": field.period[1],
            "amplitude": length,
            "range": 2 * field.amplitude,
            "max_phase": worst * PHASE_MARGIN,
            "terms": count,
        },
    )


def visible_lines(field: HeightField) -> Lines:
    """The lines up to `FREQUENCY_MAX` and below the samples' Nyquist frequency.

    >>> visible_lines(HeightField(np.eye(100), (0.05, 0.1)))
    (31, 49)
    """
    rows, columns = field.heights.shape
    x, y = (int(FREQUENCY_MAX * period) for period in field.period)
    return min(x, (columns - 1) // 2), min(y, (rows - 1) // 2)


def _visible_amplitudes(field: HeightField, kw: float) -> Array:
    """|A_jl(kw)| of the visible lines, shape (2L + 1, 2J + 1); line (j, l) at [l + L, j + J]."""
    j, l = (np.arange(-n, n + 1) for n in visible_lines(field))  # noqa: E741
    amplitudes = np.asarray(scipy.fft.ifft2(np.exp(1j * kw * field.heights), workers=-1))
    return np.abs(amplitudes[np.ix_(l, j)])


def _lines_kept(field: HeightField, amplitudes: list[Array]) -> Lines:
    """The smallest box of lines that leaves out at most `POWER_LEFT_OUT` at any kw."""
    across, along = visible_lines(field)
    outside = np.zeros((along + 1, across + 1))
    for a in amplitudes:
        # Power within the box (J, L), summed over the four quadrants and cumulated.
        power = a**2
        power = power[along:] + np.pad(power[:along][::-1], ((1, 0), (0, 0)))
        power = power[:, across:] + np.pad(power[:, :across][:, ::-1], ((0, 0), (1, 0)))
        within = np.cumsum(np.cumsum(power, axis=0), axis=1)
        outside = np.maximum(outside, within[-1, -1] - within)
    l, j = np.meshgrid(np.arange(along + 1), np.arange(across + 1), indexing="ij")  # noqa: E741
    texels = np.where(outside <= POWER_LEFT_OUT, (2 * l + 1) * (j + 1), np.iinfo(int).max)
    row, column = np.unravel_index(np.argmin(texels), texels.shape)
    return int(column), int(row)


def _terms_table(field: HeightField, expansion: Expansion, count: int, lines: Lines) -> Table:
    across, along = lines
    pairs = (count + 1) // 2
    dtype = "float16" if expansion == "jacobi-anger" else "float32"
    values = np.zeros((pairs, 2 * along + 1, across + 1, 4), dtype)
    rows = np.arange(-along, along + 1)
    description = f"Terms of {expansion}"
    for n, function in enumerate(tracked(basis(expansion, field, count), description, count)):
        # The transform has the exponent −2πi, B_n is real: its conjugate has +2πi.
        spectrum = np.asarray(scipy.fft.rfft2(function, workers=-1))[rows, : across + 1]
        g = (1, 1j, -1, -1j)[n % 4] * np.conj(spectrum) / function.size
        channel = 2 * (n % 2)
        values[n // 2, ..., channel] = g.real
        values[n // 2, ..., channel + 1] = g.imag
    axes = (
        Axis(name="pair of terms", symbol="n/2", unit="1", size=pairs, first=0, last=pairs - 1),
        Axis(
            name="line along y",
            symbol="l",
            unit="1",
            size=2 * along + 1,
            first=-along,
            last=along,
        ),
        Axis(name="line along x", symbol="j", unit="1", size=across + 1, first=0, last=across),
    )
    return Table(values, axes, ("Re even", "Im even", "Re odd", "Im odd"), dtype)


def _coefficients_table(expansion: Expansion, count: int, x_max: float) -> Table:
    samples = int(np.ceil(x_max / np.sqrt(8 * COEFFICIENT_ERROR))) + 1
    phase = Axis(name="phase", symbol="x", unit="rad", size=samples, first=0, last=x_max)
    term = Axis(name="term", symbol="n", unit="1", size=count, first=0, last=count - 1)
    values = coefficients(expansion, count, phase.parameters())
    return Table(values[..., None], (term, phase), ("c_n",), "float32")


def _relative_rms(tables: dict[str, Table], phases: Array, exact: list[Array]) -> float:
    """Of the magnitudes of lines, as stored, lines that are left out counting as zero."""
    terms = tables["terms"].values
    c = interpolated_coefficients(tables["coefficients"], phases)
    even, odd = even_and_odd_sums(terms, c[:, :, None, None])
    along, across = (terms.shape[1] - 1) // 2, terms.shape[2] - 1
    off, power = 0.0, 0.0
    for right, left, a in zip(np.abs(even + odd), np.abs(even - odd), exact, strict=True):
        found = np.zeros_like(a)
        middle_y, middle_x = (n // 2 for n in a.shape)
        box = found[middle_y - along : middle_y + along + 1]
        box[:, middle_x : middle_x + across + 1] = right
        # Line (−j, −l), the column j = 0 being there already.
        box[:, middle_x - across : middle_x] = left[::-1, :0:-1]
        off += float(np.sum((found - a) ** 2))
        power += float(np.sum(a**2))
    return float(np.sqrt(off / power))
