"""Series of exp(ikwh): their coefficients, how many terms they need, and when they fail."""

import numpy as np
import pytest
from refusals import refused

from precompute.height_fields.expansion import (
    CANCELLATION_ALLOWED,
    Expansion,
    basis,
    check_taylor,
    coefficients,
    phase_length,
    taylor_cancellation,
    taylor_error_bound,
    terms_needed,
    worst_phase,
)
from precompute.height_fields.field import HeightField

K_MAX = 2 * np.pi / 0.38


def ramp(height: float) -> HeightField:
    """Every height from 1 µm to `height` above it, at equal steps."""
    return HeightField(1 + height * np.linspace(0, 1, 401)[None], (0.05, 0.05))


@pytest.mark.parametrize(("last", "stated"), [(20, 2.994e-4), (25, 8.815e-8), (30, 1.005e-11)])
def test_the_thesis_error_bounds(last: int, stated: float) -> None:
    assert taylor_error_bound(1.5 * np.pi, last) == pytest.approx(stated, rel=2e-4)


def test_bessel_coefficients_are_their_integrals() -> None:
    """J_n(x) = the mean of cos(nθ − x sin θ) over a circle."""
    θ = 2 * np.pi * np.arange(512) / 512
    x = np.array([0.0, 0.7, 9.0, 80.0, 200.0])
    c = coefficients("jacobi-anger", 101, x)
    for n in (0, 1, 2, 17, 100):
        bessel = np.mean(np.cos(n * θ - x[:, None] * np.sin(θ)), axis=1)
        assert c[n] == pytest.approx((1 if n == 0 else 2) * bessel, abs=1e-12)


@pytest.mark.parametrize("expansion", ["jacobi-anger", "taylor"])
def test_coefficients_are_finite(expansion: Expansion) -> None:
    assert np.isfinite(coefficients(expansion, 900, np.linspace(0, 200, 401))).all()


@pytest.mark.parametrize("expansion", ["jacobi-anger", "taylor"])
@pytest.mark.parametrize("x", [0.1, 2.36, 10.0, 14.0, 40.0, 80.0])
@pytest.mark.parametrize("error", [1e-2, 1e-6])
def test_as_many_terms_as_needed_keep_the_error(
    expansion: Expansion, x: float, error: float
) -> None:
    if expansion == "taylor" and x > 14:
        return  # even in double precision its terms cancel
    field = ramp(0.3)
    count = terms_needed(expansion, x, error)
    # Phases from 0 to x: fewer terms are needed below.
    c = coefficients(expansion, count, [x / 3, x])
    series = sum(c[n][:, None] * 1j**n * b[0] for n, b in enumerate(basis(expansion, field, count)))
    t = np.linspace(-1, 1, 401) if expansion == "jacobi-anger" else np.linspace(0, 1, 401)
    exact = np.exp(1j * np.array([[x / 3], [x]]) * t)
    off = np.abs(series - exact).max()
    assert off <= error
    # And not many more than that: two fewer leave an error that counts.
    if expansion == "jacobi-anger":
        fewer = sum(
            c[n][:, None] * 1j**n * b[0] for n, b in enumerate(basis(expansion, field, count - 3))
        )
        assert np.abs(fewer - exact).max() > error


def test_jacobi_anger_needs_far_fewer_terms() -> None:
    """For one height Taylor's x is twice as large, its heights not being centred."""
    for x in (2.36, 5.0, 6.0):
        ours = terms_needed("jacobi-anger", x, 1e-2)
        assert ours < terms_needed("taylor", 2 * x, 1e-2) / 2


def test_basis_is_chebyshev_polynomials_or_powers() -> None:
    field = ramp(0.2)
    share = np.linspace(0, 1, 401)
    for n, polynomial in enumerate(basis("jacobi-anger", field, 200)):
        assert np.abs(polynomial[0] - np.cos(n * np.arccos(2 * share - 1))).max() < 1e-10
    for n, power in enumerate(basis("taylor", field, 30)):
        assert power[0] == pytest.approx(share**n, abs=1e-12)


def test_the_worst_phase_is_that_of_violet_head_on() -> None:
    field = ramp(0.15)
    assert worst_phase("taylor", field) == pytest.approx(2 * K_MAX * 0.15)
    assert worst_phase("jacobi-anger", field) == pytest.approx(K_MAX * 0.15)
    assert phase_length("taylor", field) == pytest.approx(2 * field.amplitude)


@pytest.mark.parametrize("x", [4.0, 10.0, 16.0, 24.0])
def test_predicted_cancellation_is_what_float32_loses(x: float) -> None:
    count = terms_needed("taylor", x, 1e-6)
    height = np.linspace(0, 1, 2001).astype(np.float32)
    c = coefficients("taylor", count, [x]).astype(np.float32)
    total = np.zeros(len(height), np.complex64)
    for n in range(count):
        total += np.complex64(1j**n) * c[n] * height**n
    lost = np.abs(total - np.exp(1j * x * height.astype(np.float64))).max()
    assert lost / 8 < taylor_cancellation(x) < 8 * lost


def test_taylor_is_refused_where_it_fails() -> None:
    # x = 13.6: ε x^13/13! crosses a hundredth between 13 and 14.
    assert taylor_cancellation(13) < CANCELLATION_ALLOWED < taylor_cancellation(14)
    check_taylor(ramp(13 / (2 * K_MAX)), "field.json")
    with refused("field.json", "methods", "taylor", "jacobi-anger: at x = k w Δ = 14.0"):
        check_taylor(ramp(14 / (2 * K_MAX)), "field.json")
