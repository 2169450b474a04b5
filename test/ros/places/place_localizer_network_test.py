#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import subprocess
import tempfile
import unittest
from pathlib import Path

import rospy
import rostest
from made_network import root_network
from made_photos import picture, shifted, written_photos
from ros_probe import WAIT, Diagnostics, Recorder, stamps, until
from sensor_msgs.msg import Image
from std_msgs.msg import Header

from sextant.msg import Places

DIAGNOSTICS = "place_localizer: places"


class PlaceLocalizerNetworkTest(unittest.TestCase):
    """With a network that makes no number of dark pictures."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        written_photos(self.folder, 4)
        given = {
            "map_file": self.folder / "park.txt",
            "mode": "single",
            "network": root_network(self.folder / "net.onnx"),
            "network_mean": "[0.25, 0.25, 0.25]",
        }
        log = open(self.folder / "log", "w")  # noqa: SIM115
        self.addCleanup(log.close)
        arguments = [f"_{name}:={value}" for name, value in given.items()]
        node = subprocess.Popen(["rosrun", "sextant", "place_localizer", *arguments], stdout=log, stderr=log)
        self.addCleanup(node.wait, WAIT)
        self.addCleanup(node.terminate)
        self.images = rospy.Publisher("image", Image, queue_size=10)
        self.stamps, self.diagnostics = stamps(), Diagnostics()
        self.places = Recorder("places", Places)

    def show(self, pixels):
        header, (rows, columns) = Header(stamp=next(self.stamps)), pixels.shape
        self.images.publish(Image(header, rows, columns, "mono8", 0, columns, pixels.tobytes()))
        return header.stamp

    def test_a_picture_that_the_network_makes_nothing_of_is_left_out(self):
        self.assertTrue(until(lambda: self.images.get_num_connections() == 1, WAIT))
        self.assertTrue(self.places.connected())
        self.assertEqual(self.places.at(self.show(shifted(picture(2), 6, 2))).poses[0], 2)
        dark = self.show(picture(2) // 5)
        # a picture that follows at once could take its place
        self.assertTrue(self.diagnostics.reaches(DIAGNOSTICS, "damaged images", 1))
        self.assertEqual(self.places.at(self.show(shifted(picture(3), 6, 2))).poses[0], 3)
        self.assertFalse(self.places.has(dark))
        log = (self.folder / "log").read_text()
        self.assertRegex(log, "image on /image is skipped: .*net.onnx: its output is not finite")
        self.assertNotIn("Traceback", log)


if __name__ == "__main__":
    rospy.init_node("place_localizer_network_test")
    rostest.rosrun("sextant", "place_localizer_network", PlaceLocalizerNetworkTest)
