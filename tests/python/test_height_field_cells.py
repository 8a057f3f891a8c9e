"""Cells of a spectrum, and the reference under an environment."""

import numpy as np

from precompute.gratings import Grating, Light
from precompute.height_fields.cells import line_powers, spectrum_cells
from precompute.height_fields.environment import environment_radiance
from precompute.height_fields.field import HeightField
from precompute.height_fields.optics import HeightFieldOptics
from precompute.reference import environment_radiance as grating_radiance
from precompute.spectra import WAVELENGTHS

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
    assert cells.powers.shape == (33, 64)
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


def test_a_cosine_under_an_environment_is_a_grating() -> None:
    rng = np.random.default_rng(4)
    wo = rng.normal(size=(12, 3))
    wo[:, 2] = np.abs(wo[:, 2]) + 0.5
    wo /= np.linalg.norm(wo, axis=1, keepdims=True)
    wavelengths = WAVELENGTHS[5::20]

    def environment(direction: np.ndarray) -> np.ndarray:
        return 1 + 0.5 * np.sin(3 * direction)

    found = environment_radiance(
        cosine(), HeightFieldOptics(), wo, environment, Light(), wavelengths
    )
    grating = Grating(period=PERIOD, height=HEIGHT, energy="kirchhoff")
    expected = grating_radiance(grating, wo, environment, Light(), wavelengths)
    np.testing.assert_allclose(found, expected, rtol=1e-8)
