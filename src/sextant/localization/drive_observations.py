# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Marker detections and odometry of a recorded drive. They can be pickled for worker processes."""

from dataclasses import dataclass, field
from typing import Dict, List, Sequence

import numpy as np

import sextant


@dataclass(frozen=True)
class DriveCamera:
    """A camera of the robot."""

    calibration: "sextant.CameraCalibration"  # lens and image size
    rectified: bool = False  # corners are in the rectified image; False: in the raw image
    T_base_camera: np.ndarray = field(default_factory=lambda: np.eye(4))  # (4, 4) of the optical frame

    def model(self) -> "sextant.CameraModel":
        """Returns the camera model.

        :raises ValueError: the calibration is invalid; names the field
        """
        return sextant.CameraModel(self.calibration, self.rectified)


@dataclass(frozen=True)
class ImageDetections:
    """Detections in one image of one camera; empty if the image shows no marker."""

    stamp: int  # nanoseconds
    camera: str  # key of DriveObservations.cameras
    markers: Sequence["sextant.Detection"]  # one per detected marker


@dataclass(frozen=True)
class DriveObservations:
    """Observations of one bag."""

    name: str  # of the bag
    cameras: Dict[str, DriveCamera]  # by name, see mounted_camera_name()
    images: List[ImageDetections]  # by ascending stamp
    odometry_stamps: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))  # nanoseconds
    odometry: np.ndarray = field(default_factory=lambda: np.zeros((0, 4, 4)))  # T_odom_base by stamp
