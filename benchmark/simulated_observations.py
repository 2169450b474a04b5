# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Observations without images: exact corners from OpenCV's projection, plus Gaussian noise of known sigma."""

from typing import Dict, List, Tuple

import cv2
import numpy as np
from real_data import calibration
from under_test import map_of

import sextant

FAMILY, SIZE = "tag36h11", 0.2  # family of the markers; edge length, m
T_BASE_CAMERA = sextant.pose_from_xyz_rpy([0.1, 0.0, 1.0], [-np.pi / 2, 0.0, -np.pi / 2])
LENSES: Dict[str, Tuple[str, List[float]]] = {
    "plumb_bob 0": ("plumb_bob", []),
    "plumb_bob 4": ("plumb_bob", [-0.25, 0.06, 0.001, -0.001]),
    "plumb_bob 5": ("plumb_bob", [-0.25, 0.08, 0.001, -0.001, -0.01]),
    "plumb_bob 8": ("plumb_bob", [-0.1, 0.02, 0.001, -0.001, 0.002, 0.15, 0.01, 0.003]),
    "rational_polynomial": ("rational_polynomial", [0.2, 0.02, 0.001, -0.001, 0.002, 0.5, 0.08, 0.005]),
    "equidistant": ("equidistant", [-0.01, 0.002, 0.0, 0.0]),
}
MIN_COSINE = 0.17  # minimum cosine between line of sight and a marker's normal
NEAREST = 0.3  # minimum depth of a marker, m


class SimulatedCamera:
    """A camera mounted at T_BASE_CAMERA, with fx of half its width; sigma: corner noise, pixels."""

    def __init__(self, lens: str, size: Tuple[int, int] = (640, 480), sigma: float = 0.3, seed: int = 1):
        model, self._D = LENSES[lens]
        width, height = size
        f = 0.5 * width
        K = [f, 0.0, width / 2 - 0.5, 0.0, f, height / 2 - 0.5, 0.0, 0.0, 1.0]
        self.calibration = calibration(size, K, self._D, model)
        self._K, self._fisheye = np.array(self.calibration.K), model == "equidistant"
        self.model, self.sigma = sextant.CameraModel(self.calibration), sigma
        self.random = np.random.default_rng(seed)

    def project(self, points: np.ndarray) -> np.ndarray:
        """Pixels (N, 2) of points (N, 3) in the optical frame, by OpenCV, not the projection under test."""
        call = cv2.fisheye.projectPoints if self._fisheye else cv2.projectPoints
        pixels, _ = call(points.reshape(-1, 1, 3), np.zeros(3), np.zeros(3), self._K, np.array(self._D))
        return pixels.reshape(-1, 2)

    def visible(self, T_map_base: np.ndarray, marker_map) -> list:
        """Markers of the map that are completely in the image and not seen too obliquely."""
        return [marker for marker in marker_map.markers if self._sees(T_map_base, marker)]

    def view(self, T_map_base: np.ndarray, markers: list):
        """Returns a sextant.MarkerView of the markers, with noise."""
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
        if centre[2] < NEAREST or normal @ centre > -MIN_COSINE * np.linalg.norm(centre):
            return False
        return all(map(self._inside, in_camera(T_map_base, corners_in_map(marker))))

    def _inside(self, point: np.ndarray) -> bool:
        pixel = self.model.project(point)  # None outside of the lens's valid range; OpenCV has no such limit
        return pixel is not None and 0 < pixel[0] < self.model.width and 0 < pixel[1] < self.model.height


def corners_in_map(marker) -> np.ndarray:
    """Corners (4, 3) of a marker in the map, metres."""
    corners = np.c_[sextant.marker_corners(marker.size), np.ones(4)]
    return (corners @ marker.T_map_marker.T)[:, :3]


def in_camera(T_map_base: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Takes points (N, 3) from the map to the optical frame, metres."""
    T_map_camera = T_map_base @ T_BASE_CAMERA
    return (points - T_map_camera[:3, 3]) @ T_map_camera[:3, :3]


def wall_map(xyz_yaw: List[Tuple[float, float, float, float]]):
    """Returns a sextant.MarkerMap of upright markers that face the direction yaw (radians, 0 along x)."""
    poses = (sextant.pose_from_xyz_rpy(xyz, [np.pi / 2, 0.0, yaw + np.pi / 2]) for *xyz, yaw in xyz_yaw)
    return map_of(sextant.MappedMarker(FAMILY, id, SIZE, pose) for id, pose in enumerate(poses))
