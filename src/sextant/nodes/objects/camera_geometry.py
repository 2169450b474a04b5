# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""How cameras see and where they are, as their camera_info and tf tell it."""

from typing import Dict

import numpy as np
import rospy
import tf2_ros
from sensor_msgs.msg import CameraInfo

import sextant
from sextant.bags.calibrations import camera_from_info, same_calibration
from sextant.bags.transforms import frame_name
from sextant.nodes.base.conversions import pose_from_transform

SAME = 1e-6  # metres, and of a rotation's elements


class CameraGeometry:
    """Of the cameras whose camera_info it hears, each told by its topic's name."""

    def __init__(self) -> None:
        self._infos: Dict[str, CameraInfo] = {}
        self._cameras: Dict[str, sextant.CameraModel] = {}  # of these
        self._buffer = tf2_ros.Buffer()
        self._listener = tf2_ros.TransformListener(self._buffer)

    def hear(self, topic: str, info: CameraInfo) -> None:
        """How that topic's camera sees."""
        if topic not in self._infos or not same_calibration(info, self._infos[topic]):
            self._cameras.pop(topic, None)
        self._infos[topic] = info

    def camera(self, topic: str) -> "sextant.CameraModel":
        """The same object until its calibration changes. :raises ValueError: it is not known, or cannot be"""
        if topic not in self._infos:
            raise ValueError(f"nothing is heard on {rospy.resolve_name(topic)}")
        if topic not in self._cameras:
            try:
                self._cameras[topic] = _pinhole_model(self._infos[topic])
            except ValueError as error:
                raise ValueError(f"{rospy.resolve_name(topic)}: {error}") from None
        return self._cameras[topic]

    def transform(self, target: str, source: str, stamp: rospy.Time) -> np.ndarray:
        """T_target_source (4, 4) as tf has it. :raises ValueError: nothing connects the two"""
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
    """Whether two (4, 4) are one but for rounding."""
    return bool(abs(T - other).max() <= SAME)
