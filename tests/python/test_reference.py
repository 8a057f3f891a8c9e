"""The reference against identities that hold whatever the code says."""

import numpy as np
import pytest
from example_profiles import PROFILES

from precompute.gratings import Grating, Light
from precompute.profiles import (
    Blazed,
    Profile,
    efficiency,
    efficiency_table,
)
from precompute.reference import (
    colour_brdf,
    efficiency_above_horizon,
    environment_radiance,
    order_direction,
    order_efficiency,
    propagating_orders,
    spectral_brdf,
)
from precompute.spectra import (
    WAVELENGTHS,
    colour_weights,
    metal_reflectance,
    tint_basis,
    white_xyz,
)


def direction(theta_deg: float, phi_deg: float = 0.0) -> np.ndarray:
    theta, phi = np.deg2rad([theta_deg, phi_deg])
    return np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])


def hemisphere_around(centre: np.ndarray, reach: float, count: int) -> tuple[np.ndarray, float]:
    """A grid over (x, y) around a direction, and its cell's area dx dy = cosθ dω."""
    offset = np.linspace(-reach, reach, count)
    x, y = np.meshgrid(centre[0] + offset, centre[1] + offset)
    z = np.sqrt(1 - x**2 - y**2)
    return np.stack([x, y, z], axis=-1).reshape(-1, 3), (offset[1] - offset[0]) ** 2


@pytest.mark.parametrize("profile", PROFILES, ids=lambda p: p.kind)
@pytest.mark.parametrize("phase", [0.0, 0.3, 3.7, 9.9])
def test_parseval(profile: Profile, phase: float) -> None:
    orders = range(-4000, 4001) if profile.kind in ("rectangular", "blazed") else range(-400, 401)
    # The two jumps, at most 2 each, leave at most Σ_{|m|>M} (2² + 2²)/(2πm)² = 16/(4π² M) beyond M.
    tail = 16 / (4 * np.pi**2 * len(orders) / 2)
    total = sum(float(efficiency(profile, m, phase)) for m in orders)
    assert total == pytest.approx(1, abs=max(tail, 1e-8))


@pytest.mark.parametrize("profile", PROFILES, ids=lambda p: p.kind)
def test_amplitude_is_the_fourier_coefficient_of_the_phase(profile: Profile) -> None:
    ξ = (np.arange(200_000) + 0.5) / 200_000
    for order, phase in [(0, 1.0), (1, 2.5), (-2, 7.0), (5, 9.0)]:
        integrand = np.exp(1j * (phase * profile.height(ξ) + 2 * np.pi * order * ξ))
        assert profile.amplitude(order, phase) == pytest.approx(integrand.mean(), abs=1e-6)


@pytest.mark.parametrize("profile", PROFILES, ids=lambda p: p.kind)
def test_fft_table_agrees_with_the_closed_form(profile: Profile) -> None:
    phases = np.array([0.0, 0.5, 4.0, 19.0])
    table = efficiency_table(profile, phases, 16)
    exact = np.stack([efficiency(profile, m, phases) for m in range(-16, 17)])
    assert np.abs(table - exact).max() < 2e-4  # one cell of 16384 straddles a jump


@pytest.mark.parametrize("energy", ["conserving", "kirchhoff", "reciprocal"])
@pytest.mark.parametrize("theta", [0.0, 35.0, 60.0])
def test_flat_mirror_returns_its_reflectance(energy: str, theta: float) -> None:
    mirror = Grating.model_validate(
        {"period": 1.0, "height": 1e-9, "metal": "gold", "energy": energy}
    )
    wi = direction(theta, 20)
    centre = wi * [-1, -1, 1]
    for wavelength in (0.42, 0.7):
        reach = 8 * wavelength / (np.sqrt(8) * np.pi * mirror.coherence)
        wo, area = hemisphere_around(centre, reach, 81)
        f = spectral_brdf(mirror, np.broadcast_to(wi, wo.shape), wo, np.full(len(wo), wavelength))
        expected = float(metal_reflectance("gold", wavelength))
        # Kirchhoff's factor is 1 at the mirror direction only; across the lobe it is even to 1e-3.
        assert f.sum() * area == pytest.approx(
            expected, rel=2e-3 if energy == "kirchhoff" else 1e-6
        )


def kirchhoff_amplitude_squared(grating: Grating, u: float, v: float, w: float, λ: float) -> float:
    """|P|²/(λ²A) by brute force over x, the y integral of the Gaussian window known."""
    σ = grating.coherence
    x = np.linspace(-8 * σ, 8 * σ, 400_001)
    k = 2 * np.pi / λ
    h = grating.height * grating.profile.height(x / grating.period)
    integrand = np.exp(-(x**2) / (2 * σ**2) + 1j * k * (u * x + w * h))
    along = np.sum(integrand) * (x[1] - x[0])
    across = np.sqrt(2 * np.pi) * σ * np.exp(-((k * v * σ) ** 2) / 2)
    return float(np.abs(along * across) ** 2 / (λ**2 * np.pi * σ**2))


@pytest.mark.parametrize("profile", PROFILES, ids=lambda p: p.kind)
@pytest.mark.parametrize("coherence", [16.25, 1.0])  # at 1 µm the orders overlap and interfere
def test_lobes_are_the_kirchhoff_integral(profile: Profile, coherence: float) -> None:
    grating = Grating(
        period=2.0, height=0.2, profile=profile, metal=None, coherence=coherence, energy="kirchhoff"
    )
    wi, λ = direction(25, 10), 0.55
    for order, shift in [(0, 0.002), (1, -0.004), (-1, 0.003), (2, 0.0)]:
        wo = order_direction(wi, order, λ, 2.0)
        wo = np.array([wo[0] + shift, wo[1] + 0.001, 0])
        wo[2] = np.sqrt(1 - wo[0] ** 2 - wo[1] ** 2)
        u, v, w = wi + wo
        obliquity = (1 + wi @ wo) ** 2 / (wi[2] * wo[2] * w**2)
        expected = obliquity * kirchhoff_amplitude_squared(grating, u, v, w, λ)
        actual = spectral_brdf(grating, wi[None], wo[None], np.array([λ]))[0]
        assert actual == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("profile", PROFILES, ids=lambda p: p.kind)
def test_orders_that_interfere_have_each_its_own_depth_of_phase(profile: Profile) -> None:
    """|Σ c_m(φ_m) √N_m|², with the energy that gives every order its own w."""
    grating = Grating(period=1.0, height=2.0, profile=profile, metal=None, coherence=0.3)
    wi, wo, λ = direction(30, 180), direction(10), 0.45
    u, v, _ = wi + wo
    deviation = λ / (np.sqrt(8) * np.pi * grating.coherence)
    amplitude = 0j
    for order in range(-6, 7):
        lit = 1 - (order * λ - wo[0]) ** 2 - wo[1] ** 2
        φ = 2 * np.pi * (wo[2] + np.sqrt(max(lit, 0))) * grating.height / λ
        distance = (u - order * λ) ** 2 + v**2
        lobe = np.exp(-distance / (4 * deviation**2)) / (np.sqrt(2 * np.pi) * deviation)
        amplitude += profile.amplitude(order, φ) * lobe
    n = efficiency_above_horizon(grating, wo, λ)
    actual = spectral_brdf(grating, wi[None], wo[None], np.array([λ]))[0]
    assert actual * n == pytest.approx(abs(amplitude) ** 2, rel=1e-6)


@pytest.mark.parametrize("roughness", [0.0, 0.05, 0.5])
@pytest.mark.parametrize("profile", PROFILES, ids=lambda p: p.kind)
def test_where_orders_interfere_no_light_is_negative(profile: Profile, roughness: float) -> None:
    grating = Grating(period=1.0, height=5.0, profile=profile, coherence=0.25, roughness=roughness)
    x = np.linspace(-0.999, 0.999, 400)
    wi = np.stack([x, 0 * x, np.sqrt(1 - x**2)], axis=-1)
    for theta in (0, 40, 85):
        wo = np.tile(direction(theta), (len(wi), 1))
        f = spectral_brdf(grating, wi, wo, np.full(len(wi), 0.45), 0.02)
        assert f.max() > 0
        assert f.min() >= -1e-12 * f.max()


def test_a_source_and_tilted_normals_widen_the_lobe_as_averages_over_them() -> None:
    """Covariances against brute-force means over source directions and over tilted frames."""
    sharp = Grating(period=1.5, height=0.15, metal=None)
    rough = sharp.model_copy(update={"roughness": 0.01})
    rng = np.random.default_rng(1)
    wi, λ = direction(30, 25), 0.55
    wo = order_direction(wi, 1, λ, 1.5)
    wo = np.array([wo[0] + 0.008, wo[1] - 0.005, 0.0])
    wo[2] = np.sqrt(1 - wo[:2] @ wo[:2])
    tilt = 0.01 * rng.standard_normal((400_000, 2))

    def rotated(w: np.ndarray) -> np.ndarray:
        # Components of a fixed direction in a frame whose normal is tilted by ε = (εx, εy).
        moved = np.stack(
            [w[0] - tilt[:, 0] * w[2], w[1] - tilt[:, 1] * w[2], np.full(len(tilt), w[2])], -1
        )
        moved[:, 2] += tilt @ w[:2]
        return moved / np.linalg.norm(moved, axis=-1, keepdims=True)

    lam = np.full(len(tilt), λ)
    mean = spectral_brdf(sharp, rotated(wi), rotated(wo), lam).mean()
    actual = spectral_brdf(rough, wi[None], wo[None], lam[:1])[0]
    assert actual == pytest.approx(mean, rel=0.03)

    e1 = np.cross(wi, [0, 1, 0])
    e1 /= np.linalg.norm(e1)
    source = wi + tilt[:, :1] * e1 + tilt[:, 1:] * np.cross(wi, e1)
    source /= np.linalg.norm(source, axis=-1, keepdims=True)
    mean = spectral_brdf(sharp, source, np.broadcast_to(wo, source.shape), lam).mean()
    actual = spectral_brdf(sharp, wi[None], wo[None], lam[:1], angular_radius=0.01)[0]
    assert actual == pytest.approx(mean, rel=0.03)


@pytest.mark.parametrize("period", [0.6, 1.0, 1.666])
def test_order_positions(period: float) -> None:
    """The brightest direction of each order is where sinθ_m = mλ/a − sinθ_i says."""
    grating = Grating(period=period, height=0.1)
    wi, λ = direction(10), 0.53
    for order in propagating_orders(wi, λ, period):
        expected = np.arcsin(order * λ / period - np.sin(np.deg2rad(10)))
        θ = expected + np.linspace(-0.02, 0.02, 2001)
        θ = θ[np.abs(θ) < np.pi / 2]
        wo = np.stack([np.sin(θ), np.zeros_like(θ), np.cos(θ)], -1)
        f = spectral_brdf(grating, np.broadcast_to(wi, wo.shape), wo, np.full(len(wo), λ))
        # The energy factor tilts a lobe of width 0.004 a little: 0.002 rad is a tenth of a degree.
        assert θ[np.argmax(f * np.cos(θ))] == pytest.approx(expected, abs=2e-3)


def test_conical_mounting_keeps_the_component_along_the_groove() -> None:
    wi = direction(50, 70)
    for order in propagating_orders(wi, 0.6, 1.8):
        wo = order_direction(wi, order, 0.6, 1.8)
        assert wo[1] == pytest.approx(-wi[1])
        assert wo[0] + wi[0] == pytest.approx(order * 0.6 / 1.8)
        assert np.linalg.norm(wo) == pytest.approx(1)


@pytest.mark.parametrize("theta", [0.0, 20.0, -15.0])
def test_blazed_grating_throws_its_light_where_its_facet_mirrors(theta: float) -> None:
    grating = Grating(period=4.0, height=0.55, profile=Blazed())
    λ = 0.5
    normal = np.array([-grating.height, 0, grating.period])
    normal /= np.linalg.norm(normal)
    wi = direction(theta)
    mirror = 2 * (normal @ wi) * normal - wi
    orders = propagating_orders(wi, λ, grating.period)
    strongest = max(orders, key=lambda m: order_efficiency(grating, wi, int(m), λ)[0])
    directions = [order_direction(wi, m, λ, grating.period) for m in orders]
    nearest = orders[int(np.argmax([wo @ mirror for wo in directions]))]
    assert strongest == nearest
    assert strongest < 0


@pytest.mark.parametrize("theta", [0.0, 45.0, 80.0, 89.0])
@pytest.mark.parametrize("profile", PROFILES, ids=lambda p: p.kind)
def test_white_furnace_returns_the_metal(theta: float, profile: Profile) -> None:
    grating = Grating(period=1.3, height=0.2, profile=profile, metal="gold")
    wo = direction(theta, 33)[None]
    every = slice(None, None, 8)
    actual = environment_radiance(grating, wo, np.ones_like, Light(), WAVELENGTHS[every])
    white = colour_weights("1931-2", "D65") * tint_basis().sum(axis=1, keepdims=True)
    seen = (metal_reflectance("gold")[:, None] * white)[every]
    expected = 0.008 * seen.sum(axis=0)
    assert actual[0] == pytest.approx(expected, rel=1e-9)


def test_reciprocal_choice_is_reciprocal_and_never_gains() -> None:
    grating = Grating(period=1.0, height=0.15, metal=None, energy="reciprocal")
    rng = np.random.default_rng(3)
    wi, wo = direction(40, 15), direction(25, 190)
    λ = np.array([0.5])
    forward = spectral_brdf(grating, wi[None], wo[None], λ, 0.1)
    backward = spectral_brdf(grating, wo[None], wi[None], λ, 0.0)
    assert backward >= 0 and forward >= 0
    for _ in range(50):
        w = direction(rng.uniform(0, 89), rng.uniform(0, 360))
        orders = propagating_orders(w, 0.5, 1.0)
        assert sum(order_efficiency(grating, w, int(m), 0.5)[1] for m in orders) <= 1 + 1e-9
        m = int(rng.choice(orders))
        other = order_direction(w, m, 0.5, 1.0)
        there = order_efficiency(grating, w, m, 0.5)[1]
        back = order_efficiency(grating, other, m, 0.5)[1]
        assert there == pytest.approx(back, rel=1e-9)


def test_mirror_colour_is_the_white_point() -> None:
    mirror = Grating(period=1.0, height=1e-9, metal=None)
    wi = direction(30)
    wo, area = hemisphere_around(wi * [-1, -1, 1], 0.06, 161)
    xyz = colour_brdf(mirror, np.broadcast_to(wi, wo.shape), wo, Light()).sum(axis=0) * area
    assert xyz == pytest.approx(white_xyz("1931-2", "D65"), rel=1e-4)
