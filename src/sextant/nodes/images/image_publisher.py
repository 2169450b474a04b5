# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Publishes images raw and compressed."""

from typing import Callable

import cv2
import numpy as np
import rospy
from sensor_msgs.msg import CompressedImage, Image
from std_msgs.msg import Header

from sextant.messages.image_messages import image_to_message

JPEG_QUALITY = 80


class ImagePublisher(rospy.SubscribeListener):
    """Publishes TOPIC and, as JPEG, TOPIC/compressed; each only for its subscribers."""

    def __init__(self, topic: str, latch: bool = False, on_subscriber: Callable[[], None] = lambda: None):
        """:param on_subscriber: called for each new subscriber"""
        self._on_subscriber = on_subscriber
        options = {"subscriber_listener": self, "queue_size": 1, "latch": latch}
        self._raw = rospy.Publisher(topic, Image, **options)
        self._jpeg = rospy.Publisher(topic + "/compressed", CompressedImage, **options)

    def peer_subscribe(self, *_args) -> None:
        """Called by rospy."""
        self._on_subscriber()

    def get_num_connections(self) -> int:
        """The number of subscribers; as of rospy.Publisher."""
        return self._raw.get_num_connections() + self._jpeg.get_num_connections()

    def publish(self, image: np.ndarray, header: Header) -> None:
        """Publishes an image: uint8 (height, width) or (height, width, 3), RGB."""
        if self._raw.get_num_connections():
            self._raw.publish(image_to_message(image, header))
        if self._jpeg.get_num_connections():
            bgr = image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_RGB2BGR)
            _, data = cv2.imencode(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
            self._jpeg.publish(CompressedImage(header, "jpeg", data.tobytes()))
