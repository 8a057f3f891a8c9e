"""The reference for height fields against closed forms, gratings and brute force."""

import json
from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError

from precompute.gratings import Grating, Light
from precompute.height_fields.expansion import terms_needed
from precompute.height_fields.field import HeightField
from precompute.height_fields.lines import Interpolation, line_amplitudes
from precompute.height_fields.optics import HeightFieldOptics
from precompute.height_fields.reference import colour_brdf, spectral_brdf
from precompute.reference import colour_brdf as grating_colour_brdf
from precompute.reference import spectral_brdf as grating_brdf
from precompute.renderings import Rendering, reference_xyz
from precompute.spectra import metal_reflectance, white_xyz

NORMAL = np.array([[0.0, 0.0, 1.0]])


def direction(theta_deg: float, phi_deg: float = 0.0) -> np.ndarray:
    θ, φ = np.deg2rad([theta_deg, phi_deg])
    return np.array([np.sin(θ) * np.cos(φ), np.sin(θ) * np.sin(φ), np.cos(θ)])


def directions(count: int, seed: int) -> np.ndarray:
    """Spread over the hemisphere down to some 70°."""
    rng = np.random.default_rng(seed)
    θ, φ = rng.uniform(0, 70, count), rng.uniform(0, 360, count)
    return np.stack([direction(*angles) for angles in zip(θ, φ, strict=True)])


def lifted(xy: np.ndarray) -> np.ndarray:
    return np.column_stack([xy, np.sqrt(1 - np.sum(xy**2, axis=1))])


def rough_patch(rows: int, columns: int, height: float, pitch: float = 0.08) -> HeightField:
    """Smooth random relief: waves of some 0.4 µm and more."""
    rng = np.random.default_rng(rows)
    y, x = np.meshgrid(np.arange(rows) / rows, np.arange(columns) / columns, indexing="ij")
    heights = np.zeros((rows, columns))
    for j in range(-4, 5):
        for l in range(5):  # noqa: E741
            wave = np.cos(2 * np.pi * (j * x + l * y) + rng.uniform(0, 6))
            heights += rng.normal() * wave
    heights = (heights - heights.min()) / np.ptp(heights)
    return HeightField(height * heights, (pitch, pitch))


def cosine_patch(height: float, period: float) -> HeightField:
    x = np.arange(64) / 64
    heights = np.tile(height * (1 + np.cos(2 * np.pi * x)) / 2, (8, 1))
    return HeightField(heights, (period / 64, 0.09))


@pytest.mark.parametrize("kw", [0.0, 5.0, 33.0])
def test_parseval(kw: float) -> None:
    amplitudes = line_amplitudes(rough_patch(40, 48, 0.6), kw)
    assert np.sum(np.abs(amplitudes) ** 2) == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize(("z", "more"), [(0.01, 22), (1.0, 22), (10.0, 22), (40.0, 33)])
def test_few_nodes_interpolate_an_amplitude(z: float, more: int) -> None:
    """exp(iκt), |t| ≤ 1, of which amplitudes are means, over an interval of 2z."""
    kw = np.linspace(100, 100 + 2 * z, 333)
    nodes = 1 + terms_needed("jacobi-anger", z, 1e-12)
    assert nodes <= z + more
    over = Interpolation(kw, nodes)
    t = np.linspace(-1, 1, 41)
    found = over.weights(kw) @ np.exp(1j * over.nodes[:, None] * t)
    assert np.abs(found - np.exp(1j * kw[:, None] * t)).max() < 3e-12


@pytest.mark.parametrize("coherence", [16.25, 3.0])
@pytest.mark.parametrize("blur", [0.0, 0.006])
@pytest.mark.parametrize("theta", [0.0, 40.0])
def test_flat_mirror_returns_its_reflectance(coherence: float, blur: float, theta: float) -> None:
    flat = HeightField(1e-9 * rough_patch(16, 24, 1).heights, (0.08, 0.08))
    optics = HeightFieldOptics(metal="gold", coherence=coherence, roughness=blur)
    wi = direction(theta, 20)
    for λ in (0.42, 0.7):
        reach = 7 * np.hypot(λ / (np.sqrt(8) * np.pi * coherence), 2 * blur)
        offset = np.linspace(-reach, reach, 61)
        x, y = np.meshgrid(offset - wi[0], offset - wi[1])
        wo = lifted(np.column_stack([x.ravel(), y.ravel()]))
        f = spectral_brdf(flat, optics, np.tile(wi, (len(wo), 1)), wo, np.full(len(wo), λ))
        area = (offset[1] - offset[0]) ** 2  # dx dy = cosθ dω
        # Obliquity and a tilt's w change over the lobe, to second order in its width.
        expected = pytest.approx(float(metal_reflectance("gold", λ)), rel=2e-3 + 10 * reach**2 / 49)
        assert f.sum() * area == expected


@pytest.mark.parametrize(
    ("coherence", "roughness", "radius"),
    [
        (16.25, 0, 0),
        (1.0, 0, 0),  # the orders interfere
        (16.25, 0.01, 0),
        (16.25, 0, 0.02),
        (16.25, 0.004, 0.006),
    ],
)
def test_a_cosine_is_the_sinusoidal_grating(
    coherence: float, roughness: float, radius: float
) -> None:
    field = cosine_patch(0.2, 2.0)
    optics = {"metal": "gold", "coherence": coherence, "roughness": roughness}
    grating = Grating(period=2.0, height=0.2, energy="kirchhoff", **optics)
    rng = np.random.default_rng(5)
    λ = rng.uniform(0.38, 0.78, 300)
    wi = directions(300, 1)
    d = np.column_stack([rng.integers(-3, 4, 300) * λ / 2, np.zeros(300)])
    wo_xy = d + 0.02 * rng.normal(size=(300, 2)) - wi[:, :2]
    good = np.sum(wo_xy**2, axis=1) < 0.9
    wi, λ, wo = wi[good], λ[good], lifted(wo_xy[good])
    found = spectral_brdf(field, HeightFieldOptics.model_validate(optics), wi, wo, λ, radius)
    exact = grating_brdf(grating, wi, wo, λ, radius)
    assert found == pytest.approx(exact, rel=2e-6, abs=1e-9 * exact.max())


def test_the_colour_of_a_cosine_is_that_of_the_sinusoidal_grating() -> None:
    grating = Grating(period=2.0, height=0.2, energy="kirchhoff", roughness=0.01)
    light = Light(illuminant="A", tint=(1, 0.4, 0.2))
    wi = np.tile(direction(30, 10), (20, 1))
    wo = lifted(np.column_stack([np.linspace(-0.9, 0.9, 20), np.full(20, -0.08)]))
    found = colour_brdf(cosine_patch(0.2, 2.0), HeightFieldOptics(roughness=0.01), wi, wo, light)
    exact = grating_colour_brdf(grating, wi, wo, light)
    assert found == pytest.approx(exact, rel=1e-5, abs=1e-8 * exact.max())


def test_it_is_the_kirchhoff_integral() -> None:
    """|P|²/A by summing over the samples of a plane of repeats, nothing known of lines."""
    field, σ = rough_patch(20, 24, 0.3), 1.5
    optics = HeightFieldOptics(metal=None, coherence=σ)
    rows, columns = field.heights.shape
    i, j = np.arange(-160, 161), np.arange(-160, 161)
    h = field.heights[np.ix_(j % rows, i % columns)]
    x, y = np.meshgrid(i * field.pitch[0], j * field.pitch[1])
    window = np.exp(-(x**2 + y**2) / (2 * σ**2)) * field.pitch[0] * field.pitch[1]
    wi, wo = directions(8, 2), directions(8, 3)
    λ = np.linspace(0.4, 0.75, 8)
    for a, b, length in zip(wi, wo, λ, strict=True):
        u, v, w = a + b
        p = np.sum(window * np.exp(2j * np.pi / length * (u * x + v * y + w * h)))
        obliquity = (1 + a @ b) ** 2 / (a[2] * b[2] * w**2)
        expected = obliquity / length**2 * np.abs(p) ** 2 / (np.pi * σ**2)
        found = spectral_brdf(field, optics, a[None], b[None], np.array([length]))[0]
        assert found == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(
    ("coherence", "roughness", "radius"),
    [(16.25, 0.0175, 0), (1.5, 0, 0.0047), (16.25, 0, 0.0047), (2.0, 0.01, 0.04)],
)
def test_blurred_lobes_are_the_sum_over_lines(
    coherence: float, roughness: float, radius: float
) -> None:
    field = rough_patch(20, 24, 0.5)
    optics = HeightFieldOptics(coherence=coherence, roughness=roughness, metal=None)
    j, l = (np.fft.fftfreq(n, 1 / n) for n in (24, 20))  # noqa: E741
    f = np.stack(np.meshgrid(j / field.period[0], l / field.period[1]), axis=-1).reshape(-1, 2)
    wi, wo, λ = directions(5, 4), directions(5, 6), np.linspace(0.39, 0.77, 5)
    expected = []
    for a, b, length in zip(wi, wo, λ, strict=True):
        d, w, t = (a + b)[:2], a[2] + b[2], a[:2]
        powers = np.abs(line_amplitudes(field, 2 * np.pi * w / length).ravel()) ** 2
        c = np.eye(2) / (8 * np.pi**2 * coherence**2)
        c += ((w * roughness) ** 2 * np.eye(2) + radius**2 * (np.eye(2) - np.outer(t, t))) / (
            length**2
        )
        away = d / length - f
        exponent = np.einsum("ni,ij,nj->n", away, np.linalg.inv(c), away) / 2
        density = powers @ np.exp(-exponent) / (2 * np.pi * np.sqrt(np.linalg.det(c)))
        expected.append((1 + a @ b) ** 2 / (a[2] * b[2] * w**2) / length**2 * density)
    found = spectral_brdf(field, optics, wi, wo, λ, radius)
    assert found == pytest.approx(expected, rel=1e-6, abs=1e-12 * max(expected))


def test_with_blur_windows_stand_anywhere_on_the_patch() -> None:
    """The average of |P|²/A over the window's places is what is left at next to no blur."""
    field = rough_patch(12, 14, 0.4)
    optics = HeightFieldOptics(coherence=0.4, metal=None)
    wi, wo, λ = directions(6, 7), directions(6, 8), np.linspace(0.4, 0.75, 6)
    moved = [
        HeightField(np.roll(field.heights, (i, j), axis=(0, 1)), field.pitch)
        for i in range(12)
        for j in range(14)
    ]
    places = [spectral_brdf(one, optics, wi, wo, λ) for one in moved]
    found = spectral_brdf(field, optics, wi, wo, λ, angular_radius=1e-4)
    assert np.max(np.std(places, axis=0) / found) > 0.1
    assert found == pytest.approx(np.mean(places, axis=0), rel=1e-4)


@pytest.mark.parametrize(("roughness", "tolerance"), [(0.0, 1e-9), (0.01, 5e-6)])
def test_directions_asked_together_are_as_asked_alone(roughness: float, tolerance: float) -> None:
    field = rough_patch(24, 20, 1.5)
    optics = HeightFieldOptics(roughness=roughness, coherence=4)
    wi, wo = directions(400, 7), directions(400, 8)
    λ = np.random.default_rng(9).uniform(0.38, 0.78, 400)
    together = spectral_brdf(field, optics, wi, wo, λ)
    for row in range(0, 400, 25):
        r = slice(row, row + 1)
        alone = spectral_brdf(field, optics, wi[r], wo[r], λ[r])
        assert together[r] == pytest.approx(alone, rel=tolerance, abs=1e-12 * together.max())


def test_blazed_relief_throws_its_light_where_its_facet_mirrors() -> None:
    period, height, λ = 4.0, 0.55, 0.5
    x = np.arange(512) / 512
    field = HeightField(np.tile(height * x, (4, 1)), (period / 512, 0.05))
    optics = HeightFieldOptics()
    normal = np.array([-height, 0, period]) / np.hypot(height, period)
    for theta in (0.0, 20.0, -15.0):
        wi = direction(theta)
        mirror = 2 * (normal @ wi) * normal - wi
        angle = np.linspace(-80, 80, 16001)
        wo = np.stack([direction(a) for a in angle])
        f = spectral_brdf(field, optics, np.tile(wi, (len(wo), 1)), wo, np.full(len(wo), λ))
        brightest = wo[np.argmax(f * wo[:, 2])]
        order = (brightest + wi)[0] * period / λ
        assert order == pytest.approx(round(order), abs=0.05)
        assert round(order) == round((mirror + wi)[0] * period / λ) < 0


@pytest.mark.parametrize("material", [{"metal": "gold"}, {"ior": 1.5}, {"metal": None}])
def test_relative_to_itself_a_mirror_is_white(material: dict[str, object]) -> None:
    flat = HeightField(1e-9 * rough_patch(16, 24, 1).heights, (0.08, 0.08))
    optics = HeightFieldOptics.model_validate(material | {"energy": "relative", "coherence": 7})
    λ = np.linspace(0.38, 0.78, 5)
    head_on = np.tile(NORMAL, (5, 1))
    assert spectral_brdf(flat, optics, head_on, head_on, λ) == pytest.approx(1, rel=1e-6)
    xyz = colour_brdf(flat, optics, NORMAL, NORMAL, Light())
    assert xyz[0] == pytest.approx(white_xyz("1931-2", "D65"), rel=1e-4)
    # Elsewhere it is the absolute one over the flat surface's, R s² 4πσ².
    absolute = optics.model_copy(update={"energy": "kirchhoff"})
    field, wi, wo = rough_patch(20, 24, 0.3), directions(5, 1), directions(5, 2)
    flat_brdf = absolute.reflectance(head_on, head_on, λ) * 4 * np.pi * 7**2 / λ**2
    expected = spectral_brdf(field, absolute, wi, wo, λ) / flat_brdf
    assert spectral_brdf(field, optics, wi, wo, λ) == pytest.approx(expected, rel=1e-12)


def test_a_dielectric_reflects_as_fresnel_says() -> None:
    for degrees in (0.0, 30.0, 60.0, 85.0):
        θ = np.deg2rad(degrees)
        inside = np.arcsin(np.sin(θ) / 1.5)
        if degrees == 0:
            expected = 0.04
        else:
            across = np.sin(θ - inside) / np.sin(θ + inside)
            along = np.tan(θ - inside) / np.tan(θ + inside)
            expected = (across**2 + along**2) / 2
        # The angle counts from the half vector, wherever that points.
        half = direction(20, 130)
        side = np.cross(half, [0, 1, 0])
        side /= np.linalg.norm(side)
        wi, wo = (np.cos(θ) * half + s * np.sin(θ) * side for s in (1, -1))
        found = HeightFieldOptics(ior=1.5).reflectance(wi[None], wo[None], np.array([0.5]))
        assert found[0] == pytest.approx(expected, rel=1e-9)


def test_a_material_is_a_metal_or_a_dielectric() -> None:
    assert HeightFieldOptics().metal == "aluminium"
    assert HeightFieldOptics(ior=1.5).metal is None
    with pytest.raises(ValidationError, match="a metal or a dielectric"):
        HeightFieldOptics(ior=1.5, metal="gold")
    with pytest.raises(ValidationError, match="ior"):
        HeightFieldOptics(ior=1.0)


def test_nothing_leaves_below_the_horizon() -> None:
    below = direction(100)[None]
    field, λ = rough_patch(16, 16, 0.2), np.array([0.5])
    for wi, wo in ((below, NORMAL), (NORMAL, below)):
        assert spectral_brdf(field, HeightFieldOptics(roughness=0.01), wi, wo, λ) == [0.0]


def test_the_reference_of_a_rendering(tmp_path: Path) -> None:
    """Two pixels of a tilted surface, one light, the relief turned by 30° on it."""
    (tmp_path / "recipes").mkdir()
    recipe = {"kind": "height-field", "source": {"kind": "cosine", "height": 0.15, "period": 2.5}}
    (tmp_path / "recipes" / "height-field-x.json").write_text(json.dumps(recipe), "utf-8")
    n, t = direction(10, 40), np.cross([0, 1, 0], direction(10, 40))
    t /= np.linalg.norm(t)
    x = np.cos(np.pi / 6) * t + np.sin(np.pi / 6) * np.cross(n, t)
    position = np.array([[0.3, 0.1, -9.0], [0.2, -0.1, -9.0]])
    layers = {
        name: np.broadcast_to(np.asarray(value, dtype=np.float64), (1, 2, 4))
        for name, value in (("normal", [*n, 0.5]), ("tangent", [*t, 0]), ("grating", [*x, 0]))
    }
    layers["position"] = np.column_stack([position, np.ones(2)])[None]
    light_direction = direction(25, 200)
    light = {
        "kind": "directional",
        "color": [2.0, 1.0, 1.0],
        "direction": light_direction.tolist(),
        "angularRadius": 0.01,
    }
    rendering = Rendering(
        scene={
            "surface": {"kind": "height-field", "field": "x", "ior": 1.5},
            "material": {"roughness": 0.02, "method": "line-sum", "illuminant": "A"},
        },
        view={"lights": [light]},
        radiance=np.zeros((1, 2, 3)),
        covered=np.full((1, 2), True),
        layers=layers,
        environment=None,
        backend="none",
    )
    frame = np.stack([x, np.cross(n, x), n])
    wi = np.tile(frame @ light_direction, (2, 1))
    wo = -position / np.linalg.norm(position, axis=1, keepdims=True) @ frame.T
    grating = Grating(period=2.5, height=0.15, energy="kirchhoff", metal=None, roughness=0.02)
    source = Light(illuminant="A", tint=(2.0, 1.0, 1.0), angular_radius=0.01)
    fresnel = HeightFieldOptics(ior=1.5).reflectance(wi, wo, np.full(2, 0.5))[:, None]
    expected = 0.5 * wi[:, 2:] * fresnel * grating_colour_brdf(grating, wi, wo, source)
    assert expected.min() > 0
    found = reference_xyz(rendering, tmp_path / "baked")
    assert found == pytest.approx(expected, rel=1e-4)
