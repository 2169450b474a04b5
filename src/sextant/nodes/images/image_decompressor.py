# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Node image_decompressor: decompresses images on the machine that displays them.

rviz displays topics through image_transport, and Debian has no plugin for compressed images. Without a
subscriber, nothing is transmitted over the network.
"""

import cv2
import numpy as np
import rospy
from sensor_msgs.msg import CompressedImage, Image

from sextant.nodes.base.init_node import init_node


def decompress(message: CompressedImage) -> Image:
    """Decompresses JPEG or PNG to bgr8.

    :raises ValueError: the data is not an image
    """
    image = None
    if message.data:
        image = cv2.imdecode(np.frombuffer(message.data, np.uint8), cv2.IMREAD_COLOR)
    if image is None:
        raise ValueError("cannot be decompressed: " + (message.format or "no format given"))
    height, width = image.shape[:2]
    return Image(message.header, height, width, "bgr8", 0, 3 * width, image.tobytes())


class ImageDecompressor(rospy.SubscribeListener):
    """Subscribes to `compressed` while `~image` has a subscriber."""

    def __init__(self):
        self._subscriber = None
        self._publisher = rospy.Publisher("~image", Image, subscriber_listener=self, queue_size=1)

    def peer_subscribe(self, *_args) -> None:
        """Subscribes for the first subscriber."""
        if self._subscriber is None:
            self._subscriber = rospy.Subscriber(
                "compressed", CompressedImage, self._on_image, queue_size=1, buff_size=2**24
            )

    def peer_unsubscribe(self, _topic: str, count: int) -> None:
        """Unsubscribes after the last subscriber."""
        if count == 0 and self._subscriber is not None:
            self._subscriber.unregister()
            self._subscriber = None

    def _on_image(self, message: CompressedImage) -> None:
        try:
            self._publisher.publish(decompress(message))
        except ValueError as error:
            rospy.logwarn_throttle(10.0, "%s: %s", rospy.resolve_name("compressed"), error)


def main() -> None:
    """Runs the node."""
    init_node("image_decompressor")
    decompressor = ImageDecompressor()
    rospy.spin()
    del decompressor
