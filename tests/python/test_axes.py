"""Texel ↔ parameter mappings, and sampling between texels."""

from typing import Literal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from precompute.axes import Axis
from precompute.lobes import WAVENUMBER_MAX, WAVENUMBER_MIN, lobe_position, lobe_wavenumber
from precompute.maps import Table

Mapping = Literal["linear", "square", "log"]
MAPPINGS: tuple[Mapping, ...] = ("linear", "square", "log")


def axis(mapping: Mapping, size: int, first: float, last: float) -> Axis:
    return Axis(name="p", symbol="p", unit="1", size=size, mapping=mapping, first=first, last=last)


@pytest.mark.parametrize("mapping", MAPPINGS)
@given(
    size=st.integers(2, 1000),
    ends=st.tuples(st.floats(0.01, 100), st.floats(0.01, 100)).filter(
        lambda ends: abs(ends[0] - ends[1]) > 1e-3
    ),
    share=st.floats(0, 1),
)
def test_texels_come_back(
    mapping: Mapping, size: int, ends: tuple[float, float], share: float
) -> None:
    a = axis(mapping, size, *ends)
    texel = share * (size - 1)
    # Near its start a square axis loses digits: x² is added to a number up to 1e5 times the range.
    assert a.texel_from_parameter(a.parameter_from_texel(texel)) == pytest.approx(texel, abs=1e-2)
    parameter = a.parameter_from_texel(texel)
    again = a.parameter_from_texel(a.texel_from_parameter(parameter))
    assert again == pytest.approx(parameter, rel=1e-9)


@pytest.mark.parametrize(
    ("mapping", "expected"),
    [("linear", [1, 5.75, 10.5, 20]), ("square", [1, 2.1875, 5.75, 20]), ("log", None)],
)
def test_the_formulas_that_sidecars_state(mapping: Mapping, expected: list[float] | None) -> None:
    """The web loader has the same formulas; docs/map-format.md states them."""
    a = axis(mapping, 5, 1, 20)
    at = [0, 1, 2, 4]
    expected = expected or [1, 20**0.25, 20**0.5, 20]
    assert a.parameter_from_texel(at) == pytest.approx(expected)
    assert a.parameters()[[0, -1]] == pytest.approx([1, 20])


@pytest.mark.parametrize("mapping", MAPPINGS)
def test_parameters_beyond_the_ends_are_held_at_the_outer_texels(mapping: Mapping) -> None:
    a = axis(mapping, 7, 0.5, 8)
    assert a.texel_from_parameter([-1.0, 0.0, 9.0]).tolist() == [0, 0, 6]


def test_sampling_is_exact_where_the_table_is_linear_in_its_texels() -> None:
    rows, columns = axis("log", 4, 1, 8), axis("square", 5, 0, 16)
    i, j = np.meshgrid(np.arange(4), np.arange(5), indexing="ij")
    values = np.stack([i + 10 * j, 3 * i - j], axis=-1).astype(float)
    table = Table(values, (rows, columns), ("a", "b"))
    # log: 2.83 = 1·8^(1.5/3) is texel 1.5; square: 4 = 16·(2/4)² is texel 2.
    found = table.sample(np.array([8**0.5, 2.0]), np.array([4.0, 16.0]))
    assert found == pytest.approx(np.array([[21.5, 2.5], [41, -1]]))


@given(st.floats(WAVENUMBER_MIN - 0.3, WAVENUMBER_MAX + 0.3), st.floats(0.004, 0.05))
def test_lobe_positions_come_back(wavenumber: float, width: float) -> None:
    s, q = np.array([wavenumber]), np.array([width])
    assert lobe_wavenumber(lobe_position(s, q), q) == pytest.approx(s, rel=1e-12)


def test_lobe_positions_end_three_standard_deviations_beyond_the_visible() -> None:
    q = np.array([0.01, 0.05])
    assert lobe_position(1 / 0.78 - 3 * q, q) == pytest.approx([0, 0], abs=1e-12)
    assert lobe_position(1 / 0.38 + 3 * q, q) == pytest.approx([1, 1])
