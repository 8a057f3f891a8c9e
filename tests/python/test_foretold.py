"""Photographs that do not go with the others, against noise and mistakes that were planted."""

import numpy as np
import pytest

from precompute.acquisition.foretold import FLOOR, misfits
from precompute.acquisition.polarization_fit import Harmonics, Pixels, fitted

ANGLES = np.radians([0, 25, 50, 80, 110, 145, 160])
NOISE = 0.01


def photographs(noise: float = NOISE) -> Pixels:
    """Of pixels of every orientation, each as bright as it likes."""
    rng = np.random.default_rng(1)
    η, brightness = rng.uniform(0, 2 * np.pi, (60, 80)), rng.uniform(0.5, 1.5, (60, 80))
    modulation = 1 + 0.2 * np.cos(2 * ANGLES[:, None, None] - η)
    return (brightness * modulation + noise * rng.standard_normal(modulation.shape)).astype("f4")


def told(light: Pixels, angles: np.ndarray = ANGLES) -> np.ndarray:
    harmonics = Harmonics.of(angles)
    return misfits(light, harmonics, fitted(light, harmonics))


def test_noise_fits_by_what_is_said_of_it() -> None:
    assert told(photographs()) == pytest.approx(1, abs=0.1)


@pytest.mark.parametrize("which", [0, 3, 6])
def test_one_whose_noise_is_known_is_off_by_as_much(which: int) -> None:
    light = photographs()
    rng = np.random.default_rng(2)
    light[which] += 5 * NOISE * rng.standard_normal(light[which].shape).astype("f4")
    off = told(light)
    # d² is its own variance and what the others' fit is uncertain by, h/(1 − h) of theirs.
    u, v = Harmonics.of(ANGLES).columns
    design = np.stack([np.ones_like(u), u, v], axis=1)
    h = (design @ np.linalg.inv(design.T @ design) @ design.T)[which, which]
    expected = np.sqrt((1 - h) * (26 + h / (1 - h)))
    assert off[which] == pytest.approx(expected, rel=0.05)
    assert off.argmax() == which


@pytest.mark.parametrize("degrees", [13, 45])
def test_an_angle_that_is_wrong(degrees: float) -> None:
    stated = ANGLES.copy()
    stated[4] += np.radians(degrees)
    off = told(photographs(), stated)
    assert off.argmax() == 4 and off[4] > 2


def test_what_is_unknown_is_left_out() -> None:
    light = photographs()
    light[2, 10:20] = np.nan
    light[2, 20:30, :3] = np.nan
    assert told(light) == pytest.approx(1, abs=0.1)


def test_four_cannot_tell() -> None:
    light = photographs()[:4]
    light[1] = light[1, ::-1]
    assert told(light, ANGLES[:4]).tolist() == [0, 0, 0, 0]


def test_resampling_alone_is_nobodys_mistake() -> None:
    light = photographs(0)
    rng = np.random.default_rng(3)
    light[5] += FLOOR / 2 * rng.standard_normal(light[5].shape).astype("f4")
    assert told(light)[5] < 1
