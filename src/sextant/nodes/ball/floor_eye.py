# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Looks at the floor before a robot with its depth camera."""

from typing import Optional

import numpy as np
import rospy
from sensor_msgs.msg import CameraInfo, Image

import sextant
from sextant.bags.pictures import depth_image
from sextant.ball.depth_points import DepthPoints
from sextant.nodes.objects.camera_geometry import CameraGeometry, same_pose

INFO = "depth/camera_info"


class FloorEye:
    """Not thread-safe."""

    def __init__(self, scale: float, step: int):
        """As DepthPoints has them."""
        self._scale, self._step = scale, step
        self._geometry = CameraGeometry()
        self._points: Optional[DepthPoints] = None
        self._made_for: Optional[sextant.CameraModel] = None
        self._T_base_depth = np.eye(4)

    def hear(self, info: CameraInfo) -> None:
        """How the camera sees."""
        self._geometry.hear(INFO, info)

    def look(self, depth: Image, base_frame: str) -> np.ndarray:
        """Points (n, 3) in the robot frame, metres.

        :param base_frame: of the robot, as odometry tells it; empty: it did not tell
        :raises ValueError: why the image shows nothing
        """
        if not base_frame:
            raise ValueError(f"nothing is heard on {rospy.resolve_name('odom')}")
        camera = self._geometry.camera(INFO)
        T_base_depth = self._geometry.transform(base_frame, depth.header.frame_id, depth.header.stamp)
        is_same = camera == self._made_for and same_pose(T_base_depth, self._T_base_depth)
        if self._points is None or not is_same:
            self._points = DepthPoints(camera, T_base_depth, self._scale, self._step)
            self._made_for, self._T_base_depth = camera, T_base_depth
        return self._points.of(depth_image(depth))
