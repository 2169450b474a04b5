# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where a colour and a depth camera are and how they see, as their camera_info and tf tell it."""

from typing import Any, Dict, Optional, Tuple

import numpy as np
import rospy
import tf2_ros
from sensor_msgs.msg import CameraInfo

from sextant.bags.calibrations import camera_from_info, same_calibration
from sextant.bags.transforms import frame_name
from sextant.nodes.conversions import pose_from_transform
from sextant.objects.object_locator import LocatorSettings, ObjectLocator
from sextant.objects.pinhole_camera import PinholeCamera

SAME = 1e-6  # metres, and of a rotation's elements


class RgbdGeometry:
    """A locator of objects, made anew when a calibration changes, or where one camera is beside the other."""

    def __init__(self, settings: LocatorSettings, base_frame: str):
        self._settings, self._base_frame = settings, base_frame
        self._infos: Dict[str, CameraInfo] = {}
        self._cameras: Dict[str, PinholeCamera] = {}  # of these
        self._locator: Optional[ObjectLocator] = None
        self._T_colour_depth = np.eye(4)
        self._buffer = tf2_ros.Buffer()
        self._listener = tf2_ros.TransformListener(self._buffer)

    def hear(self, which: str, info: CameraInfo) -> None:
        """:param which: "colour" or "depth" """
        if which not in self._infos or not same_calibration(info, self._infos[which]):
            self._locator = None
            self._cameras.pop(which, None)
        self._infos[which] = info

    def camera(self, which: str) -> PinholeCamera:
        """:raises ValueError: it is not known, or cannot be"""
        topic = {"colour": "camera_info", "depth": "depth/camera_info"}[which]
        if which not in self._infos:
            raise ValueError(f"nothing is heard on {rospy.resolve_name(topic)}")
        if which not in self._cameras:
            try:
                self._cameras[which] = PinholeCamera.of(camera_from_info(self._infos[which], rectified=False))
            except ValueError as error:
                raise ValueError(f"{rospy.resolve_name(topic)}: {error}") from None
        return self._cameras[which]

    def at(self, colour: Any, depth: Any) -> Tuple[ObjectLocator, np.ndarray]:
        """The locator and T_base_colour (4, 4).

        :param colour: header of the picture. :param depth: of the depth image
        :raises ValueError: a camera is not known, or nothing connects two frames; names them
        """
        T_base_colour = self.transform(self._base_frame, colour.frame_id, colour.stamp)
        T_colour_depth = self.transform(colour.frame_id, depth.frame_id, colour.stamp)
        if self._locator is None or abs(T_colour_depth - self._T_colour_depth).max() > SAME:
            cameras = self.camera("colour"), self.camera("depth")
            self._locator = ObjectLocator(self._settings, *cameras, T_colour_depth)
            self._T_colour_depth = T_colour_depth
        return self._locator, T_base_colour

    def transform(self, target: str, source: str, stamp: rospy.Time) -> np.ndarray:
        """T_target_source (4, 4) as tf has it. :raises ValueError: nothing connects the two"""
        try:
            found = self._buffer.lookup_transform(frame_name(target), frame_name(source), stamp)
        except (tf2_ros.TransformException, ValueError) as error:
            raise ValueError(f"no transform from '{source}' to '{target}': {error}") from None
        return pose_from_transform(found.transform)
