#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import subprocess

import numpy as np
import rospy
import rostest
from geometry_msgs.msg import PoseWithCovarianceStamped
from launched_demo import DemoTest
from nav_msgs.msg import Odometry
from ros_probe import Recorder, until
from sensor_msgs.msg import Image
from std_srvs.srv import Trigger

from sextant.place_maps.place_map_file import read_place_map

PATIENCE = 120.0  # seconds, from nothing to the first pose
SPACING = 6.0  # metres


class PlacesDemoTest(DemoTest):
    LAUNCH = "places_demo.launch"
    ARGS = {
        "season": "[autumn]",
        "spacing": SPACING,
        "parts": 5,
        "width": 320,
        "height": 240,
        "rate": 5.0,
        "speed": 10.0,
        "seed": 2,
    }

    @classmethod
    def setUpClass(cls):
        cls.truth, cls.poses = Recorder("ground_truth", Odometry), Recorder("pose", PoseWithCovarianceStamped)
        super().setUpClass()

    def errors(self, count):
        """Metres from the truth, of so many further poses."""
        self.poses.forget()
        self.assertTrue(until(lambda: len(self.poses.all()) >= count, PATIENCE), "there is no pose")
        stamps = sorted(pose.header.stamp for pose in self.poses.all())
        return np.array([self.error(stamp) for stamp in stamps])

    def error(self, stamp):
        estimate, true = self.poses.at(stamp), self.truth.at(stamp)
        self.assertEqual(estimate.header.frame_id, true.header.frame_id)
        estimate, true = estimate.pose.pose.position, true.pose.pose.position
        return np.hypot(estimate.x - true.x, estimate.y - true.y)

    def test_the_walker_is_followed_and_found_again_after_it_was_carried_away(self):
        self.assertLess(np.median(self.errors(12)), SPACING, self.log.read_text())
        self.assertLess(self.errors(12).max(), 2 * SPACING)
        answer = rospy.ServiceProxy("street_simulator/kidnap", Trigger)()
        self.assertTrue(answer.success, answer.message)
        self.assertTrue(until(lambda: self.errors(5).max() < 2 * SPACING, PATIENCE))
        self.check_maps()
        for topic in ("places/image", "clusters/image", "matches/image"):
            picture = rospy.wait_for_message(topic, Image, PATIENCE)
            self.assertEqual(picture.encoding, "rgb8")

    def check_maps(self):
        """Both have the same photos, one has exact positions and the other parts of the walk."""
        exact, clusters = (read_place_map(self.folder / name) for name in ("map.txt", "clusters.txt"))
        self.assertEqual([each[:2] for each in exact.photos], [each[:2] for each in clusters.photos])
        self.assertEqual(len(exact.places()), len(exact.photos))
        self.assertEqual(len(clusters.places()), self.ARGS["parts"])

    def test_a_season_that_is_none_stops_the_simulator(self):
        command = ["rosrun", "sextant", "street_simulator", "__name:=refused", "_seasons:=[spring]"]
        ended = subprocess.run(
            command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=PATIENCE
        )
        self.assertEqual(ended.returncode, 1, ended.stdout)
        self.assertIn("seasons: each must be one of summer, evening, autumn", ended.stdout)


if __name__ == "__main__":
    rospy.init_node("places_demo_test")
    rostest.rosrun("sextant", "places_demo", PlacesDemoTest)
