"""Pictures of what errors saw: where marks are in them, and what they are called."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from precompute.acquisition.evidence import Evidence, Mark, PhotographError
from precompute.acquisition.refusal_pictures import drawn
from precompute.errors import InputError

CYAN, ORANGE, GREEN = (0, 255, 255), (255, 69, 0), (0, 255, 0)


def error(*marks: Mark, size: tuple[int, int] = (300, 200), name: str = "a.tif") -> InputError:
    """Of a photograph that is green all over."""
    green = np.zeros((size[1], size[0], 3), np.float32)
    green[..., 1] = 0.25
    plain = InputError("a.tif", "highlight", "none", "one")
    return PhotographError(plain, Evidence.of(name, green, *marks))


def picture(message: InputError) -> np.ndarray:
    assert isinstance(message.expected, str)
    file = Path(str(message).rsplit("; see ", 1)[1])
    with Image.open(file) as image:
        return np.asarray(image.convert("RGB")).astype(int)


def extent(image: np.ndarray, colour: tuple[int, int, int]) -> np.ndarray:
    """Least and largest column and row in which a colour is, shape (2, 2)."""
    row, column = np.nonzero(np.abs(image - colour).max(axis=2) < 3)
    return np.array([[column.min(), row.min()], [column.max(), row.max()]])


def test_points_are_where_they_are_in_the_photograph(tmp_path: Path) -> None:
    looked_for = Mark("the image", np.array([[220.0, 50.0]]), False)
    found = Mark(
        "a spot", np.array([(60.0, 120.0), (100.0, 120.0), (100.0, 160.0), (60, 160)]), True
    )
    image = picture(drawn(error(looked_for, found), tmp_path, "foil."))
    top_left, bottom_right = extent(image, GREEN)
    pixel = (bottom_right - top_left + 1) / [300, 200]
    legend = image[: bottom_right[1]]  # without what is below the photograph
    cross, square = extent(legend, CYAN), extent(legend, ORANGE)
    assert (cross.mean(axis=0) - top_left) / pixel == pytest.approx([220.5, 50.5], abs=1)
    assert (square - top_left) / pixel == pytest.approx(
        np.array([(60.5, 120.5), (100.5, 160.5)]), abs=1
    )


def test_a_point_off_the_photograph_is_in_the_picture(tmp_path: Path) -> None:
    off = Mark("the image", np.array([[-150.0, 100.0]]), False)
    image = picture(drawn(error(off), tmp_path, ""))
    top_left, bottom_right = extent(image, GREEN)
    cross = extent(image[: bottom_right[1]], CYAN).mean(axis=0)
    pixel = (bottom_right - top_left + 1) / [300, 200]
    assert (cross - top_left) / pixel == pytest.approx([-149.5, 100.5], abs=1)


@pytest.mark.parametrize("size", [(3000, 2000), (900, 2400), (90, 20)])
def test_pictures_are_small_whatever_the_photograph(tmp_path: Path, size: tuple[int, int]) -> None:
    image = picture(drawn(error(size=size), tmp_path, ""))
    assert 300 < max(image.shape) <= 1200


def test_names(tmp_path: Path) -> None:
    seen = error(name="night/a.tif")
    message = drawn(seen, tmp_path / "deep", "foil.")
    assert [file.name for file in (tmp_path / "deep").iterdir()] == ["foil.night-a.tif.refused.png"]
    assert str(message) == f"{seen}; see {tmp_path / 'deep' / 'foil.night-a.tif.refused.png'}"


def test_an_error_without_a_photograph_stays_as_it_is(tmp_path: Path) -> None:
    plain = InputError("a.json", "version", 2, "1")
    assert drawn(plain, tmp_path / "none", "foil.") is plain
    assert not (tmp_path / "none").exists()


def test_a_grey_photograph_keeps_its_shades() -> None:
    """As a display shows them: by a power of 1/2.2 of what all but the brightest hundredth is."""
    values = np.full((100, 100, 1), 0.5, np.float32)
    values[:, :50] = 0.1
    shown = Evidence.of("a.tif", values).shown
    assert shown.shape == (100, 100, 3)
    assert shown[:, 50:] == pytest.approx(1)
    assert shown[:, :50] == pytest.approx(0.2 ** (1 / 2.2))
