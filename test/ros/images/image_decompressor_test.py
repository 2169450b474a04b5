#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import time
import unittest

import cv2
import numpy as np
import rospy
import rostest
from sensor_msgs.msg import CompressedImage, Image
from std_msgs.msg import Header


class ImageDecompressorTest(unittest.TestCase):
    def setUp(self):
        self.publisher = rospy.Publisher("compressed", CompressedImage, queue_size=10)
        self.received = []

    def wait_for(self, condition):
        end = time.monotonic() + 15
        while not condition() and time.monotonic() < end:
            time.sleep(0.05)
        self.assertTrue(condition())

    def publish(self, data):
        self.publisher.publish(
            CompressedImage(Header(stamp=rospy.Time(7, 8), frame_id="camera"), "png", data)
        )

    def test_images_are_received_only_while_there_is_a_subscriber(self):
        self.assertEqual(self.publisher.get_num_connections(), 0)
        subscriber = rospy.Subscriber("decompressor/image", Image, self.received.append)
        self.wait_for(lambda: self.publisher.get_num_connections() == 1)
        picture = np.random.default_rng(1).integers(0, 255, (3, 5, 3), dtype=np.uint8)
        png = cv2.imencode(".png", picture)[1].tobytes()
        for data in (b"", b"no picture", png[:20], png):  # what is no picture does not stop the next one
            self.publish(data)
        self.wait_for(lambda: self.received)
        image = self.received[0]
        self.assertEqual((image.header.stamp, image.header.frame_id), (rospy.Time(7, 8), "camera"))
        self.assertEqual((image.width, image.height, image.encoding, image.step), (5, 3, "bgr8", 15))
        self.assertEqual(image.data, picture.tobytes())
        subscriber.unregister()
        self.wait_for(lambda: self.publisher.get_num_connections() == 0)


if __name__ == "__main__":
    rospy.init_node("image_decompressor_test")
    rostest.rosrun("sextant", "image_decompressor", ImageDecompressorTest)
