"""Cells of a spectrum, and the reference under an environment."""

import numpy as np
from scipy.special import jv

from precompute.gratings import Grating, Light
from precompute.height_fields.cells import line_powers, spectrum_cells
from precompute.height_fields.environment import environment_radiance
from precompute.height_fields.field import HeightField
from precompute.height_fields.optics import HeightFieldOptics
from precompute.reference import environment_radiance as grating_radiance
from precompute.spectra import WAVELENGTHS, colour_weights, tint_basis

PERIOD, HEIGHT = 1.66, 0.15


def cosine() -> HeightField:
    x = np.arange(64) / 64
    heights = np.repeat(HEIGHT * (1 + np.cos(2 * np.pi * x))[None] / 2, 8, axis=0)
    return HeightField(heights, (PERIOD / 64, PERIOD / 64))


def random_field(seed: int) -> HeightField:
    """Smooth noise on a patch of 8 µm, 0.2 µm high."""
    f = np.fft.fftfreq(128, 8 / 128)
    ring = np.exp(-(((np.hypot(*np.meshgrid(f, f)) - 1.2) / 0.4) ** 2))
    noise = np.random.default_rng(seed).normal(size=(128, 128))
    heights = np.fft.ifft2(np.fft.fft2(noise) * ring).real
    return HeightField(0.2 * heights / np.ptp(heights), (8 / 128, 8 / 128))


def test_cells_share_out_the_power() -> None:
    """Parseval: all lines together have the power 1 at every w/λ, and no cell loses any."""
    cells = spectrum_cells(random_field(1))
    assert cells.powers.shape == (512, 64)
    np.testing.assert_allclose(cells.powers.sum(axis=0), 1, atol=1e-4)
    assert cells.powers[0, 0] == 1  # at w = 0 the relief is a mirror
    assert cells.spreads[0] == 0
    assert np.all(cells.spreads[1:] >= 0)


def test_cells_keep_the_spectrums_middle_and_spread() -> None:
    field = random_field(2)
    frequencies, powers = line_powers(field)
    weights = powers.mean(axis=0) * np.any(frequencies != 0, axis=1)
    cells = spectrum_cells(field)
    shares = cells.powers[1:].mean(axis=1)
    middle = weights @ frequencies / weights.sum()
    np.testing.assert_allclose(
        shares @ cells.frequencies[1:] / shares.sum(), middle, atol=1e-7
    )  # faint lines are left out
    second = weights @ np.sum(frequencies**2, axis=1)
    found = shares @ (np.sum(cells.frequencies[1:] ** 2, axis=1) + 2 * cells.spreads[1:] ** 2)
    np.testing.assert_allclose(found, second, rtol=1e-6)


def test_a_cosines_cells_are_its_orders() -> None:
    cells = spectrum_cells(cosine())
    order = cells.frequencies * PERIOD
    np.testing.assert_allclose(order, np.rint(order), atol=1e-9)
    assert np.all(cells.spreads == 0)


def test_the_same_cells_on_every_run() -> None:
    first, second = (spectrum_cells(random_field(3)) for _ in range(2))
    np.testing.assert_array_equal(first.frequencies, second.frequencies)
    np.testing.assert_array_equal(first.powers, second.powers)


def views(count: int, seed: int) -> np.ndarray:
    """Directions at most 60° or so from the normal."""
    wo = np.random.default_rng(seed).normal(size=(count, 3))
    wo[:, 2] = np.abs(wo[:, 2]) + 0.5
    return wo / np.linalg.norm(wo, axis=1, keepdims=True)


def striped_sky(direction: np.ndarray) -> np.ndarray:
    """Dark at the horizon, where bands of wavelengths and single ones would differ."""
    return (1 + 0.5 * np.sin(40 * direction)) * np.minimum(2 * direction[:, 2:], 1) ** 6


def mirror() -> HeightField:
    return HeightField(np.zeros((8, 8)), (0.25, 0.25))


def test_a_cosine_under_an_environment_is_a_grating() -> None:
    wo = views(12, 4)
    found = environment_radiance(cosine(), HeightFieldOptics(), wo, striped_sky, Light())
    grating = Grating(period=PERIOD, height=HEIGHT, energy="kirchhoff")
    expected = grating_radiance(grating, wo, striped_sky, Light())
    # Faint orders skip wavelengths.
    np.testing.assert_allclose(found, expected, rtol=2e-4)


def test_a_rough_cosine_under_an_environment_is_a_rough_grating() -> None:
    """Under stripes that the roughness takes a quarter of the contrast from."""
    wo, wavelengths = views(6, 5), WAVELENGTHS[2::4]
    optics = HeightFieldOptics(roughness=0.01)
    found = environment_radiance(cosine(), optics, wo, striped_sky, Light(), wavelengths)
    grating = Grating(period=PERIOD, height=HEIGHT, energy="kirchhoff", roughness=0.01)
    expected = grating_radiance(grating, wo, striped_sky, Light(), wavelengths, tilts=9)
    np.testing.assert_allclose(found, expected, rtol=1e-2)


def test_light_from_all_sides_shows_no_roughness() -> None:
    wo = views(2, 6)
    smooth, rough = (
        environment_radiance(
            cosine(),
            HeightFieldOptics(roughness=roughness),
            wo,
            np.ones_like,
            Light(),
            WAVELENGTHS[10::40],
        )
        for roughness in (0, 0.1)
    )
    np.testing.assert_allclose(rough, smooth, rtol=1e-9)


def test_a_rough_mirrors_image_of_one_source() -> None:
    """A Gaussian source of deviation τ about c is seen as one of deviation √(τ² + (wδ)²)."""
    δ, τ, c = 0.03, 0.04, np.array([-0.3, 0.1])
    wo = np.array([[0.3, -0.1, 0], [0.35, -0.12, 0], [0.25, 0, 0]])
    wo[:, 2] = np.sqrt(1 - np.sum(wo**2, axis=1))

    def source(direction: np.ndarray) -> np.ndarray:
        off = np.sum((direction[:, :2] - c) ** 2, axis=1, keepdims=True)
        return np.exp(-off / (2 * τ**2)) * np.ones(3)

    found = environment_radiance(
        mirror(), HeightFieldOptics(metal=None, roughness=δ), wo, source, Light()
    )
    blurred = τ**2 + (2 * wo[:, 2] * δ) ** 2
    off = np.sum((-wo[:, :2] - c) ** 2, axis=1)
    expected = τ**2 / blurred * np.exp(-off / (2 * blurred))
    np.testing.assert_allclose(found[:, 1], expected, rtol=2e-3)  # a white mirror has Y = 1


def test_lines_at_the_horizon_under_light_from_all_sides() -> None:
    """Against a sum over 1/400 nm, in which 1/cosθ_i of no single step counts for much."""
    wo = np.array([[0.35, 0.2, 0], [0.6, 0.1, 0], [0.1, 0.75, 0]])
    wo[:, 2] = np.sqrt(1 - np.sum(wo**2, axis=1))
    optics = HeightFieldOptics(metal=None)
    found = environment_radiance(cosine(), optics, wo, np.ones_like, Light())
    fine = 400
    λ = (WAVELENGTHS[:, None] + 0.001 * ((np.arange(fine) + 0.5) / fine - 0.5)).ravel()
    weights = 0.001 * tint_basis().sum(axis=1)[:, None] * colour_weights("1931-2", "D65")
    for o, xyz in zip(wo, found, strict=True):
        total = np.zeros(len(λ))
        for m in range(-8, 9):
            x = m * λ / PERIOD - o[0]
            z2 = 1 - x**2 - o[1] ** 2
            z = np.sqrt(np.where(z2 > 0, z2, 1))
            w = z + o[2]
            obliquity = (1 + x * o[0] - o[1] ** 2 + z * o[2]) ** 2 / (z * o[2] * w**2)
            total += (z2 > 0) * obliquity * jv(m, np.pi * w * HEIGHT / λ) ** 2
        np.testing.assert_allclose(xyz, total.reshape(-1, fine).mean(axis=1) @ weights, rtol=1e-3)
