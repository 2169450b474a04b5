# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a robot's cameras saw on a drive; it can be pickled, so that processes and machines can hand it on."""

from dataclasses import dataclass, field
from typing import Dict, List, Sequence

import numpy as np

import sextant


@dataclass(frozen=True)
class DriveCamera:
    """A camera of the robot."""

    calibration: "sextant.CameraCalibration"
    rectified: bool = False  # which of the two images the corners are in
    T_base_camera: np.ndarray = field(default_factory=lambda: np.eye(4))  # of its optical frame, metres

    def model(self) -> "sextant.CameraModel":
        """:raises ValueError: names the field that cannot be"""
        return sextant.CameraModel(self.calibration, self.rectified)


@dataclass(frozen=True)
class SeenImage:
    """One image of one camera; without markers, it says that there was an image."""

    stamp: int  # nanoseconds
    camera: str  # a name of DriveSightings.cameras
    markers: Sequence["sextant.Detection"]


@dataclass(frozen=True)
class DriveSightings:
    """One bag."""

    name: str
    cameras: Dict[str, DriveCamera]
    images: List[SeenImage]  # in order of their stamps
    odometry_stamps: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))  # nanoseconds
    odometry: np.ndarray = field(default_factory=lambda: np.zeros((0, 4, 4)))  # T_odom_base at those stamps
