"""Colours of orders 0 and of first orders, by their integrals."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import jv

from precompute.acquisition.lamp_colour import LampColour
from precompute.spectra import WAVELENGTHS

DEVIATION = 0.0144
MIDDLES = (0.60, 0.54, 0.45)


def sensor() -> np.ndarray:
    """Three bell-shaped channels, shape (401, 3)."""
    return np.exp(-((WAVELENGTHS[:, None] - np.array(MIDDLES)) ** 2) / (2 * 0.04**2))


def lamp(kind: str) -> np.ndarray:
    """Spectra of power, shape (401, 1)."""
    warm = 0.2 + (WAVELENGTHS - 0.38) / 0.4
    return {"even": np.ones_like(WAVELENGTHS), "warm": warm, "cold": warm[::-1]}[kind][:, None]


@pytest.mark.parametrize("kind", ["even", "warm", "cold"])
def test_orders_0_are_the_lamps(kind: str) -> None:
    weights = lamp(kind) * sensor()
    colours = LampColour.of(weights, DEVIATION)
    assert colours is not None
    for height in (0.0, 0.05, 0.11, 0.15):
        for smooth in (0.0, 0.1, 0.6):
            β = np.pi * 1.9 * height / WAVELENGTHS[:, None]
            shown = (weights * (smooth + (1 - smooth) * jv(0, β) ** 2)).sum(axis=0)
            assert colours.shows(7 * shown)


@pytest.mark.parametrize("kind", ["even", "warm", "cold"])
def test_first_orders_are_not(kind: str) -> None:
    """Of periods whose lobes are 14 to 36 nm wide."""
    weights = lamp(kind) * sensor()
    colours = LampColour.of(weights, DEVIATION)
    assert colours is not None
    for middle in np.arange(0.42, 0.66, 0.013):
        for period in (1.0, 1.5, 2.5):
            band = np.exp(-((WAVELENGTHS - middle) ** 2) / (2 * (DEVIATION * period) ** 2))
            assert not colours.shows(band @ weights)


def test_noise_below_black_is_no_colour() -> None:
    colours = LampColour.of(sensor(), DEVIATION)
    assert colours is not None
    red = sensor()[220]  # 600 nm
    assert not colours.shows(red - [0.0, 0.0, 0.1])


@pytest.mark.parametrize("fwhm", [0.001, 0.03])
def test_behind_a_line_filter_all_orders_are_alike(fwhm: float) -> None:
    line = np.exp(-4 * np.log(2) * ((WAVELENGTHS - 0.53) / fwhm) ** 2)
    assert LampColour.of(line[:, None] * sensor(), DEVIATION) is None


def test_a_grey_camera_sees_no_colour() -> None:
    assert LampColour.of(sensor().sum(axis=1, keepdims=True), DEVIATION) is None
