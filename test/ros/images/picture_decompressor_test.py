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


class PictureDecompressorTest(unittest.TestCase):
    def setUp(self):
        self.publisher = rospy.Publisher("compressed", CompressedImage, queue_size=10)
        self.heard = []

    def wait_for(self, condition):
        end = time.monotonic() + 15
        while not condition() and time.monotonic() < end:
            time.sleep(0.05)
        self.assertTrue(condition())

    def say(self, data):
        self.publisher.publish(
            CompressedImage(Header(stamp=rospy.Time(7, 8), frame_id="camera"), "png", data)
        )

    def test_pictures_are_heard_only_while_somebody_looks(self):
        self.assertEqual(self.publisher.get_num_connections(), 0)
        subscriber = rospy.Subscriber("decompressor/image", Image, self.heard.append)
        self.wait_for(lambda: self.publisher.get_num_connections() == 1)
        picture = np.random.default_rng(1).integers(0, 255, (3, 5, 3), dtype=np.uint8)
        png = cv2.imencode(".png", picture)[1].tobytes()
        for data in (b"", b"no picture", png[:20], png):  # what is no picture does not stop the next one
            self.say(data)
        self.wait_for(lambda: self.heard)
        image = self.heard[0]
        self.assertEqual((image.header.stamp, image.header.frame_id), (rospy.Time(7, 8), "camera"))
        self.assertEqual((image.width, image.height, image.encoding, image.step), (5, 3, "bgr8", 15))
        self.assertEqual(image.data, picture.tobytes())
        subscriber.unregister()
        self.wait_for(lambda: self.publisher.get_num_connections() == 0)


if __name__ == "__main__":
    rospy.init_node("picture_decompressor_test")
    rostest.rosrun("sextant", "picture_decompressor", PictureDecompressorTest)
