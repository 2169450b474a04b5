# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The object locator for a colour and a depth camera, configured by camera_info and tf."""

from typing import Any, Optional, Tuple

import numpy as np
from sensor_msgs.msg import CameraInfo

import sextant
from sextant.nodes.objects.camera_geometry import CameraGeometry, same_pose
from sextant.objects.object_locator import ObjectLocator, ObjectLocatorParams

COLOUR, DEPTH = "camera_info", "depth/camera_info"


class RgbdLocator:
    """Creates a new ObjectLocator when a calibration or the transform between the cameras changes."""

    def __init__(self, params: ObjectLocatorParams, base_frame: str):
        self._params, self._base_frame = params, base_frame
        self._geometry = CameraGeometry()
        self._locator: Optional[ObjectLocator] = None
        self._made_for: Tuple[sextant.CameraModel, ...] = ()
        self._T_colour_depth = np.eye(4)

    def set_info(self, topic: str, info: CameraInfo) -> None:
        """Store a calibration. :param topic: COLOUR or DEPTH"""
        self._geometry.set_info(topic, info)

    @property
    def colour(self) -> "sextant.CameraModel":
        """Model of the colour camera. :raises ValueError: no calibration, or an invalid one"""
        return self._geometry.camera(COLOUR)

    def at(self, colour: Any, depth: Any) -> Tuple[ObjectLocator, np.ndarray]:
        """The locator and T_base_colour (4, 4).

        :param colour: header of the colour image. :param depth: header of the depth image
        :raises ValueError: names the missing calibration or the frames without a transform
        """
        T_base_colour = self._geometry.transform(self._base_frame, colour.frame_id, colour.stamp)
        T_colour_depth = self._geometry.transform(colour.frame_id, depth.frame_id, colour.stamp)
        cameras = self.colour, self._geometry.camera(DEPTH)
        is_same = cameras == self._made_for and same_pose(T_colour_depth, self._T_colour_depth)
        if self._locator is None or not is_same:
            self._locator = ObjectLocator(self._params, *cameras, T_colour_depth)
            self._made_for, self._T_colour_depth = cameras, T_colour_depth
        return self._locator, T_base_colour
