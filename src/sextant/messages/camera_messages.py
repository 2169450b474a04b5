# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Converts sensor_msgs/CameraInfo to calibrations and back."""

from typing import Any

import numpy as np
from sensor_msgs.msg import CameraInfo
from std_msgs.msg import Header

import sextant
from sextant.localization.drive_observations import DriveCamera

_SAME = ("width", "height", "distortion_model", "D", "K", "R", "P", "binning_x", "binning_y")
_REGION = ("x_offset", "y_offset", "width", "height")
_MAX_SIDE = 2**31 - 1  # pixels, of sextant.CameraCalibration


def same_calibration(a: Any, b: Any) -> bool:
    """Whether two sensor_msgs/CameraInfo have the same calibration."""
    same = all(np.array_equal(getattr(a, name), getattr(b, name)) for name in _SAME)
    return same and all(getattr(a.roi, name) == getattr(b.roi, name) for name in _REGION)


def camera_from_info(info: Any, rectified: bool) -> DriveCamera:
    """The camera of the published image, with the binning and region of interest of a sensor_msgs/CameraInfo
    applied (as src/ros/geometry/camera_conversions.cpp). Its mount is the identity.

    :raises ValueError: a field is not valid
    """
    binning = np.array([max(1, info.binning_x), max(1, info.binning_y)])
    whole = info.roi.width == 0 or info.roi.height == 0
    size = [info.width, info.height] if whole else [info.roi.width, info.roi.height]
    offset = np.array([0.0, 0.0] if whole else [info.roi.x_offset, info.roi.y_offset])
    width, height = (int(side) for side in np.array(size) // binning)
    if max(width, height) > _MAX_SIDE:
        raise ValueError(
            f"camera calibration: the image size is {width} x {height}, the maximum is {_MAX_SIDE}"
        )
    published = sextant.CameraCalibration()
    published.width, published.height = width, height
    published.distortion_model, published.D = info.distortion_model, list(info.D)
    published.K = _published(np.reshape(info.K, (3, 3)), binning, offset)
    published.R = np.reshape(info.R, (3, 3))
    published.P = _published(np.reshape(info.P, (3, 4)), binning, offset)
    sextant.CameraModel(published, rectified)  # raises if it is not valid
    return DriveCamera(published, rectified)


def _published(matrix: np.ndarray, binning: np.ndarray, offset: np.ndarray) -> np.ndarray:
    """K or P of the published image; the centres of binned pixels are shifted by half a pixel."""
    adapted = matrix.astype(float)
    adapted[:2] /= binning[:, None]
    adapted[:2, 2] = (matrix[:2, 2] - offset + 0.5) / binning - 0.5
    return adapted


def calibration_to_message(calibration: "sextant.CameraCalibration", header: Header) -> CameraInfo:
    """Convert a calibration to sensor_msgs/CameraInfo."""
    info = CameraInfo(header=header, height=calibration.height, width=calibration.width)
    info.distortion_model, info.D = calibration.distortion_model, list(calibration.D)
    info.K, info.R, info.P = (
        list(np.ravel(matrix)) for matrix in (calibration.K, calibration.R, calibration.P)
    )
    return info
