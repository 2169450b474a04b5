# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A camera whose pixels and rays are computed many at once."""

from dataclasses import dataclass
from typing import Any, Sequence

import cv2
import numpy as np

MODELS = ("plumb_bob", "rational_polynomial")


@dataclass(frozen=True, eq=False)
class PinholeCamera:
    """A raw image's camera; in its pixels (0, 0) is the middle of the first one."""

    K: np.ndarray  # (3, 3) pixels
    D: np.ndarray  # OpenCV's coefficients; empty: none
    size: Sequence[int]  # width and height, pixels

    @classmethod
    def of(cls, calibration: Any) -> "PinholeCamera":
        """:param calibration: with the fields of sensor_msgs/CameraInfo

        :raises ValueError: it is of another lens, or there is none
        """
        K = np.array(calibration.K, float).reshape(3, 3)
        if calibration.distortion_model not in MODELS:
            allowed = " or ".join(MODELS)
            raise ValueError(f"distortion_model is '{calibration.distortion_model}', it must be {allowed}")
        if not (np.all(np.isfinite(K)) and K[0, 0] > 0.0 and K[1, 1] > 0.0):
            raise ValueError("K holds no focal length: the camera is not calibrated")
        return cls(K, np.array(calibration.D, float), (calibration.width, calibration.height))

    @property
    def focal_length(self) -> float:
        """Pixels."""
        return float(0.5 * (self.K[0, 0] + self.K[1, 1]))

    def rays(self, pixels: np.ndarray) -> np.ndarray:
        """(n, 3) with z = 1, of pixels (n, 2)."""
        plane = cv2.undistortPoints(pixels.reshape(-1, 1, 2).astype(np.float64), self.K, self.D)
        return np.column_stack([plane[:, 0], np.ones(len(plane))])

    def project(self, points: np.ndarray) -> np.ndarray:
        """Pixels (n, 2) of points (n, 3) before the camera."""
        if not len(points):
            return np.zeros((0, 2))
        if not self.D.any():
            return points[:, :2] / points[:, 2:] @ self.K[:2, :2].T + self.K[:2, 2]
        found, _ = cv2.projectPoints(points.reshape(-1, 1, 3), np.zeros(3), np.zeros(3), self.K, self.D)
        return found[:, 0]
