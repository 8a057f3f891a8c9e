"""Finite repeats of a patch: closed forms, quadrature, and the limits of one and of many."""

import json
from pathlib import Path

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss
from pydantic import ValidationError
from scipy.integrate import quad

from precompute.gratings import Light
from precompute.height_fields.field import HeightField
from precompute.height_fields.lines import line_amplitudes
from precompute.height_fields.optics import HeightFieldEnergy, HeightFieldOptics
from precompute.height_fields.prepare import prepared
from precompute.height_fields.recipe import HeightFieldRecipe
from precompute.height_fields.reference import colour_brdf, spectral_brdf
from precompute.height_fields.term_sum import TermsMethod
from precompute.height_fields.terms import terms_map
from precompute.height_fields.window import BlurredLobes, CutWindow
from precompute.renderings import Rendering, reference_xyz
from precompute.spectra import metal_reflectance

PERIOD = (2.4, 1.7)
NORMAL = np.array([[0.0, 0.0, 1.0]])


def relief(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """A smooth one, without symmetry, that repeats with `PERIOD`."""
    a, b = 2 * np.pi * x / PERIOD[0], 2 * np.pi * y / PERIOD[1]
    return 0.06 * np.cos(a) + 0.05 * np.cos(2 * a + b + 1) + 0.04 * np.sin(b) + 0.03 * np.cos(3 * b)


def field() -> HeightField:
    y, x = np.meshgrid(
        np.arange(40) / 40 * PERIOD[1], np.arange(48) / 48 * PERIOD[0], indexing="ij"
    )
    return HeightField(relief(x, y), (PERIOD[0] / 48, PERIOD[1] / 40))


def flat(period: float) -> HeightField:
    heights = np.zeros((4, 4))
    heights[0, 0] = 1e-9
    return HeightField(heights, (period / 4, period / 4))


def directions(count: int, seed: int) -> np.ndarray:
    """Spread over the hemisphere down to some 60°."""
    rng = np.random.default_rng(seed)
    θ, φ = np.deg2rad(rng.uniform(0, 60, count)), rng.uniform(0, 2 * np.pi, count)
    return np.stack([np.sin(θ) * np.cos(φ), np.sin(θ) * np.sin(φ), np.cos(θ)], axis=1)


def towards(f: np.ndarray, wi: np.ndarray, λ: np.ndarray) -> np.ndarray:
    """ω_o for which s d is f, shape (n, 2)."""
    xy = λ[:, None] * f - wi[:, :2]
    return np.column_stack([xy, np.sqrt(1 - np.sum(xy**2, axis=1))])


def obliquity(wi: np.ndarray, wo: np.ndarray) -> np.ndarray:
    w = wi[:, 2] + wo[:, 2]
    return (1 + np.sum(wi * wo, axis=1)) ** 2 / (wi[:, 2] * wo[:, 2] * w**2)


def patch_transform(f: np.ndarray, kw: float) -> complex:
    """∫∫ exp(i kw h) exp(2πi f·x) over one patch from its first sample on, by Gauss–Legendre."""
    nodes, weights = leggauss(90)
    x, y = (p * (nodes + 1) / 2 for p in PERIOD)
    wx, wy = (p * weights / 2 for p in PERIOD)
    h = relief(*np.meshgrid(x, y))
    kernel = np.exp(1j * kw * h)
    return complex(
        (wy * np.exp(2j * np.pi * f[1] * y)) @ kernel @ (wx * np.exp(2j * np.pi * f[0] * x))
    )


def dirichlet(n: int, cycles: np.ndarray) -> np.ndarray:
    """|Σ_{m<n} exp(−2πi m cycles)|², as the sum itself."""
    return np.abs(np.exp(-2j * np.pi * np.arange(n) * cycles[..., None]).sum(axis=-1)) ** 2


@pytest.mark.parametrize("n", [1, 2, 5])
def test_the_dirichlet_factor(n: int) -> None:
    """The sum, its closed form and its limit, N² at ωT = 2πm."""
    assert dirichlet(n, np.array([0.0, 3.0])) == pytest.approx(n**2)
    c = np.array([1e-4, 0.13, 0.5001, 2.7])
    closed = np.sin(np.pi * n * c) ** 2 / np.sin(np.pi * c) ** 2
    assert dirichlet(n, c) == pytest.approx(closed, rel=1e-9)


@pytest.mark.parametrize("tiles", [(1, 1), (2, 2), (3, 8), (4, 5)])
def test_without_a_window_it_is_the_patch_times_dirichlet(tiles: tuple[int, int]) -> None:
    optics = HeightFieldOptics(metal=None, coherence=1e5, tiles=tiles)
    rng = np.random.default_rng(3)
    lines = rng.integers(-2, 3, (24, 2)).astype(float)
    # On lines, next to them, in between them.
    lines[8:16] += rng.choice([-1e-6, 1e-6, 1e-3], (8, 2))
    lines[16:] += rng.uniform(-0.5, 0.5, (8, 2))
    f = lines / PERIOD
    wi, λ = directions(24, 1) * [0.4, 0.4, 1], rng.uniform(0.4, 0.7, 24)
    wi /= np.linalg.norm(wi, axis=1, keepdims=True)
    good = np.sum((λ[:, None] * f - wi[:, :2]) ** 2, axis=1) < 0.8
    f, wi, λ = f[good], wi[good], λ[good]
    wo = towards(f, wi, λ)
    kw = 2 * np.pi * (wi[:, 2] + wo[:, 2]) / λ
    one = np.array([np.abs(patch_transform(a, b)) ** 2 for a, b in zip(f, kw, strict=True)])
    repeats = dirichlet(tiles[0], f[:, 0] * PERIOD[0]) * dirichlet(tiles[1], f[:, 1] * PERIOD[1])
    area = np.prod(PERIOD) * np.prod(tiles)
    expected = obliquity(wi, wo) / λ**2 * one * repeats / area
    found = spectral_brdf(field(), optics, wi, wo, λ)
    assert np.sum(good) > 16
    assert found == pytest.approx(expected, rel=1e-6, abs=1e-7 * expected.max())


@pytest.mark.parametrize("length", [5.0, 25.0, 200.0])
def test_the_transform_of_the_window(length: float) -> None:
    window = CutWindow(coherence=16.25, length=length)
    for f in (0.0, 0.01, 0.3):

        def lobe(x: float, f: float = f) -> float:
            return float(np.exp(-(x**2) / (2 * 16.25**2)) * np.cos(2 * np.pi * f * x))

        exact = 2 * quad(lobe, 0, length / 2, limit=500)[0] / np.sqrt(window.area)
        assert window.amplitude(np.array([f]))[0] == pytest.approx(exact, abs=1e-10)


@pytest.mark.parametrize(("coherence", "tiles"), [(1e4, (4, 7)), (16.25, (1, 4)), (6.0, (2, 3))])
def test_flat_mirror_returns_its_reflectance(coherence: float, tiles: tuple[int, int]) -> None:
    optics = HeightFieldOptics(metal="gold", coherence=coherence, tiles=tiles)
    λ, period = 0.38, 13.0
    # |P|² has no wave longer than twice the window: sums with half that step are integrals.
    x, y = (np.arange(-0.45, 0.45, 0.45 * λ / (n * period)) for n in tiles)
    grid = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    wo = np.column_stack([grid, np.sqrt(1 - np.sum(grid**2, axis=1))])
    f = spectral_brdf(flat(period), optics, np.repeat(NORMAL, len(wo), 0), wo, np.full(len(wo), λ))
    found = f.sum() * (x[1] - x[0]) * (y[1] - y[0])  # dx dy = cosθ dω
    assert found == pytest.approx(float(metal_reflectance("gold", λ)), rel=0.01)


@pytest.mark.parametrize(
    ("tiles", "roughness", "radius"),
    [((2, 2), 0.0175, 0.0), ((3, 8), 0.0, 0.0047), ((4, 4), 0.01, 0.02)],
)
def test_blur_spreads_the_power_of_each_line(
    tiles: tuple[int, int], roughness: float, radius: float
) -> None:
    """By a sum over a grid of tilts and directions of light."""
    optics = HeightFieldOptics(metal=None, tiles=tiles, roughness=roughness)
    wi, wo, λ = directions(6, 4), directions(6, 6), np.linspace(0.4, 0.75, 6)
    windows = optics.cut_windows(PERIOD)
    assert windows is not None
    j, l = (np.fft.fftfreq(n, 1 / n) for n in (48, 40))  # noqa: E741
    steps = np.arange(-8, 8.01, 0.125)
    share = np.exp(-(steps**2) / 2) / np.sum(np.exp(-(steps**2) / 2))
    expected = []
    for a, b, length in zip(wi, wo, λ, strict=True):
        d, w, t = (a + b)[:2], a[2] + b[2], a[:2]
        powers = np.abs(line_amplitudes(field(), 2 * np.pi * w / length)) ** 2
        blur = (w * roughness) ** 2 * np.eye(2) + radius**2 * (np.eye(2) - np.outer(t, t))
        total = 0.0
        root = np.linalg.cholesky(blur) / length
        for p, weight in zip(steps, share, strict=True):
            # The lower triangle moves x by the first deviate alone.
            x = d[0] / length + root[0, 0] * p - j / PERIOD[0]
            y = d[1] / length + root[1, 0] * p + root[1, 1] * steps[:, None] - l / PERIOD[1]
            lobes = share @ windows[1].amplitude(y) ** 2
            total += weight * lobes @ powers @ windows[0].amplitude(x) ** 2
        expected.append((1 + a @ b) ** 2 / (a[2] * b[2] * w**2) / length**2 * total)
    found = spectral_brdf(field(), optics, wi, wo, λ, radius)
    assert found == pytest.approx(expected, rel=2e-5, abs=1e-9 * max(expected))


def test_blurred_lobes_are_the_windows_spread() -> None:
    window = CutWindow(coherence=16.25, length=20.0)
    lobes = BlurredLobes(window, (0.004, 0.09), 6.0)
    f = np.array([0.0, 0.03, 0.4, 5.9])
    for b in (0.004, 0.03, 0.09):
        g = np.linspace(-7 * b, 7 * b, 4001)
        weight = np.exp(-(g**2) / (2 * b**2)) / (np.sqrt(2 * np.pi) * b) * (g[1] - g[0])
        exact = window.amplitude(f[:, None] - g) ** 2 @ weight
        assert lobes(f, np.full(4, b)) == pytest.approx(exact, abs=1e-6 * window.peak)


@pytest.mark.parametrize("tiles", [(8, 10), (2000, 4000)])
@pytest.mark.parametrize("blur", [0.0, 0.01])
def test_so_many_repeats_that_the_window_ends_before_them(
    tiles: tuple[int, int], blur: float
) -> None:
    """An even number: the window's middle is then the first sample of a patch."""
    wi, wo, λ = directions(40, 7), directions(40, 8), np.linspace(0.4, 0.75, 40)
    many = HeightFieldOptics(coherence=1.0, tiles=tiles, roughness=blur)
    for_ever = many.model_copy(update={"tiles": None})
    expected = spectral_brdf(field(), for_ever, wi, wo, λ)
    found = spectral_brdf(field(), many, wi, wo, λ)
    assert found == pytest.approx(expected, rel=1e-5, abs=1e-7 * expected.max())


def test_relative_to_the_flat_surface_behind_the_same_window() -> None:
    optics = HeightFieldOptics(metal="gold", energy="relative", tiles=(3, 1))
    λ, head_on = np.linspace(0.38, 0.78, 5), np.repeat(NORMAL, 5, 0)
    assert spectral_brdf(flat(4.0), optics, head_on, head_on, λ) == pytest.approx(1, rel=1e-9)


def test_tiles_are_counts() -> None:
    assert HeightFieldOptics.model_validate({"tiles": 4}).tiles == (4, 4)
    assert HeightFieldOptics.model_validate({"tiles": [3, 8]}).tiles == (3, 8)
    for bad in (0, [2, -1], [1, 2, 3], 2.5, "many"):
        with pytest.raises(ValidationError, match="tiles"):
            HeightFieldOptics.model_validate({"tiles": bad})


@pytest.mark.parametrize(
    ("tiles", "roughness", "radius", "energy"),
    [
        ((3, 2), 0.0, 0.0, "relative"),
        ((3, 4), 0.0175, 0.0, "kirchhoff"),
        ((2, 5), 0.0, 0.02, "kirchhoff"),
    ],
)
def test_the_series_sums_the_same(
    tiles: tuple[int, int], roughness: float, radius: float, energy: HeightFieldEnergy
) -> None:
    optics = HeightFieldOptics(tiles=tiles, roughness=roughness, energy=energy)
    baked = terms_map(field(), "jacobi-anger", None, 1e-3, {}, "waves.json")
    light = Light(angular_radius=radius) if radius else Light()
    xy = np.random.default_rng(4).uniform(-0.5, 0.5, (12, 2))
    wo = np.column_stack([xy, np.sqrt(1 - np.sum(xy**2, axis=1))])
    wi = np.tile([0.3, 0.2, np.sqrt(0.87)], (12, 1))
    found = TermsMethod(baked, optics, step=0.02).colour_brdf(wi, wo, light)
    exact = colour_brdf(field(), optics, wi, wo, light)
    assert np.sqrt(np.mean((found - exact) ** 2) / np.mean(exact**2)) <= 0.01


def test_the_reference_of_a_rendering(tmp_path: Path) -> None:
    (tmp_path / "recipes").mkdir()
    recipe = {"kind": "height-field", "source": {"kind": "cosine", "height": 0.15, "period": 2.5}}
    file = tmp_path / "recipes" / "height-field-x.json"
    file.write_text(json.dumps(recipe), "utf-8")
    position = np.array([[0.3, 0.1, -9.0], [0.2, -0.1, -9.0]])
    layers = {
        name: np.broadcast_to(np.array(value, dtype=np.float64), (1, 2, 4))
        for name, value in (
            ("normal", [0, 0, 1, 1]),
            ("tangent", [1, 0, 0, 0]),
            ("grating", [1, 0, 0, 0]),
        )
    }
    layers["position"] = np.column_stack([position, np.ones(2)])[None]
    towards_light = np.array([0.1, 0.05, np.sqrt(1 - 0.0125)])
    light = {"kind": "directional", "color": [1.0, 1.0, 1.0], "angularRadius": 0}
    rendering = Rendering(
        scene={"surface": {"kind": "height-field", "field": "x", "tiles": [3, 8]}},
        view={"lights": [light | {"direction": towards_light.tolist()}]},
        radiance=np.zeros((1, 2, 3)),
        covered=np.full((1, 2), True),
        layers=layers,
        environment=None,
        backend="none",
    )
    wi = np.tile(towards_light, (2, 1))
    wo = -position / np.linalg.norm(position, axis=1, keepdims=True)
    relief = prepared(HeightFieldRecipe.model_validate(recipe), tmp_path)
    expected = colour_brdf(relief, HeightFieldOptics(tiles=(3, 8)), wi, wo, Light())
    found = reference_xyz(rendering, tmp_path / "baked")
    assert found == pytest.approx(wi[:, 2:] * expected, rel=1e-9)
