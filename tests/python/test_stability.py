"""Methods and references with parameters at their ends: nothing that is no number, no dark light.

Directions graze to 89.99° and beyond, to w → 0; light and view are opposite, the same, or random.
What hypothesis finds goes into stability_cases.json, through which a test runs.
"""

from __future__ import annotations

import functools
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from precompute import reference
from precompute.closed_form import ClosedForm, Node
from precompute.errors import InputError
from precompute.gratings import Grating, Light
from precompute.height_fields import reference as height_field_reference
from precompute.height_fields.baked_lookup import BakedLookup
from precompute.height_fields.expansion import Expansion
from precompute.height_fields.field import HeightField
from precompute.height_fields.generate import generated
from precompute.height_fields.optics import HeightFieldOptics
from precompute.height_fields.recipe import Bumps
from precompute.height_fields.term_sum import TermsMethod
from precompute.height_fields.terms import terms_map
from precompute.maps import Map
from precompute.profiles import efficiency
from precompute.report.grating_stability import Edge, grating_stability
from precompute.spectra import WAVELENGTH_MAX, WAVELENGTH_MIN

Array = NDArray[np.float64]
Case = dict[str, Any]

CASES = Path(__file__).parent / "stability_cases.json"
MAPS = Path(__file__).parents[2] / "maps" / "baked"
WIDEST = float(np.deg2rad(30))
NEGATIVE_ALLOWED = 1e-6
"""Of Y, as a share of the largest."""

quickly = settings(
    derandomize=True, database=None, deadline=None, suppress_health_check=[HealthCheck.too_slow]
)


def decades(low: float, high: float) -> st.SearchStrategy[float]:
    """Equally likely in any power of ten, the ends among them."""
    exponents = st.floats(float(np.log10(low)), float(np.log10(high)))
    return st.one_of(st.sampled_from([low, high]), exponents.map(lambda x: float(10**x)))


def or_none(values: st.SearchStrategy[float]) -> st.SearchStrategy[float]:
    return st.one_of(st.just(0.0), values)


polar = st.one_of(
    st.floats(0, 90),
    decades(1e-7, 1).map(lambda x: 90 - x),
    st.sampled_from([0.0, 89.99]),
)
azimuth = st.one_of(st.floats(0, 360), st.sampled_from([0.0, 45.0, 90.0, 180.0, 225.0]))
views = st.one_of(
    st.just(["mirrored"]),
    st.just(["retro"]),
    st.tuples(st.just("across"), st.floats(-1, 1)).map(list),
    st.tuples(st.just("free"), polar, azimuth).map(list),
)
pairs = st.lists(st.tuples(polar, azimuth, views).map(list), min_size=5, max_size=5)
"""Angles of the light in degrees, and where the view is: opposite to it about the normal, towards
it, in the plane of the orders at a share of their largest u, or anywhere."""


def directed(polar_deg: float, azimuth_deg: float) -> Array:
    θ, φ = np.deg2rad([polar_deg, azimuth_deg])
    return np.array([np.sin(θ) * np.cos(φ), np.sin(θ) * np.sin(φ), np.cos(θ)])


def directions(case: Case) -> tuple[Array, Array]:
    """Unit ω_i and ω_o, shape (n, 3)."""
    wi, wo = [], []
    for polar_deg, azimuth_deg, (kind, *where) in case["pairs"]:
        light = directed(polar_deg, azimuth_deg)
        x, y, _ = light
        if kind == "mirrored":
            view = light * [-1, -1, 1]
        elif kind == "retro":
            view = light
        elif kind == "across":
            x = where[0] * np.sqrt(max(1 - y**2, 0))
            view = np.array([x, -y, np.sqrt(max(1 - x**2 - y**2, 0))])
        else:
            view = directed(*where)
        wi.append(light)
        wo.append(view)
    return np.array(wi), np.array(wo)


def assert_sound(radiance: Array) -> None:
    """Finite, and Y no further below zero than rounding goes. radiance: XYZ, or one number each."""
    assert np.isfinite(radiance).all()
    y = radiance[:, 1] if radiance.ndim == 2 else radiance
    assert y.min() >= -NEGATIVE_ALLOWED * y.max()


def light_of(case: Case) -> Light:
    radius = case.get("angular_radius", 0)
    return Light(angular_radius=radius) if radius > 0 else Light()


gratings = st.builds(
    lambda period, coherence, **rest: {
        "kind": "grating",
        "period": period,
        "coherence": period / 4 * (1000 * 4 / period) ** coherence,
        **rest,
    },
    period=decades(0.038, 100),
    coherence=st.one_of(st.sampled_from([0.0, 1.0]), st.floats(0, 1)),
    height=decades(1e-6, 5),
    profile=st.sampled_from(["sinusoidal", "rectangular", "blazed", "triangular"]),
    energy=st.sampled_from(["conserving", "reciprocal", "kirchhoff"]),
    roughness=or_none(decades(1e-6, WIDEST)),
    angular_radius=or_none(decades(1e-6, WIDEST)),
    pairs=pairs,
)

OPTICS = ("roughness", "coherence")
GRATING = (*OPTICS, "period", "height", "profile", "energy")
HIGHEST = 20 * WAVELENGTH_MIN / (4 * np.pi)
"""Of a grating's relief, µm: φ = 20 rad, the tables' last, with w = 2 in violet."""


def check_grating(case: Case) -> None:
    grating = Grating.model_validate({key: case[key] for key in GRATING})
    light = light_of(case)
    wi, wo = directions(case)
    λ = np.resize([WAVELENGTH_MIN, 0.55, WAVELENGTH_MAX], len(wi))
    with np.errstate(divide="raise", invalid="raise", over="raise"):
        assert_sound(reference.spectral_brdf(grating, wi, wo, λ, light.angular_radius))
        if grating.height > HIGHEST:
            with pytest.raises(InputError, match="height"):
                ClosedForm(grating, light)
            return
        method = ClosedForm(grating, light)
        assert_sound(wi[:, 2:] * method.colour_brdf(wi, wo))


def bumps(height: float) -> HeightField:
    return generated(Bumps(height=height, size=(1.5, 1.5), cell=(2.0, 2.0)))


@functools.lru_cache
def terms_of(height: float, expansion: Expansion) -> Map:
    return terms_map(bumps(height), expansion, None, 1e-3, {}, "bumps")


height_fields = st.builds(
    dict,
    kind=st.just("height-field"),
    height=st.sampled_from([1e-4, 0.15, 0.6, 5.0]),
    expansion=st.sampled_from(["taylor", "jacobi-anger"]),
    coherence=decades(0.5, 1000),
    roughness=or_none(decades(1e-6, WIDEST)),
    angular_radius=or_none(decades(1e-6, WIDEST)),
    ior=st.sampled_from([None, 1.0001, 1.5]),
    energy=st.sampled_from(["kirchhoff", "relative"]),
    pairs=pairs,
)


def check_height_field(case: Case) -> None:
    optics = HeightFieldOptics.model_validate(
        {key: case[key] for key in (*OPTICS, "ior", "energy")}
    )
    light = light_of(case)
    wi, wo = directions(case)
    λ = np.resize([WAVELENGTH_MIN, 0.55, WAVELENGTH_MAX], len(wi))
    with np.errstate(divide="raise", invalid="raise", over="raise"):
        exact = height_field_reference.spectral_brdf(
            bumps(case["height"]), optics, wi, wo, λ, light.angular_radius
        )
        assert_sound(wi[:, 2] * exact)
        # Taylor's terms cancel beyond x = k w Δ = 6.8 rad, 0.2 µm.
        if case["expansion"] == "taylor" and case["height"] > 0.25:
            with pytest.raises(InputError):
                terms_of(case["height"], case["expansion"])
            return
        method = TermsMethod(terms_of(case["height"], case["expansion"]), optics, step=0.1)
        assert_sound(wi[:, 2:] * method.colour_brdf(wi, wo, light))


@functools.lru_cache
def baked_bumps() -> BakedLookup:
    return BakedLookup(Map.read(MAPS / "height-field-bumps-baked"))


def check_baked(case: Case) -> None:
    wi, wo = directions(case)
    with np.errstate(divide="raise", invalid="raise", over="raise"):
        assert_sound(wi[:, 2:] * baked_bumps().colour_brdf(wi, wo, Light()))


DISC_NODES = (100, 450)
"""Along the radius and about the circle: a lobe's deviation is at least one step of either."""

furnaces = st.builds(
    lambda period, coherence, **rest: {
        "kind": "furnace",
        "period": period,
        "coherence": max(period, coherence),
        **rest,
    },
    period=decades(0.038, 3),
    height=decades(1e-4, 0.6),
    profile=st.sampled_from(["sinusoidal", "rectangular", "blazed", "triangular"]),
    coherence=decades(0.1, 3),
    roughness=or_none(decades(1e-3, WIDEST)),
    view=st.tuples(polar.filter(lambda θ: θ < 89.99), azimuth),
    wavelength=st.floats(WAVELENGTH_MIN, WAVELENGTH_MAX),
)


def disc() -> tuple[Array, Array]:
    """Directions above the horizon, and shares of ∫ dx dy: Gauss and Legendre's rule along the
    radius, even steps about the circle.
    """
    radial, about = DISC_NODES
    nodes, weights = np.polynomial.legendre.leggauss(radial)
    r, azimuth = (nodes + 1) / 2, 2 * np.pi * np.arange(about) / about
    x, y = (np.outer(r, f(azimuth)).ravel() for f in (np.cos, np.sin))
    area = np.repeat(r * weights / 2, about) * 2 * np.pi / about
    return np.stack([x, y, np.sqrt(1 - x**2 - y**2)], axis=-1), area


def check_furnace(case: Case) -> None:
    """∫ f_r cosθ_i dω_i = ∫ f_r du dv ≤ 1 + 1e-3 without a metal, wherever lobes are cut."""
    fields = {key: case[key] for key in ("period", "height", "profile", "coherence", "roughness")}
    grating = Grating.model_validate({**fields, "metal": None})
    λ = case["wavelength"]
    wi, area = disc()
    wo = np.tile(directed(*case["view"]), (len(wi), 1))
    method = ClosedForm(grating, Light())
    node = Node(λ, 1e-6, np.ones(3))
    for f in (
        reference.spectral_brdf(grating, wi, wo, np.full(len(wi), λ)),
        method.at_node(node, wi, wo),
    ):
        assert_sound(f)
        assert f @ area <= 1 + 1e-3


MARGIN = 8.0
"""Of every order from the horizon, in deviations of its lobe."""

sharp_furnaces = st.builds(
    dict,
    kind=st.just("sharp-furnace"),
    period=decades(0.038, 10),
    height=decades(1e-4, 0.6),
    profile=st.sampled_from(["sinusoidal", "rectangular", "blazed", "triangular"]),
    coherence=decades(20, 1000),
    view=st.tuples(polar.filter(lambda θ: θ < 89.99), azimuth),
    wavelength=st.floats(WAVELENGTH_MIN, WAVELENGTH_MAX),
)


def check_sharp_furnace(case: Case) -> None:
    """Likewise of lobes far narrower than the disc's rule, each by itself, clear of the horizon."""
    fields = {key: case[key] for key in ("period", "height", "profile", "coherence")}
    grating = Grating.model_validate({**fields, "metal": None})
    wo, λ = directed(*case["view"]), case["wavelength"]
    offsets = np.arange(-1200, 1201) * λ / grating.period
    distance = np.hypot(offsets - wo[0], wo[1])
    deviation = λ / (2 * np.sqrt(2) * np.pi * grating.coherence)
    assume(np.abs(1 - distance).min() > MARGIN * deviation)
    step = deviation / 2  # a trapezoidal rule over a Gaussian: exact to 1e-30
    across, along = (step * n.ravel() for n in np.mgrid[-10:11, -10:11])
    x = (offsets[distance < 1][:, None] - wo[0] + across).ravel()
    y = np.tile(along - wo[1], len(x) // len(along))
    wi = np.stack([x, y, np.sqrt(1 - x**2 - y**2)], axis=-1)
    views = np.tile(wo, (len(wi), 1))
    method = ClosedForm(grating, Light())
    node = Node(λ, 1e-6, np.ones(3))
    for f in (
        reference.spectral_brdf(grating, wi, views, np.full(len(wi), λ)),
        method.at_node(node, wi, views),
    ):
        assert_sound(f)
        assert f.sum() * step**2 <= 1 + 1e-3


CHECKS = {
    "furnace": check_furnace,
    "sharp-furnace": check_sharp_furnace,
    "grating": check_grating,
    "height-field": check_height_field,
    "baked": check_baked,
}


@settings(quickly, max_examples=40)
@given(gratings)
def test_gratings(case: Case) -> None:
    check_grating(case)


@settings(quickly, max_examples=15)
@given(height_fields)
def test_height_fields(case: Case) -> None:
    check_height_field(case)


@settings(quickly, max_examples=100)
@given(pairs)
def test_baked_height_field(found: list[Any]) -> None:
    check_baked({"pairs": found})


@settings(quickly, max_examples=30)
@given(furnaces)
def test_white_furnace(case: Case) -> None:
    check_furnace(case)


@settings(quickly, max_examples=100)
@given(sharp_furnaces)
def test_white_furnace_of_sharp_lobes(case: Case) -> None:
    check_sharp_furnace(case)


@settings(quickly, max_examples=20)
@given(gratings, polar.filter(lambda θ: θ < 90), azimuth)
def test_orders_share_the_light(case: Case, polar_deg: float, azimuth_deg: float) -> None:
    """Lobes without width, wherever the horizon: Σ e_m is 1, and no more where both ways agree."""
    fields = {key: case[key] for key in GRATING}
    for energy in ("conserving", "reciprocal"):
        grating = Grating.model_validate({**fields, "energy": energy, "metal": None})
        wo, λ = directed(polar_deg, azimuth_deg), WAVELENGTH_MIN
        orders = reference.propagating_orders(wo, λ, grating.period)
        lights = reference.order_direction(wo, orders, λ, grating.period)
        φ = 2 * np.pi * (lights[:, 2] + wo[2]) * grating.height / λ
        factor = reference.energy_factor(grating, lights, np.tile(wo, (len(lights), 1)), λ)
        shares = factor * [
            float(efficiency(grating.profile, m, p))
            for m, p in zip(orders.tolist(), φ, strict=True)
        ]
        assert_sound(shares)
        assert shares.sum() <= 1 + 1e-3


@pytest.mark.parametrize("case", json.loads(CASES.read_text("utf-8")), ids=lambda c: c["kind"])
def test_what_once_failed(case: Case) -> None:
    CHECKS[case["kind"]](case)


SWEEPS: dict[str, tuple[float, float, Callable[[float], Edge]]] = {
    "roughness, rad": (1e-4, 0.5, lambda x: Edge("", {"roughness": x}, pairs=80)),
    "angular radius, rad": (1e-4, 0.5, lambda x: Edge("", angular_radius=x, pairs=80)),
    "height, um": (1e-3, 0.6, lambda x: Edge("", {"height": x}, pairs=80)),
    "coherence, um": (1.66, 1000, lambda x: Edge("", {"coherence": x}, pairs=80)),
    "period, um": (0.2, 20, lambda x: Edge("", {"period": x}, pairs=80)),
}
"""From its least to its largest value: of one parameter while the others stay as they are."""


@pytest.mark.parametrize("parameter", SWEEPS)
def test_the_closed_forms_error_grows_smoothly(parameter: str) -> None:
    low, high, edge = SWEEPS[parameter]
    values = low * (high / low) ** np.linspace(0, 1, 9)
    errors = np.array([grating_stability(edge(float(value))).rel_rmse for value in values])
    assert errors.max() < 0.025
    # Each value is two or three times the one before: its error at most six times, or 1.2 %.
    steps = errors[1:] / np.maximum(errors[:-1], 0.002)
    assert steps.max() < 6
