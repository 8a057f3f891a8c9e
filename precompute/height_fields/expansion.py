"""exp(ikwh) as a sum of products: coefficients of kw times powers or polynomials of the height.

Up to a constant phase, exp(i k w h) = Σ_n c_n(x) i^n B_n(h), so that a Fourier transform of each
B_n serves every direction and wavelength:

- ``jacobi-anger``: B_n = T_n(t) with the centred height t in [−1, 1], x = k w Δ/2 and
  c_n = ε_n J_n(x), ε_0 = 1, else 2;
- ``taylor``, as the thesis has it: B_n = (h'/Δ)^n with h' = h − min h, x = k w Δ and c_n = x^n/n!.

Δ is the range of the heights. Chebyshev polynomials and Bessel functions stay within [−1, 1], and
c_n falls faster than exponentially from n = x on. Taylor's terms grow to e^x/√(2πx) and cancel: of
their digits as many are lost.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import gammaln, jv, xlogy

from precompute.errors import InputError
from precompute.height_fields.field import HeightField
from precompute.spectra import WAVELENGTH_MIN

Array = NDArray[np.float64]
Expansion = Literal["jacobi-anger", "taylor"]

FLOAT32_EPSILON = float(np.finfo(np.float32).eps)
CANCELLATION_ALLOWED = 1e-2
"""Error of exp(ikwh) that Taylor's cancellation may cause before the method is refused."""


def phase_length(expansion: Expansion, field: HeightField) -> float:
    """x/(kw), µm: Δ/2 where heights are centred, else Δ."""
    return field.amplitude if expansion == "jacobi-anger" else 2 * field.amplitude


def worst_phase(expansion: Expansion, field: HeightField) -> float:
    """x, rad, at the shortest visible wavelength, light and view head-on: w = 2."""
    return 4 * np.pi / WAVELENGTH_MIN * phase_length(expansion, field)


def coefficients(expansion: Expansion, terms: int, x: ArrayLike) -> Array:
    """c_n(x) of the first terms.

    Args:
        expansion: Which series.
        terms: How many.
        x: Phase, rad, 0 or more, shape (n,).

    Returns:
        No unit, shape (terms, n).

    >>> coefficients("taylor", 4, [0.0, 1.0])[:, 1].round(3).tolist()
    [1.0, 1.0, 0.5, 0.167]
    """
    phase = np.asarray(x, dtype=np.float64)
    n = np.arange(terms)[:, None]
    if expansion == "jacobi-anger":
        return np.where(n == 0, 1, 2) * jv(n, phase)
    # By logarithms: neither x^n nor n! overflows on its own.
    return np.exp(xlogy(n, phase) - gammaln(n + 1))


def basis(expansion: Expansion, field: HeightField, terms: int) -> Iterator[Array]:
    """B_0, B_1, … over the patch, no unit, each of the shape of the heights, within [−1, 1].

    T_{n+1} = 2t T_n − T_{n−1} is stable on [−1, 1].

    Args:
        expansion: Which series.
        field: The relief.
        terms: How many B_n.
    """
    if expansion == "taylor":
        height = (field.heights - field.heights.min()) / np.ptp(field.heights)
        power = np.ones_like(height)
        for _ in range(terms):
            yield power
            power = power * height
    else:
        t = field.centred
        before, now = t, np.ones_like(t)  # T_{−1} = T_1
        for _ in range(terms):
            yield now
            before, now = now, 2 * t * now - before


def taylor_error_bound(x: float, last_term: int) -> float:
    """The thesis' bound e^x x^(N+1)/(N+1)! of what Taylor's series leaves out after term N.

    No unit: what it is left out of has the length 1.

    Args:
        x: Largest phase, rad.
        last_term: Its number N.

    >>> f"{taylor_error_bound(1.5 * np.pi, 25):.3e}"
    '8.815e-08'
    """
    return float(np.exp(x + xlogy(last_term + 1, x) - gammaln(last_term + 2)))


def terms_needed(expansion: Expansion, x: float, error: float) -> int:
    """The least number of terms that keeps exp(ix'·) within an error for every phase x' up to x.

    Jacobi–Anger leaves out at most 2 Σ_{n≥N} |J_n(x)|, which rises with x while N > x, as it is
    for errors up to a half; J_n is below 1e-30 from n = 2x + 64 on, by |J_n(x)| ≤ (x/2)^n/n!.
    Taylor's count is from `taylor_error_bound`.

    Args:
        expansion: Which series.
        x: Largest phase, rad.
        error: Largest |error| of exp(ikwh), no unit, in (0, ½].

    Returns:
        Number of terms, 1 or more.

    >>> terms_needed("jacobi-anger", 1.5 * np.pi, 1e-2), terms_needed("taylor", 1.5 * np.pi, 1e-2)
    (9, 19)
    """
    if expansion == "taylor":
        # e^x x^m/m! falls from m = x on and is below 1e-13 at m = 4x + 64.
        counts = np.arange(1, int(4 * x) + 65)
        bounds = x + xlogy(counts, x) - gammaln(counts + 1)
        good = (bounds <= np.log(error)) & (counts >= x)
        return int(counts[np.argmax(good)])
    n = np.arange(int(2 * x) + 65)
    tail = 2 * np.cumsum(np.abs(jv(n, x))[::-1])[::-1]
    return max(1, int(np.argmax(tail <= error)))


def taylor_cancellation(x: float, epsilon: float = FLOAT32_EPSILON) -> float:
    """Error of exp(ix), no unit, that rounding of Taylor's largest term causes: ε · max_n x^n/n!.

    Args:
        x: Phase, rad.
        epsilon: ε of the numbers that store and sum the terms.
    """
    n = np.floor(x)
    return float(epsilon * np.exp(xlogy(n, x) - gammaln(n + 1)))


def check_taylor(field: HeightField, file: str | Path) -> None:
    """Refuses a relief too high for Taylor's series in single precision.

    Args:
        field: The relief.
        file: Its recipe, for the error.

    Raises:
        InputError: Cancellation would cost more than `CANCELLATION_ALLOWED`.
    """
    x = worst_phase("taylor", field)
    lost = taylor_cancellation(x)
    if lost > CANCELLATION_ALLOWED:
        raise InputError(
            file,
            "methods",
            "taylor",
            f"jacobi-anger: at x = k w Δ = {x:.1f} Taylor's terms cancel, and in float32 the sum "
            f"is off by {lost:.2g}, more than {CANCELLATION_ALLOWED:g}",
        )
