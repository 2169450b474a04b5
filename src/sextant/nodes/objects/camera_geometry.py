# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Camera models from camera_info and transforms between cameras from tf."""

from typing import Dict

import numpy as np
import rospy
import tf2_ros
from sensor_msgs.msg import CameraInfo

import sextant
from sextant.messages.camera_messages import camera_from_info, same_calibration
from sextant.messages.frame_name import frame_name
from sextant.messages.pose_messages import pose_from_transform

SAME = 1e-6  # metres, and elements of a rotation matrix


class CameraGeometry:
    """Camera models by the topic of their camera_info, and tf look-ups."""

    def __init__(self) -> None:
        self._infos: Dict[str, CameraInfo] = {}
        self._cameras: Dict[str, sextant.CameraModel] = {}  # of these
        self._buffer = tf2_ros.Buffer()
        self._listener = tf2_ros.TransformListener(self._buffer)

    def set_info(self, topic: str, info: CameraInfo) -> None:
        """Store the calibration published on a topic."""
        if topic not in self._infos or not same_calibration(info, self._infos[topic]):
            self._cameras.pop(topic, None)
        self._infos[topic] = info

    def camera(self, topic: str) -> "sextant.CameraModel":
        """The same object until the calibration changes. :raises ValueError: no or invalid calibration"""
        if topic not in self._infos:
            raise ValueError(f"no message on {rospy.resolve_name(topic)}")
        if topic not in self._cameras:
            try:
                self._cameras[topic] = _pinhole_model(self._infos[topic])
            except ValueError as error:
                raise ValueError(f"{rospy.resolve_name(topic)}: {error}") from None
        return self._cameras[topic]

    def transform(self, target: str, source: str, stamp: rospy.Time) -> np.ndarray:
        """T_target_source (4, 4) from tf. :raises ValueError: no such transform"""
        try:
            found = self._buffer.lookup_transform(frame_name(target), frame_name(source), stamp)
        except (tf2_ros.TransformException, ValueError) as error:
            raise ValueError(f"no transform from '{source}' to '{target}': {error}") from None
        return pose_from_transform(found.transform)


def _pinhole_model(info: CameraInfo) -> "sextant.CameraModel":
    camera = camera_from_info(info, rectified=False)
    if camera.calibration.distortion_model == "equidistant":
        raise ValueError("distortion_model is 'equidistant', it must be plumb_bob or rational_polynomial")
    return camera.model()


def same_pose(T: np.ndarray, other: np.ndarray) -> bool:
    """Whether two transforms (4, 4) are equal up to rounding."""
    return bool(abs(T - other).max() <= SAME)
