# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Calibrations and mounts of simulated cameras."""

from typing import Sequence

import numpy as np

import sextant
from sextant.geometry.poses import R_BODY_OPTICAL

HORIZONTAL_FOV = np.deg2rad(62.0)  # of a usual webcam, radians


def camera_calibration(
    width: int,
    height: int,
    horizontal_fov: float = HORIZONTAL_FOV,
    distortion_model: str = "plumb_bob",
    distortion: Sequence[float] = (),
) -> "sextant.CameraCalibration":
    """Calibration of a camera with square pixels and its principal point in the middle of the image.

    :param horizontal_fov: radians, without distortion; below pi, or 2 pi for an equidistant lens
    :param distortion: coefficients in OpenCV's order; none for an ideal lens
    :raises ValueError: horizontal_fov is out of range, or the camera model rejects the calibration
    """
    equidistant = distortion_model == "equidistant"
    limit = 2.0 * np.pi if equidistant else np.pi
    if not 0.0 < horizontal_fov < limit:
        raise ValueError(
            f"horizontal_fov is {horizontal_fov}, allowed is (0, {limit:.4f}) for {distortion_model}"
        )
    half = 0.5 * horizontal_fov
    f = 0.5 * width / (half if equidistant else np.tan(half))
    calibration = sextant.CameraCalibration()
    calibration.width, calibration.height = width, height
    calibration.distortion_model = distortion_model
    calibration.D = list(distortion) or [0.0] * _IDEAL_COEFFICIENTS.get(distortion_model, 5)
    calibration.K = np.array([[f, 0.0, 0.5 * (width - 1)], [0.0, f, 0.5 * (height - 1)], [0.0, 0.0, 1.0]])
    calibration.P = np.hstack([calibration.K, np.zeros((3, 1))])
    sextant.CameraModel(calibration)  # raises if the calibration is invalid
    return calibration


def resized_calibration(
    calibration: "sextant.CameraCalibration", width: int, height: int
) -> "sextant.CameraCalibration":
    """Calibration of the same camera with images reduced or enlarged to another resolution.

    Pixel (0, 0) is the centre of the first pixel, so u' = s (u + 0.5) - 0.5.

    :raises ValueError: the aspect ratio is another
    """
    if abs(width * calibration.height - height * calibration.width) > max(calibration.width, width):
        raise ValueError(
            f"{width} x {height} is not the aspect ratio of the calibration, "
            f"{calibration.width} x {calibration.height}"
        )
    x, y = width / calibration.width, height / calibration.height
    scaling = np.array([[x, 0.0, 0.5 * (x - 1.0)], [0.0, y, 0.5 * (y - 1.0)], [0.0, 0.0, 1.0]])
    resized = sextant.CameraCalibration()
    resized.width, resized.height = width, height
    resized.distortion_model, resized.D, resized.R = (
        calibration.distortion_model,
        calibration.D,
        calibration.R,
    )
    resized.K, resized.P = scaling @ calibration.K, scaling @ calibration.P
    return resized


def camera_mount(xyz: Sequence[float], rpy: Sequence[float]) -> np.ndarray:
    """T_base_camera (4, 4) of a camera at xyz (metres) that faces along the x axis rotated by rpy."""
    T_mount_optical = np.eye(4)
    T_mount_optical[:3, :3] = R_BODY_OPTICAL
    return sextant.pose_from_xyz_rpy(xyz, rpy) @ T_mount_optical


# number of coefficients by distortion model
_IDEAL_COEFFICIENTS = {"plumb_bob": 5, "rational_polynomial": 8, "equidistant": 4}
