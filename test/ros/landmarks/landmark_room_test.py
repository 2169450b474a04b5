#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Odometry and markers of a known map, fused for a whole round."""

import unittest

import numpy as np
import rospy
import rostest
from landmark_robot import planar
from nav_msgs.msg import Odometry
from ros_probe import Diagnostics, Recorder, TransformRecorder, matrix, until

STATUS = "landmark_slam: slam"
ROUND = 12.0  # s, as in the .test file
TOLERANCE = 0.15  # m and rad; mostly 0.01
GAP = 0.5  # s: a busy machine drops single messages, a lost robot many in a row


class LandmarkRoomTest(unittest.TestCase):
    def test_the_robot_is_found_and_never_lost(self):
        diagnostics, tf = Diagnostics(), TransformRecorder()
        truth, filtered = Recorder("ground_truth", Odometry), Recorder("odometry/filtered", Odometry)
        self.assertTrue(until(lambda: filtered.all(), 60), diagnostics.summary(STATUS))
        found = min(message.header.stamp for message in filtered.all())
        end = found + rospy.Duration(ROUND + 1)
        self.assertTrue(until(lambda: max(message.header.stamp for message in truth.all()) > end, 60))
        stamps = [at for at in (each.header.stamp for each in truth.all()) if found <= at <= end]
        self.assertGreater(len(stamps), 300)
        last = found
        for at in stamps:
            message = filtered.at(at, 0.1)
            if message is None:
                self.assertLess((at - last).to_sec(), GAP, f"lost {(last - found).to_sec():.1f} s later")
                continue
            last, published = at, message
            off = planar(published.pose.pose) - planar(truth.at(at).pose.pose)
            self.assertLess(np.hypot(*off[:2]), TOLERANCE)
            self.assertLess(abs(np.sin(off[2])), TOLERANCE)
        self.assertTrue(diagnostics.reaches(STATUS, "landmarks", 8))
        self.assertEqual(diagnostics.count(STATUS, "landmarks removed"), 0)
        T_map_base = tf.at("map", "odom", last) @ tf.at("odom", "base_link", last)
        np.testing.assert_allclose(T_map_base[:2, 3], matrix(published.pose.pose)[:2, 3], atol=1e-6)


if __name__ == "__main__":
    rospy.init_node("landmark_room_test")
    rostest.rosrun("sextant", "landmark_room", LandmarkRoomTest)
