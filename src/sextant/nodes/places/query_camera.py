# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Camera of the images that are localized, by its camera_info."""

from typing import Optional

import numpy as np
import rospy
from sensor_msgs.msg import CameraInfo

import sextant
from sextant.messages.camera_messages import camera_from_info, same_calibration

WARN_EVERY = 10.0  # seconds


class QueryCamera:
    """Subscribes to `camera_info` in the namespace of the image, or where it is remapped to."""

    def __init__(self, image: str):
        topic = rospy.resolve_name(image)
        topic = topic[: -len("/compressed")] if topic.endswith("/compressed") else topic
        folder, _, name = topic.rpartition("/")
        own, remapped = f"{rospy.get_namespace()}camera_info", rospy.resolve_name("camera_info")
        self._rectified = name.startswith("image_rect")
        self._info: Optional[CameraInfo] = None
        self._model: Optional[sextant.CameraModel] = None
        self.topic = remapped if remapped != own else f"{folder}/camera_info"
        rospy.Subscriber(self.topic, CameraInfo, self._on_info, queue_size=1)

    def of(self, image: np.ndarray) -> Optional["sextant.CameraModel"]:
        """The camera of an image; None if it is not known, or not for the size of the image."""
        model = self._model
        if model is None or model.size == image.shape[1::-1]:
            return model
        size = f"{image.shape[1]} x {image.shape[0]}"
        text = "the calibration is not used: the image has %s pixels, %s is for %d x %d"
        rospy.logwarn_throttle(WARN_EVERY, text, size, self.topic, *model.size)
        return None

    def _on_info(self, info: CameraInfo) -> None:
        if self._info is not None and same_calibration(info, self._info):
            return
        self._info, self._model = info, None
        try:
            self._model = camera_from_info(info, self._rectified).model()
        except ValueError as error:
            rospy.logwarn_throttle(WARN_EVERY, "the calibration on %s is not used: %s", self.topic, error)
