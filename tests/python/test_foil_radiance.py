"""What a foil sends to a camera: its texels, its channels, and the laws of reflection."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from precompute.acquisition.capture import Camera, Filter, FlashLight
from precompute.acquisition.pattern import Gratings, gratings_of, texel_indices
from precompute.acquisition.radiance import Lamp, Relief, foil_radiance
from precompute.acquisition.sensor import channel_weights, sensitivity, transmittance
from precompute.errors import InputError
from precompute.foils.foil_map import foil_map
from precompute.gratings import Grating
from precompute.profiles import Blazed, Sinusoidal
from precompute.reference import weighted_brdf
from precompute.spectra import WAVELENGTHS, illuminant

EYE = np.array([30.0, -20.0, 400.0])
RADIUS = np.radians(0.7)
STEP = 20
FLAT = np.zeros((1, 2))


def only(*wavelengths: float) -> np.ndarray:
    """A channel for each wavelength, µm, which sees it alone."""
    weights = np.zeros((len(WAVELENGTHS), len(wavelengths)))
    for channel, λ in enumerate(wavelengths):
        weights[round((λ - 0.38) * 1000), channel] = 1
    return weights


def lamp(position: np.ndarray, weights: np.ndarray | None = None) -> Lamp:
    return Lamp(position, RADIUS, only(0.5, 0.6) if weights is None else weights)


def gratings(θ: float, frequency: float = 1 / 1.66, strength: float = 1.0, n: int = 1) -> Gratings:
    return Gratings(np.full(n, θ), np.full(n, frequency), np.full(n, strength))


def radiance(
    point: tuple[float, float],
    of: Gratings,
    light: Lamp,
    relief: Relief | None = None,
    eye: np.ndarray = EYE,
    tilt: np.ndarray = FLAT,
) -> np.ndarray:
    relief = relief or Relief(0.15, Sinusoidal(), 16.25, np.radians(0.2))
    return foil_radiance(np.array([point], float), tilt, of, relief, eye, light, STEP)[0]


def turned(vector: np.ndarray, angle: float) -> np.ndarray:
    x, y, *z = vector
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * x - s * y, s * x + c * y, *z])


# ---- Texels --------------------------------------------------------------------------------------


def test_the_first_row_is_on_top_and_tiles_repeat() -> None:
    places = np.array([[0.1, 0.9], [0.9, 0.9], [0.1, 0.1], [0.5, 0.4]])
    # Two rows of three: 0 1 2 above 3 4 5.
    assert texel_indices((2, 3), places).tolist() == [0, 2, 3, 4]
    for shift in ([1, 0], [0, 1], [-3, 2], [5, -7]):
        assert texel_indices((2, 3), places + shift).tolist() == [0, 2, 3, 4]


def test_the_gratings_of_a_map_are_those_it_was_made_from() -> None:
    θ = np.radians([[0.0, 30.0, 89.0], [91.0, 150.0, 179.0]])
    frequency = np.array([[0.5, 0.6, 0.7], [0.8, 0.9, 1.0]])
    strength = np.array([[1.0, 0.5, 0.0], [1.0, 0.2, 1.0]])
    foil = foil_map(θ, frequency, strength, height=0.15, tile_mm=10, recipe={})
    found = gratings_of(foil)
    assert found.orientation == pytest.approx(θ)
    assert found.frequency.tolist() == frequency.tolist()
    assert found.strength.tolist() == strength.tolist()


# ---- Channels ------------------------------------------------------------------------------------


def test_a_filter_lets_through_half_at_half_its_width() -> None:
    green = transmittance(Filter(peak_um=0.53, fwhm_um=0.04))
    at = {round(λ * 1000): t for λ, t in zip(WAVELENGTHS, green, strict=True)}
    assert [at[510], at[530], at[550]] == pytest.approx([0.5, 1, 0.5])
    assert transmittance(None).tolist() == [1] * len(WAVELENGTHS)


def test_weights_are_light_times_filter_times_sensitivity(tmp_path: Path) -> None:
    rows = [f"{λ:.3f},{λ:.3f},1,{0.5 * (λ > 0.55)}" for λ in WAVELENGTHS]
    (tmp_path / "camera.csv").write_text("\n".join(["wavelength_um,r,g,b", *rows]) + "\n")
    seen = sensitivity(Camera(spectral_response_csv="camera.csv"), tmp_path)
    assert seen[:, 1] == pytest.approx(1)  # the largest number is 1 already
    assert seen[:, 0] == pytest.approx(WAVELENGTHS)
    light = FlashLight(position_mm=(0, 0, 100), spectrum="A")
    filter_ = Filter(peak_um=0.53, fwhm_um=0.03)
    weights = channel_weights(light, filter_, seen, tmp_path)
    by_hand = illuminant("A") * np.exp(-np.log(2) * ((WAVELENGTHS - 0.53) / 0.015) ** 2)
    assert weights == pytest.approx(by_hand[:, None] * seen)


def test_a_camera_that_says_nothing_is_a_typical_one(tmp_path: Path) -> None:
    rgb = sensitivity(Camera(), tmp_path)
    assert rgb.max() == 1 and rgb.min() >= 0
    red, green, blue = WAVELENGTHS[np.argmax(rgb, axis=0)]
    assert blue < 0.5 < green < 0.57 < red < 0.65
    grey = sensitivity(Camera(channels="grey"), tmp_path)
    mean = rgb.mean(axis=1, keepdims=True)
    assert grey == pytest.approx(mean / mean.max())


def test_a_response_without_its_columns_is_refused(tmp_path: Path) -> None:
    (tmp_path / "camera.csv").write_text("wavelength_um,r,g\n0.4,1,1\n0.7,1,1\n")
    with pytest.raises(InputError, match=r"camera\.csv"):
        sensitivity(Camera(spectral_response_csv="camera.csv"), tmp_path)


# ---- Radiance ------------------------------------------------------------------------------------


def test_one_point_is_the_references_brdf_times_irradiance() -> None:
    """At the origin directions are those of lamp and eye, turned into the grating's frame."""
    light, θ = np.array([90.0, 30.0, 200.0]), np.radians(10)
    relief = Relief(0.12, Blazed(), 12.0, np.radians(0.5))
    weights = only(0.40, 0.5, 0.56, 0.78)
    shown = radiance((0, 0), gratings(θ), lamp(light, weights), relief)
    wi, wo = light / np.linalg.norm(light), EYE / np.linalg.norm(EYE)
    grating = Grating(
        period=1.66, height=0.12, profile=Blazed(), coherence=12.0, roughness=np.radians(0.5)
    )
    wi, wo = turned(wi, -θ)[None], turned(wo, -θ)[None]
    brdf = weighted_brdf(grating, wi, wo, weights, RADIUS, STEP)[0]
    assert shown == pytest.approx(wi[0, 2] * brdf, rel=1e-9)
    assert shown.max() > 0.1


def test_irradiance_falls_with_the_distance_squared_and_the_cosine() -> None:
    """The same directions from everywhere: a lamp and an eye moved along with the point."""
    light, shift = np.array([60.0, 0.0, 180.0]), np.array([25.0, -15.0, 0.0])
    here = radiance((0, 0), gratings(0.1), lamp(light))
    there = radiance((25, -15), gratings(0.1), lamp(light + shift), eye=EYE + shift)
    # Irradiance is 1 facing the lamp at its distance from the origin, which is farther there.
    farther = np.sum((light + shift) ** 2) / np.sum(light**2)
    assert there == pytest.approx(here * farther, rel=1e-9)


def test_a_sheet_that_is_turned_with_lamp_and_eye_looks_the_same() -> None:
    light, point, tilt = np.array([80.0, 10.0, 200.0]), np.array([12.0, 7.0]), [0.01, -0.02]
    rough = Relief(0.15, Sinusoidal(), 16.25, np.radians(3))
    before = radiance((12, 7), gratings(0.1), lamp(light), rough, tilt=np.array([tilt]))
    for angle in (0.4, 1.9, -2.5):
        x, y = turned(point, angle)
        after = foil_radiance(
            np.array([[x, y]]),
            turned(np.array(tilt), angle)[None],
            gratings(0.1 + angle),
            rough,
            turned(EYE, angle),
            lamp(turned(light, angle)),
            STEP,
        )[0]
        assert after == pytest.approx(before, rel=1e-6)
    assert before.min() > 0.03


@pytest.mark.parametrize("tilt", [(0.0, 0.0), (0.03, 0.0), (-0.02, 0.05)])
def test_a_mirror_shows_the_lamp_by_the_law_of_reflection(tilt: tuple[float, float]) -> None:
    """Where the bisector of lamp and eye is the surface's normal, (−∂z/∂x, −∂z/∂y, 1)."""
    light = np.array([40.0, 25.0, 250.0])
    x, y = np.meshgrid(np.linspace(-40, 60, 201), np.linspace(-50, 50, 201))
    points = np.stack([x.ravel(), y.ravel()], axis=1)
    tilts = np.broadcast_to(tilt, points.shape)
    shown = foil_radiance(
        points,
        np.array(tilts),
        gratings(0, strength=0.0, n=len(points)),
        Relief(0.15, Sinusoidal(), 16.25, 0.0),
        EYE,
        lamp(light, only(0.5)),
        STEP,
    )[:, 0]
    middle = shown @ points / shown.sum()
    to_lamp, to_eye = ((w - [*middle, 0]) / np.linalg.norm(w - [*middle, 0]) for w in (light, EYE))
    bisector = to_lamp + to_eye
    # The lamp's σ of 0.7° spans some 2 mm here; its middle is known to a twentieth of that.
    assert bisector[:2] / bisector[2] == pytest.approx(-np.array(tilt), abs=1e-3)


def test_orders_are_where_the_grating_equation_puts_them() -> None:
    """Seen from above, lit at sinθ = mλ/a: the brightest of many angles of the lamp, each order."""
    θ, λ, a = np.radians(35), 0.5, 1.66
    sines = np.linspace(0.2, 0.75, 441)
    shown = []
    for sine in sines:
        direction = turned(np.array([sine, 0.0, np.sqrt(1 - sine**2)]), θ)
        eye = np.array([0.0, 0.0, 400.0])
        shown.append(radiance((0, 0), gratings(θ), lamp(200 * direction, only(λ)), eye=eye)[0])
    orders = np.array(shown)
    first, second = sines < 0.45, sines > 0.45
    # cosθ_i and the efficiency change over the lobe: by less than a tenth of its width, 0.013.
    assert sines[first][np.argmax(orders[first])] == pytest.approx(λ / a, abs=2e-3)
    assert sines[second][np.argmax(orders[second])] == pytest.approx(2 * λ / a, abs=2e-3)


def test_what_does_not_diffract_is_a_mirror() -> None:
    """Strength is the share of a point that is a grating, the rest is flat."""
    light = np.array([*(-EYE[:2]), EYE[2]])  # mirrored at the origin
    whole, none, part = (
        radiance((0, 0), gratings(0.2, strength=s), lamp(light)) for s in (1.0, 0.0, 0.3)
    )
    assert none.min() > 2 * whole.max()  # a grating keeps but a part in order 0
    assert part == pytest.approx(0.3 * whole + 0.7 * none, rel=1e-9)


def test_gratings_of_different_periods_keep_their_places() -> None:
    light, n = np.array([60.0, 0.0, 150.0]), 40
    rng = np.random.default_rng(1)
    points = rng.uniform(-20, 20, (n, 2))
    mixed = Gratings(
        rng.uniform(-0.2, 0.2, n), rng.choice([0.5, 0.6, 0.8], n), rng.choice([0.0, 0.5, 1.0], n)
    )
    relief = Relief(0.15, Sinusoidal(), 16.25, np.radians(1.5))
    above = lamp(light, only(0.44, 0.56, 0.72))
    together = foil_radiance(points, np.zeros((n, 2)), mixed, relief, EYE, above, STEP)
    apart = [
        radiance((x, y), mixed[np.array([i])], above, relief) for i, (x, y) in enumerate(points)
    ]
    assert together == pytest.approx(np.array(apart), rel=1e-9)
    assert np.mean(together.max(axis=1) > 0.01) > 0.3
