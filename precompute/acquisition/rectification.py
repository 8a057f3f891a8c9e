"""Where on the sample a photograph's pixels are, and from where it was taken."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from precompute.acquisition.capture import Camera, Corners
from precompute.acquisition.view import View, pinhole

Array = NDArray[np.float64]

NORMAL_LENS = 1.2
"""Focal length over the picture's width where nothing is known of it: 43 mm on a sensor of 36."""


@dataclass(frozen=True)
class Rectification:
    """Between the plane of the sample and the pixels of a photograph.

    Attributes:
        homography: From (x, y, 1) in mm to what a lens without distortion would show, px.
        matrix: The pinhole's matrix, px, about which the lens distorts.
        distortion: k1, k2, p1, p2, k3 of OpenCV's model, no unit.
        eye: The camera's centre of projection in the sample's frame, mm, shape (3,).
        is_scaled: Whether the eye's distance is known; else it was assumed (`NORMAL_LENS`).
    """

    homography: Array
    matrix: Array
    distortion: Array
    eye: Array
    is_scaled: bool

    @staticmethod
    def of(
        camera: Camera,
        focal_px: float | None,
        size_px: tuple[int, int],
        size_mm: tuple[float, float],
        corners_px: Corners,
    ) -> Rectification:
        """The rectification that takes a photograph's corners to those of the sample.

        Args:
            camera: What is known of the camera.
            focal_px: Its focal length, stated or read from the photograph.
            size_px: Width and height of the photograph.
            size_mm: Width and height of the sample.
            corners_px: The sample's corners in it, clockwise from its top left.
        """
        assumed = NORMAL_LENS * size_px[0]
        matrix = pinhole(camera, focal_px or assumed, size_px)
        distortion = np.array(camera.distortion)
        corners = np.array(corners_px, dtype=np.float64)
        straight = cv2.undistortPoints(corners[:, None], matrix, distortion, P=matrix)[:, 0]
        plane = corners_mm(size_mm)
        homography = np.asarray(cv2.findHomography(plane, straight)[0], np.float64)
        eye = camera.position_mm
        if eye is None:
            eye = _eye(homography, matrix)
        is_scaled = camera.position_mm is not None or focal_px is not None
        return Rectification(homography, matrix, distortion, np.array(eye), is_scaled)

    @staticmethod
    def of_view(view: View) -> Rectification:
        """The rectification of a view that is wholly known."""
        pose = np.stack(
            [view.rotation[:, 0], view.rotation[:, 1], -view.rotation @ view.position], axis=1
        )
        return Rectification(view.matrix @ pose, view.matrix, view.distortion, view.position, True)

    def pixels(self, xy: Array) -> Array:
        """Where points of the sample, mm, shape (n, 2), are seen: px, shape (n, 2).

        Args:
            xy: Points, mm, shape (n, 2).
        """
        straight = cv2.perspectiveTransform(np.ascontiguousarray(xy)[:, None], self.homography)
        if not self.distortion.any():
            return np.asarray(straight[:, 0], np.float64)
        rays = cv2.undistortPoints(straight, self.matrix, None)
        points = cv2.convertPointsToHomogeneous(rays)
        none = np.zeros(3)
        seen, _ = cv2.projectPoints(points, none, none, self.matrix, self.distortion)
        return np.asarray(seen[:, 0], np.float64)

    def on_sample(self, pixels: Array) -> Array:
        """Which points of the sample, mm, shape (n, 2), are seen at pixels, shape (n, 2)."""
        straight = cv2.undistortPoints(
            np.ascontiguousarray(pixels)[:, None], self.matrix, self.distortion, P=self.matrix
        )
        points = cv2.perspectiveTransform(straight, np.linalg.inv(self.homography))
        return np.asarray(points[:, 0], np.float64)

    def pixels_per_mm(self) -> float:
        """Resolution at the sample's centre."""
        cross = np.array([[-1.0, 0], [1, 0], [0, -1], [0, 1]])
        left, right, below, above = self.pixels(cross)
        (a, b), (c, d) = (right - left) / 2, (above - below) / 2
        return float(np.sqrt(abs(a * d - b * c)))


def corners_mm(size_mm: tuple[float, float]) -> Array:
    """A sample's corners, clockwise from its top left, shape (4, 2)."""
    x, y = size_mm[0] / 2, size_mm[1] / 2
    return np.array([(-x, y), (x, y), (x, -y), (-x, -y)])


def _eye(homography: Array, matrix: Array) -> Array:
    """The centre of projection of a pinhole that shows the plane z = 0 so (Zhang 2000, 3.1)."""
    columns = np.linalg.solve(matrix, homography)
    columns /= np.sqrt(np.linalg.norm(columns[:, 0]) * np.linalg.norm(columns[:, 1]))
    columns *= np.sign(columns[2, 2])  # the sample is before the camera
    first, second, shift = columns.T
    nearest, _, rest = np.linalg.svd(np.stack([first, second, np.cross(first, second)], axis=1))
    eye = -(nearest @ rest).T @ shift
    # x and y of the frame turn against each other in a picture whose y points down, so z does too.
    return eye
