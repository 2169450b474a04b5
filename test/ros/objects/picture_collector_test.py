#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import json
import signal
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import cv2
import rospy
import rostest
from made_photos import picture
from ros_probe import stamps, until
from sensor_msgs.msg import Image
from std_msgs.msg import Header

from sextant.messages.image_messages import image_to_message

STAMP = stamps()
NODE = [sys.executable, "-c", "from sextant.nodes.objects.picture_collector import main; main()"]


class PictureCollectorTest(unittest.TestCase):
    def test_pictures_of_a_topic_until_the_node_ends(self):
        """A damaged image, one picture twice, and others."""
        publisher = rospy.Publisher("image", Image, queue_size=10)
        with tempfile.TemporaryDirectory() as name:
            node = subprocess.Popen([*NODE, f"_folder:={name}/hall", "__name:=picture_collector"])
            try:
                self.assertTrue(until(lambda: publisher.get_num_connections() > 0))
                publisher.publish(Image(Header(stamp=next(STAMP)), 48, 64, "rgb8", 0, 192, b"cut"))
                for number in (0, 1, 1, 2):
                    image = cv2.merge([picture(number, (64, 48))] * 3)
                    publisher.publish(image_to_message(image, Header(stamp=next(STAMP), frame_id="camera")))
                    rospy.sleep(0.4)
                folder = Path(name) / "hall"
                self.assertTrue(until(lambda: len(list(folder.glob("*.jpg"))) == 3))
                node.send_signal(signal.SIGINT)
                self.assertEqual(node.wait(timeout=15), 0)
            finally:
                node.kill()
            counts = json.loads((folder / "collected.json").read_text())
        self.assertEqual(counts, {"kept": 3, "like another one": 1})


if __name__ == "__main__":
    rospy.init_node("picture_collector_test")
    rostest.rosrun("sextant", "picture_collector_test", PictureCollectorTest)
