"""Cameras: where points of the sample are seen, and back, by hand."""

from __future__ import annotations

import numpy as np
import pytest

from precompute.acquisition.capture import Camera, Corners
from precompute.acquisition.rectification import NORMAL_LENS, Rectification, corners_mm
from precompute.acquisition.view import View

Lens = tuple[float, float, float, float, float]

SIZE_PX = (801, 601)
SIZE_MM = (160.0, 120.0)
LENS = (0.08, -0.05, 0.004, -0.006, 0.02)


def camera(**fields: object) -> Camera:
    return Camera.model_validate({"position_mm": (0, 0, 500), "focal_px": 2000, **fields})


def seen(of: Camera, *points: tuple[float, float, float]) -> np.ndarray:
    return View.of(of, SIZE_PX).pixels(np.array(points, dtype=np.float64))


def grid_mm(count: int = 7) -> np.ndarray:
    x = np.linspace(-0.5, 0.5, count)
    return np.stack(np.meshgrid(x * SIZE_MM[0], x * SIZE_MM[1]), axis=-1).reshape(-1, 2)


def flat(xy: np.ndarray) -> np.ndarray:
    return np.concatenate([xy, np.zeros((len(xy), 1))], axis=1)


# ---- Pinholes ------------------------------------------------------------------------------------


def test_a_camera_straight_above() -> None:
    """f X/Z right of the middle and f Y/Z above it; pixels count down."""
    pixels = seen(camera(), (0, 0, 0), (50, 0, 0), (0, 30, 0), (10, 20, 100))
    expected = [[400, 300], [400 + 200, 300], [400, 300 - 120], [400 + 50, 300 - 100]]
    assert pixels == pytest.approx(np.array(expected))


def test_the_principal_point() -> None:
    assert seen(camera(principal_point_px=(390, 310)), (0, 0, 0))[0] == pytest.approx([390, 310])


def test_a_camera_off_the_middle_looks_at_the_middle() -> None:
    """By the distances along and across its axis; the sample's y stays up."""
    eye = np.array([300.0, 0.0, 400.0])
    pixels = seen(camera(position_mm=tuple(eye)), (0, 0, 0), (10, 0, 0), (0, 10, 0))
    assert pixels[0] == pytest.approx([400, 300])
    # The point at x = 10 is 8 to the right and 6 nearer; right is (4/5, 0, −3/5).
    assert pixels[1] == pytest.approx([400 + 2000 * 8 / (500 - 6), 300])
    assert pixels[2] == pytest.approx([400, 300 - 2000 * 10 / 500])


@pytest.mark.parametrize(
    ("rotation", "direction"),
    [
        # Turned counter-clockwise about the axis of its own that points …
        ((10, 0, 0), (0, 1)),  # … right, it looks up: the sample moves down, y grows.
        ((0, 10, 0), (1, 0)),  # … up, it looks left: the sample moves right.
    ],
)
def test_a_turn_about_x_or_y_moves_the_middle(
    rotation: tuple[float, ...], direction: tuple[float, float]
) -> None:
    middle = seen(camera(rotation_deg=rotation), (0, 0, 0))[0]
    shift = 2000 * np.tan(np.radians(10))
    assert middle == pytest.approx(np.array([400, 300]) + shift * np.array(direction))


def test_a_turn_about_z_turns_the_picture_the_other_way() -> None:
    """The camera counter-clockwise as it sees it, the sample clockwise: x goes down."""
    right = seen(camera(rotation_deg=(0, 0, 10)), (50, 0, 0))[0] - [400, 300]
    turn = np.radians(10)
    assert right == pytest.approx([200 * np.cos(turn), 200 * np.sin(turn)])


def test_turns_are_about_its_own_axes_one_after_the_other() -> None:
    """x by 90°, then its own y, which points to the sample's +z then, by φ, then its own z.

    After the first turn the camera at (0, −500, 0) looks along +y, its own y along z. Then it turns
    left, to −x. Its own z, backwards, points to −y before and to (sin φ, −cos φ, 0) after that.
    """
    φ, ψ = np.radians([20, 30])
    turned = Camera(position_mm=(0, -500, 1), rotation_deg=(90, 20, 30), focal_px=2000)
    view = View.of(turned, SIZE_PX)
    backwards = np.array([np.sin(φ), -np.cos(φ), 0])
    right, up = np.array([np.cos(φ), np.sin(φ), 0]), np.array([0, 0, 1])
    expected = [np.cos(ψ) * right + np.sin(ψ) * up, np.sin(ψ) * right - np.cos(ψ) * up, -backwards]
    assert view.rotation == pytest.approx(np.array(expected))


# ---- Lenses --------------------------------------------------------------------------------------


def distorted(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """OpenCV's documentation: radial k1, k2, k3, tangential p1, p2."""
    k1, k2, p1, p2, k3 = LENS
    r2 = x**2 + y**2
    radial = 1 + k1 * r2 + k2 * r2**2 + k3 * r2**3
    return np.stack(
        [
            x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x**2),
            y * radial + p1 * (r2 + 2 * y**2) + 2 * p2 * x * y,
        ],
        axis=1,
    )


def test_distortion_is_opencvs() -> None:
    xy = grid_mm()
    near = camera(position_mm=(0, 0, 200), distortion=LENS)  # rays up to 27° off the axis
    expected = 2000 * distorted(xy[:, 0] / 200, -xy[:, 1] / 200) + [400, 300]
    assert View.of(near, SIZE_PX).pixels(flat(xy)) == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("distortion", [(0, 0, 0, 0, 0), LENS])
def test_pixels_lead_back_to_the_sample(
    distortion: Lens,
) -> None:
    of = camera(position_mm=(60, -40, 450), rotation_deg=(5, 8, -12), distortion=distortion)
    view, xy = View.of(of, SIZE_PX), grid_mm()
    assert view.on_sample(view.pixels(flat(xy))) == pytest.approx(xy, abs=1e-5)


def test_rays_that_miss_the_sample() -> None:
    level = camera(position_mm=(0, 0, 100), rotation_deg=(90, 0, 0))  # looks along +y
    below, above = View.of(level, SIZE_PX).on_sample(np.array([[400.0, 500.0], [400.0, 100.0]]))
    assert below == pytest.approx([0, 100 * 2000 / 200])
    assert np.isnan(above).all()


# ---- Rectification -------------------------------------------------------------------------------


def from_corners(of: Camera, told: Camera, focal_px: float | None = None) -> Rectification:
    corners = View.of(of, SIZE_PX).pixels(flat(corners_mm(SIZE_MM)))
    marked: Corners = tuple((float(x), float(y)) for x, y in corners)  # pyright: ignore
    return Rectification.of(told, focal_px, SIZE_PX, SIZE_MM, marked)


TILTED = {"position_mm": (120, -150, 450), "rotation_deg": (20, 14, -9)}


@pytest.mark.parametrize("distortion", [(0, 0, 0, 0, 0), LENS])
def test_corners_alone_place_all_of_the_sample(
    distortion: Lens,
) -> None:
    of = camera(**TILTED, distortion=distortion)
    found = from_corners(of, Camera(distortion=distortion), 2000)
    xy = grid_mm()
    pixels = View.of(of, SIZE_PX).pixels(flat(xy))
    assert found.pixels(xy) == pytest.approx(pixels, abs=0.01)
    assert found.on_sample(pixels) == pytest.approx(xy, abs=0.01)
    whole = Rectification.of_view(View.of(of, SIZE_PX))
    assert whole.pixels(xy) == pytest.approx(pixels, abs=1e-4)
    assert whole.on_sample(pixels) == pytest.approx(xy, abs=1e-3)


@pytest.mark.parametrize("distortion", [(0, 0, 0, 0, 0), LENS])
def test_the_eye_from_corners_and_the_focal_length(
    distortion: Lens,
) -> None:
    of = camera(**TILTED, distortion=distortion)
    found = from_corners(of, Camera(distortion=distortion), 2000)
    assert found.eye == pytest.approx(TILTED["position_mm"], abs=0.05)
    assert found.is_scaled


def test_the_eye_that_the_capture_states_is_taken() -> None:
    found = from_corners(camera(**TILTED), Camera(position_mm=(1, 2, 300)))
    assert found.eye.tolist() == [1, 2, 300] and found.is_scaled


def test_without_focal_length_a_normal_lens_stands_for_it() -> None:
    """Straight above, the eye is as far as the assumed focal length says; not to be relied on."""
    found = from_corners(camera(), Camera())
    assumed = NORMAL_LENS * SIZE_PX[0]
    assert found.eye == pytest.approx([0, 0, 500 * assumed / 2000], abs=1e-3)
    assert not found.is_scaled


def test_resolution_at_the_middle() -> None:
    whole = Rectification.of_view(View.of(camera(), SIZE_PX))
    assert whole.pixels_per_mm() == pytest.approx(2000 / 500, rel=1e-4)
