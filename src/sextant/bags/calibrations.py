# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Calibrations of cameras: from camera_info, or from a file of camera_calibration."""

from typing import Any

import numpy as np

import sextant
from sextant.bags.bag_file import BagError
from sextant.calibration.calibration_file import CalibrationFileError, read_calibration
from sextant.localization.drive_sightings import DriveCamera

_SAME = ("width", "height", "distortion_model", "D", "K", "R", "P", "binning_x", "binning_y")
_REGION = ("x_offset", "y_offset", "width", "height")


def same_calibration(a: Any, b: Any) -> bool:
    """Whether two sensor_msgs/CameraInfo say the same of a camera."""
    same = all(tuple(_listed(getattr(a, name))) == tuple(_listed(getattr(b, name))) for name in _SAME)
    return same and all(getattr(a.roi, name) == getattr(b.roi, name) for name in _REGION)


def _listed(value: Any) -> Any:
    return value if isinstance(value, (list, tuple)) else (value,)


def camera_from_info(info: Any, rectified: bool) -> DriveCamera:
    """The camera of the image as it is published: binning and region of interest of a
    sensor_msgs/CameraInfo are applied (src/ros/geometry/pose_conversions.cpp). Its mount is left at identity.

    :raises ValueError: it is no calibration; names the field
    """
    binning = np.array([max(1, info.binning_x), max(1, info.binning_y)])
    whole = info.roi.width == 0 or info.roi.height == 0
    size = [info.width, info.height] if whole else [info.roi.width, info.roi.height]
    offset = np.array([0.0, 0.0] if whole else [info.roi.x_offset, info.roi.y_offset])
    published = sextant.CameraCalibration()
    published.width, published.height = (int(side) for side in np.array(size) // binning)
    published.distortion_model, published.D = info.distortion_model, list(info.D)
    published.K = _published(np.reshape(info.K, (3, 3)), binning, offset)
    published.R = np.reshape(info.R, (3, 3))
    published.P = _published(np.reshape(info.P, (3, 4)), binning, offset)
    sextant.CameraModel(published, rectified)  # refuses what it cannot project with
    return DriveCamera(published, rectified)


def _published(matrix: np.ndarray, binning: np.ndarray, offset: np.ndarray) -> np.ndarray:
    """K or P for the pixels that are published: merged ones have their centres half a pixel inside."""
    adapted = matrix.astype(float)
    adapted[:2] /= binning[:, None]
    adapted[:2, 2] = (matrix[:2, 2] - offset + 0.5) / binning - 0.5
    return adapted


def camera_from_file(path: str, rectified: bool) -> DriveCamera:
    """The camera of a YAML file as camera_calibration writes it; for images of the size that it names.

    :raises BagError: it cannot be read, or is no such file; names what is missing or wrong
    """
    try:
        return DriveCamera(read_calibration(path), rectified)
    except CalibrationFileError as error:
        raise BagError(path, error.what, "expected is a YAML file as camera_calibration writes it") from None
