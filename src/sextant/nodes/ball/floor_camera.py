# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Points on the floor from a robot's depth camera, by camera_info and tf."""

from typing import Optional

import numpy as np
import rospy
from sensor_msgs.msg import CameraInfo, Image

import sextant
from sextant.ball.depth_points import DepthPoints
from sextant.messages.image_messages import depth_image
from sextant.nodes.objects.camera_geometry import CameraGeometry, same_pose

INFO = "depth/camera_info"


class FloorCamera:
    """Creates a new DepthPoints when the calibration or the mount changes. Not thread-safe."""

    def __init__(self, scale: float, step: int):
        """:param scale: factor that corrects depths. :param step: pixels between used depths"""
        self._scale, self._step = scale, step
        self._geometry = CameraGeometry()
        self._points: Optional[DepthPoints] = None
        self._made_for: Optional[sextant.CameraModel] = None
        self._T_base_depth = np.eye(4)

    def set_info(self, info: CameraInfo) -> None:
        """Store the calibration."""
        self._geometry.set_info(INFO, info)

    def points(self, depth: Image, base_frame: str) -> np.ndarray:
        """Convert a depth image to points (n, 3) in the robot frame, metres.

        :param base_frame: the robot frame, from odometry; empty: no odometry yet
        :raises ValueError: why the image cannot be used
        """
        if not base_frame:
            raise ValueError(f"no message on {rospy.resolve_name('odom')}")
        camera = self._geometry.camera(INFO)
        T_base_depth = self._geometry.transform(base_frame, depth.header.frame_id, depth.header.stamp)
        is_same = camera == self._made_for and same_pose(T_base_depth, self._T_base_depth)
        if self._points is None or not is_same:
            self._points = DepthPoints(camera, T_base_depth, self._scale, self._step)
            self._made_for, self._T_base_depth = camera, T_base_depth
        return self._points.of(depth_image(depth))
