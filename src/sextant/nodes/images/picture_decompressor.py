# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Turns compressed pictures into raw ones on the machine that looks at them.

rviz shows only what image_transport has a plugin for, and Debian has none for compressed images. While nobody
looks, nothing crosses the network.
"""

import cv2
import numpy as np
import rospy
from sensor_msgs.msg import CompressedImage, Image


def decompress(message: CompressedImage) -> Image:
    """sensor_msgs/Image (bgr8) of a JPEG or PNG.

    :raises ValueError: the data is no picture
    """
    picture = None
    if message.data:
        picture = cv2.imdecode(np.frombuffer(message.data, np.uint8), cv2.IMREAD_COLOR)
    if picture is None:
        raise ValueError("cannot be decompressed: " + (message.format or "no format given"))
    height, width = picture.shape[:2]
    return Image(message.header, height, width, "bgr8", 0, 3 * width, picture.tobytes())


class PictureDecompressor(rospy.SubscribeListener):
    """Hears `compressed` while somebody hears `~image`."""

    def __init__(self):
        self._subscriber = None
        self._publisher = rospy.Publisher("~image", Image, subscriber_listener=self, queue_size=1)

    def peer_subscribe(self, *_args) -> None:
        if self._subscriber is None:
            self._subscriber = rospy.Subscriber(
                "compressed", CompressedImage, self._on_picture, queue_size=1, buff_size=2**24
            )

    def peer_unsubscribe(self, _topic: str, count: int) -> None:
        if count == 0 and self._subscriber is not None:
            self._subscriber.unregister()
            self._subscriber = None

    def _on_picture(self, message: CompressedImage) -> None:
        try:
            self._publisher.publish(decompress(message))
        except ValueError as error:
            rospy.logwarn_throttle(10.0, "%s: %s", rospy.resolve_name("compressed"), error)


def main() -> None:
    rospy.init_node("picture_decompressor")
    decompressor = PictureDecompressor()
    rospy.spin()
    del decompressor
