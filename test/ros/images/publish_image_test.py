#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import os
import subprocess
import tempfile
import unittest

import numpy as np
import rospy
import rostest
from PIL import Image as Picture
from ros_probe import WAIT, Recorder, until
from sensor_msgs.msg import Image

ORIENTATION, TURNED = 0x0112, 6  # in EXIF: the camera was turned, what is left belongs up


class PublishImageTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def photo(self, name, grey, orientation=None):
        exif = Picture.Exif()
        if orientation:
            exif[ORIENTATION] = orientation
        pixels = np.full((30, 40, 3), grey, np.uint8)
        pixels[:, :8] = (255, 0, 0)
        Picture.fromarray(pixels).save(os.path.join(self.folder, name), exif=exif)

    def start(self, source, *args):
        command = ["rosrun", "sextant", "publish_image", "__name:=photos", "_source:=" + source, *args]
        node = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.addCleanup(self.stop, node)
        return node

    def stop(self, node):
        node.terminate()
        node.communicate(timeout=WAIT)
        if rospy.has_param("/photos"):
            rospy.delete_param("/photos")

    def test_photos_of_a_folder_come_in_natural_order_then_the_node_ends(self):
        for number in (10, 9, 2):
            self.photo(f"{number}.png", number)
        with open(os.path.join(self.folder, "3.jpg"), "w") as file:
            file.write("no photo")
        images = Recorder("image", Image)
        node = self.start(self.folder, "_rate:=10", "_keep_alive:=false", "_frame_id:=front")
        output, _ = node.communicate(timeout=WAIT)
        self.assertEqual(node.returncode, 0, output)
        self.assertIn("left out: " + os.path.join(self.folder, "3.jpg") + ": is not an image", output)
        received = sorted(images.all(), key=lambda each: each.header.stamp)
        self.assertEqual([each.data[-1] for each in received], [2, 9, 10])
        self.assertEqual({each.header.frame_id for each in received}, {"front"})
        stamps = [each.header.stamp.to_sec() for each in received]
        np.testing.assert_array_less(0.09, np.diff(stamps))
        images.close()

    def test_one_photo_is_there_for_whoever_comes_late_and_upright(self):
        self.photo("a.png", 7, TURNED)
        self.start(os.path.join(self.folder, "a.png"), "_wait_for_subscriber:=0.0")
        image = rospy.wait_for_message("image", Image, WAIT)
        self.assertEqual((image.encoding, image.width, image.height), ("rgb8", 30, 40))
        pixels = np.frombuffer(image.data, np.uint8).reshape(40, 30, 3)
        self.assertEqual(pixels[0, 0].tolist(), [255, 0, 0])
        self.assertEqual(pixels[0, 29].tolist(), [255, 0, 0])
        self.assertEqual(pixels[39, 15].tolist(), [7, 7, 7])

    def test_a_photo_in_a_loop_comes_again_and_again(self):
        self.photo("a.png", 7)
        images = Recorder("image", Image)
        self.start(os.path.join(self.folder, "a.png"), "_loop:=true", "_rate:=50")
        self.assertTrue(until(lambda: len(images.all()) >= 5))
        images.close()

    def test_where_there_is_no_photo_the_reason_is_printed(self):
        empty, damaged = os.path.join(self.folder, "empty"), os.path.join(self.folder, "damaged.jpg")
        os.mkdir(empty)
        with open(damaged, "wb") as file:
            file.write(b"\xff\xd8\xff")
        for source, reason in [
            (self.folder + "/lacking", "lacking: does not exist"),
            (empty, "empty: there is no photo"),
            (damaged, "damaged.jpg: no photo can be read"),
        ]:
            node = self.start(source, "_wait_for_subscriber:=0.0")
            output, _ = node.communicate(timeout=WAIT)
            self.assertEqual(node.returncode, 1, output)
            self.assertIn(reason, output)


if __name__ == "__main__":
    rospy.init_node("publish_image_test")
    rostest.rosrun("sextant", "publish_image", PublishImageTest)
