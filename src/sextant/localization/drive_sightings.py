# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a robot's cameras saw on a drive, as plain values: processes and machines can hand them on."""

from dataclasses import dataclass, field
from typing import Dict, List, Sequence, Tuple

import numpy as np

import sextant


@dataclass(frozen=True)
class DriveCamera:
    """A camera of the robot, in the fields of sensor_msgs/CameraInfo."""

    width: int  # pixels
    height: int
    distortion_model: str
    D: Tuple[float, ...]
    K: Tuple[float, ...]  # (9), row by row
    R: Tuple[float, ...]  # (9)
    P: Tuple[float, ...]  # (12)
    rectified: bool  # which of the two images the corners are in
    T_base_camera: np.ndarray  # (4, 4) mount of its optical frame, metres

    @classmethod
    def of(cls, calibration: "sextant.CameraCalibration", rectified: bool = False) -> "DriveCamera":
        """As the base itself."""
        c = calibration
        D, K, R, P = (tuple(float(value) for value in np.ravel(matrix)) for matrix in (c.D, c.K, c.R, c.P))
        return cls(c.width, c.height, c.distortion_model, D, K, R, P, rectified, np.eye(4))

    def model(self) -> "sextant.CameraModel":
        """:raises ValueError: names the field that cannot be"""
        calibration = sextant.CameraCalibration()
        calibration.width, calibration.height = self.width, self.height
        calibration.distortion_model, calibration.D = self.distortion_model, list(self.D)
        calibration.K, calibration.R = np.reshape(self.K, (3, 3)), np.reshape(self.R, (3, 3))
        calibration.P = np.reshape(self.P, (3, 4))
        return sextant.CameraModel(calibration, self.rectified)


@dataclass(frozen=True)
class SeenMarker:
    """A marker in an image."""

    family: str
    id: int
    corners: np.ndarray  # (4, 2) pixels, in the order of sextant.Detection
    sigmas: np.ndarray  # (4,) pixels; -1: unknown


@dataclass(frozen=True)
class SeenImage:
    """One image of one camera; without markers, it says that there was an image."""

    stamp: int  # nanoseconds
    camera: str  # a name of DriveSightings.cameras
    markers: Sequence[SeenMarker]


@dataclass(frozen=True)
class DriveSightings:
    """One bag."""

    name: str
    cameras: Dict[str, DriveCamera]
    images: List[SeenImage]  # in order of their stamps
    odometry_stamps: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))  # nanoseconds
    odometry: np.ndarray = field(default_factory=lambda: np.zeros((0, 4, 4)))  # T_odom_base at those stamps
