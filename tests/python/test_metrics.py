"""The metrics catch planted differences and know published ones."""

import colour
import numpy as np
import pytest

from precompute.metrics import delta_e2000, exposure, flip_mean, relative_rmse

PICTURE = np.random.default_rng(5).uniform(0.05, 0.9, (48, 48, 3))

# Pairs of CIELAB colours and their ΔE2000: Sharma, Wu and Dalal (2005), table 1, those within sRGB.
SHARMA = [
    ((63.0109, -31.0961, -5.8663), (62.8187, -29.7946, -4.0864), 1.2630),
    ((61.2901, 3.7196, -5.3901), (61.4292, 2.2480, -4.9620), 1.8731),
    ((36.4612, 47.8580, 18.3852), (36.2715, 50.5065, 21.2231), 1.4146),
    ((90.8027, -2.0831, 1.4410), (91.1528, -1.6435, 0.0447), 1.4441),
    ((90.9257, -0.5406, -0.9208), (88.6381, -0.8985, -0.7239), 1.5381),
    ((50.0000, 2.5000, 0.0000), (50.0000, 3.1736, 0.5854), 1.0000),
]


def rgb_of(lab: tuple[float, float, float]) -> np.ndarray:
    white = colour.CCS_ILLUMINANTS["CIE 1931 2 Degree Standard Observer"]["D65"]
    return np.asarray(colour.XYZ_to_RGB(colour.Lab_to_XYZ(lab, white), "sRGB"))


@pytest.mark.parametrize("scale", [1.01, 0.9])
def test_a_scaled_copy_is_off_by_its_scale(scale: float) -> None:
    assert relative_rmse(scale * PICTURE, PICTURE) == pytest.approx(abs(scale - 1))


def test_relative_rmse_weighs_pixels_by_their_energy() -> None:
    """A mean of relative errors per pixel would let one dark pixel rule."""
    reference = np.array([10.0, 0.001])
    assert relative_rmse(np.array([10.0, 0.002]), reference) == pytest.approx(1e-4, rel=1e-3)


def test_an_all_dark_reference_is_refused() -> None:
    with pytest.raises(ValueError, match="zero everywhere"):
        relative_rmse(PICTURE, np.zeros_like(PICTURE))


@pytest.mark.parametrize(("first", "second", "expected"), SHARMA)
def test_delta_e2000_of_published_pairs(
    first: tuple[float, float, float], second: tuple[float, float, float], expected: float
) -> None:
    pair = np.stack([rgb_of(first), rgb_of(second)])
    assert pair.min() > 0 and pair.max() < 1  # else clipped, and no test at all
    # 4e-3: sRGB's rounded matrix and the white's rounded chromaticity.
    assert delta_e2000(pair[:1], pair[1:]) == pytest.approx([expected], abs=4e-3)


def test_delta_e2000_leaves_out_pixels_whose_reference_is_dark() -> None:
    reference = np.array([[0.5, 0.5, 0.5], [1e-4, 1e-4, 1e-4]])
    found = np.array([[0.5, 0.5, 0.5], [0.5, 0.0, 0.0]])
    assert delta_e2000(found, reference).tolist() == [0]


def test_flip_sees_a_shift_and_nothing_in_equal_pictures() -> None:
    assert flip_mean(PICTURE, PICTURE) == 0
    assert flip_mean(np.roll(PICTURE, 1, axis=1), PICTURE) > 0.05


def test_exposure_takes_the_brightest_hundredth_of_lit_pixels_to_white() -> None:
    xyz = np.zeros((400, 3))
    xyz[:101, 1] = np.linspace(0.1, 20.1, 101)  # three quarters are dark and do not count
    assert exposure(xyz) == pytest.approx(1 / 19.9)
