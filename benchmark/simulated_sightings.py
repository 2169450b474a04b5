# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sightings without images: exact corners by OpenCV's own projection, plus noise of a known deviation."""

from typing import Dict, List, Tuple

import cv2
import numpy as np
from real_data import calibration

import sextant

FAMILY, SIZE = "tag36h11", 0.2  # m
T_BASE_CAMERA = sextant.pose_from_xyz_rpy([0.1, 0.0, 1.0], [-np.pi / 2, 0.0, -np.pi / 2])
LENSES: Dict[str, Tuple[str, List[float]]] = {
    "plumb_bob 0": ("plumb_bob", []),
    "plumb_bob 4": ("plumb_bob", [-0.25, 0.06, 0.001, -0.001]),
    "plumb_bob 5": ("plumb_bob", [-0.25, 0.08, 0.001, -0.001, -0.01]),
    "plumb_bob 8": ("plumb_bob", [-0.1, 0.02, 0.001, -0.001, 0.002, 0.15, 0.01, 0.003]),
    "rational_polynomial": ("rational_polynomial", [0.2, 0.02, 0.001, -0.001, 0.002, 0.5, 0.08, 0.005]),
    "equidistant": ("equidistant", [-0.01, 0.002, 0.0, 0.0]),
}
STEEPEST = 0.17  # least cosine between line of sight and a marker's normal
NEAREST = 0.3  # m


class SimulatedCamera:
    """A camera with fx = 0.5 x its width, on the mount T_BASE_CAMERA."""

    def __init__(self, lens: str, size: Tuple[int, int] = (640, 480), sigma: float = 0.3, seed: int = 1):
        model, self._D = LENSES[lens]
        width, height = size
        f = 0.5 * width
        K = [f, 0.0, width / 2 - 0.5, 0.0, f, height / 2 - 0.5, 0.0, 0.0, 1.0]
        known = calibration(size, K, self._D, model)
        self._K, self._fisheye = np.array(known.K), model == "equidistant"
        self.model, self.sigma = sextant.CameraModel(known), sigma
        self.random = np.random.default_rng(seed)

    def project(self, points: np.ndarray) -> np.ndarray:
        """(N, 2) pixels of (N, 3) points in the optical frame; OpenCV's, not the one under test."""
        call = cv2.fisheye.projectPoints if self._fisheye else cv2.projectPoints
        pixels, _ = call(points.reshape(-1, 1, 3), np.zeros(3), np.zeros(3), self._K, np.array(self._D))
        return pixels.reshape(-1, 2)

    def visible(self, T_map_base: np.ndarray, marker_map) -> list:
        """Those of the map's markers that lie in the image whole and not too steeply."""
        return [marker for marker in marker_map.markers if self._sees(T_map_base, marker)]

    def view(self, T_map_base: np.ndarray, markers: list):
        """sextant.MarkerView of the markers, with noise."""
        return sextant.MarkerView(
            self.model, T_BASE_CAMERA, [self._detection(T_map_base, marker) for marker in markers]
        )

    def _detection(self, T_map_base: np.ndarray, marker):
        noise = self.sigma * self.random.normal(size=(4, 2))
        corners = self.project(in_camera(T_map_base, corners_in_map(marker))) + noise
        return sextant.Detection(marker.family, marker.id, corners)

    def _sees(self, T_map_base: np.ndarray, marker) -> bool:
        T_camera_marker = np.linalg.inv(T_map_base @ T_BASE_CAMERA) @ marker.T_map_marker
        normal, centre = T_camera_marker[:3, 2], T_camera_marker[:3, 3]
        if centre[2] < NEAREST or normal @ centre > -STEEPEST * np.linalg.norm(centre):
            return False
        return all(map(self._inside, in_camera(T_map_base, corners_in_map(marker))))

    def _inside(self, point: np.ndarray) -> bool:
        pixel = self.model.project(point)  # None beyond the lens; OpenCV's has no such limit
        return pixel is not None and 0 < pixel[0] < self.model.width and 0 < pixel[1] < self.model.height


def corners_in_map(marker) -> np.ndarray:
    """(4, 3) metres."""
    corners = np.c_[sextant.marker_corners(marker.size), np.ones(4)]
    return (corners @ marker.T_map_marker.T)[:, :3]


def in_camera(T_map_base: np.ndarray, points: np.ndarray) -> np.ndarray:
    """(N, 3) points of the map in the optical frame."""
    T_map_camera = T_map_base @ T_BASE_CAMERA
    return (points - T_map_camera[:3, 3]) @ T_map_camera[:3, :3]


def wall_map(xyz_yaw: List[Tuple[float, float, float, float]]):
    """sextant.MarkerMap of upright markers that face the direction yaw (radians, 0 along x)."""
    result = sextant.MarkerMap()
    for id, (x, y, z, yaw) in enumerate(xyz_yaw):
        pose = sextant.pose_from_xyz_rpy([x, y, z], [np.pi / 2, 0.0, yaw + np.pi / 2])
        result.add(sextant.MappedMarker(FAMILY, id, SIZE, pose))
    return result
