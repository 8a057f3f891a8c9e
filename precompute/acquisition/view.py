"""From the sample's plane to pixels and back, through a pinhole camera with a distorting lens."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from precompute.acquisition.capture import Camera, Point

Array = NDArray[np.float64]

TO_OPENCV = np.diag([1.0, -1.0, -1.0])
"""From axes right, up, backwards, as the capture file turns cameras, to right, down, forwards."""


@dataclass(frozen=True)
class View:
    """A camera whose pose and lens are known.

    Attributes:
        position: Centre of projection in the sample's frame, mm, shape (3,).
        rotation: From the sample's axes to right, down, forwards, shape (3, 3).
        matrix: Of the pinhole: focal length and principal point, px, shape (3, 3).
        distortion: k1, k2, p1, p2, k3.
    """

    position: Array
    rotation: Array
    matrix: Array
    distortion: Array

    @staticmethod
    def of(camera: Camera, size_px: tuple[int, int]) -> View:
        """The view of a camera that states its position and focal length.

        Args:
            camera: The camera.
            size_px: Width and height of its pictures.
        """
        assert camera.position_mm is not None and camera.focal_px is not None
        position = np.array(camera.position_mm)
        if camera.rotation_deg is None:
            axes = _looking_at_centre(position)
        else:
            axes = Rotation.from_euler("XYZ", camera.rotation_deg, degrees=True).as_matrix()
        return View(
            position,
            TO_OPENCV @ axes.T,
            pinhole(camera, camera.focal_px, size_px),
            np.array(camera.distortion),
        )

    def pixels(self, points: Array) -> Array:
        """Where points are seen.

        Args:
            points: In the sample's frame, mm, shape (n, 3).

        Returns:
            x, y in px, shape (n, 2).
        """
        turn, _ = cv2.Rodrigues(self.rotation)
        shift = -self.rotation @ self.position
        seen, _ = cv2.projectPoints(points, turn, shift, self.matrix, self.distortion)
        return np.asarray(seen, np.float64).reshape(-1, 2)

    def on_sample(self, pixels: Array) -> Array:
        """Where the rays of pixels meet the plane z = 0.

        Args:
            pixels: x, y in px, shape (n, 2).

        Returns:
            x, y in mm, shape (n, 2); NaN where a ray does not meet it before the camera.
        """
        criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 40, 1e-9)
        straight = cv2.undistortPoints(
            pixels.reshape(-1, 1, 2), self.matrix, self.distortion, criteria=criteria
        ).reshape(-1, 2)
        rays = np.concatenate([straight, np.ones((len(straight), 1))], axis=1) @ self.rotation
        along = np.where(rays[:, 2] < 0, -self.position[2] / rays[:, 2], np.nan)
        return self.position[:2] + along[:, None] * rays[:, :2]


def corners_of(size_mm: tuple[float, float]) -> list[Point]:
    """The corners of a sheet in its own frame, mm, clockwise from its top left."""
    x, y = size_mm[0] / 2, size_mm[1] / 2
    return [(-x, y), (x, y), (x, -y), (-x, -y)]


def seen_at(view: View, points: list[Point]) -> tuple[Point, ...]:
    """Where points of the plane z = 0, mm, are seen: px, as a capture file notes them."""
    seen = view.pixels(np.array([(x, y, 0.0) for x, y in points]))
    return tuple((round(float(x), 3), round(float(y), 3)) for x, y in seen)


def pinhole(camera: Camera, focal_px: float, size_px: tuple[int, int]) -> Array:
    """The camera's matrix, px, its principal point in the picture's middle unless it states one."""
    width, height = size_px
    x, y = camera.principal_point_px or ((width - 1) / 2, (height - 1) / 2)
    return np.array([[focal_px, 0, x], [0, focal_px, y], [0, 0, 1]])


def _looking_at_centre(position: Array) -> Array:
    """Columns right, up, backwards of a camera that sees the origin, the sample's y up."""
    backwards = position / np.linalg.norm(position)
    right = np.cross([0.0, 1.0, 0.0], backwards)
    length = np.linalg.norm(right)
    right = right / length if length > 0 else np.array([1.0, 0.0, 0.0])
    return np.stack([right, np.cross(backwards, right), backwards], axis=1)
