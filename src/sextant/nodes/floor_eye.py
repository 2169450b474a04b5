# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Looks at the floor before a robot with its depth camera."""

from typing import NamedTuple, Optional

import numpy as np
import rospy
from sensor_msgs.msg import CameraInfo, Image

from sextant.bags.calibrations import same_calibration
from sextant.bags.pictures import depth_image
from sextant.ball.depth_points import DepthPoints
from sextant.nodes.rgbd_geometry import SAME, RgbdGeometry
from sextant.objects.object_locator import LocatorSettings


class FloorLook(NamedTuple):
    """What one depth image shows."""

    stamp: int  # nanoseconds
    points: np.ndarray  # (n, 3) metres, robot frame


class FloorEye:
    """Not thread-safe."""

    def __init__(self, scale: float, step: int):
        """As DepthPoints has them."""
        self._scale, self._step = scale, step
        self._geometry = RgbdGeometry(LocatorSettings(), "")
        self._info: Optional[CameraInfo] = None
        self._points: Optional[DepthPoints] = None
        self._T_base_depth = np.eye(4)

    def hear(self, info: CameraInfo) -> None:
        """How the camera sees."""
        if self._info is None or not same_calibration(info, self._info):
            self._info, self._points = info, None
        self._geometry.hear("depth", info)

    def look(self, depth: Image, base_frame: str) -> FloorLook:
        """:param base_frame: of the robot, as odometry tells it; empty: it did not tell

        :raises ValueError: why the image shows nothing
        """
        if not base_frame:
            raise ValueError(f"nothing is heard on {rospy.resolve_name('odom')}")
        camera = self._geometry.camera("depth")
        T_base_depth = self._geometry.transform(base_frame, depth.header.frame_id, depth.header.stamp)
        if self._points is None or abs(T_base_depth - self._T_base_depth).max() > SAME:
            self._points = DepthPoints(camera, T_base_depth, self._scale, self._step)
            self._T_base_depth = T_base_depth
        return FloorLook(depth.header.stamp.to_nsec(), self._points.of(depth_image(depth)))
