#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import unittest

import numpy as np
import rospy
import rostest
from geometry_msgs.msg import PoseWithCovarianceStamped
from landmark_robot import planar, squared_distance
from nav_msgs.msg import Odometry
from ros_probe import Diagnostics, Recorder, TransformRecorder, matrix, until
from std_srvs.srv import Trigger
from visualization_msgs.msg import MarkerArray

from sextant.msg import LandmarkMapEntries

STATUS = "landmark_slam: slam"
PATIENCE = 60.0  # s of the wall's clock; 480 simulated


class LandmarksDemoTest(unittest.TestCase):
    """The launch file as it is, with odometry that measures too much."""

    @classmethod
    def setUpClass(cls):
        cls.truth, cls.tf = Recorder("ground_truth", Odometry), TransformRecorder()
        cls.poses = Recorder("pose", PoseWithCovarianceStamped)
        cls.filtered = Recorder("odometry/filtered", Odometry)
        cls.entries = Recorder("landmark_map/entries", LandmarkMapEntries)
        cls.diagnostics = Diagnostics()

    def last(self):
        """Pose and truth."""
        pose = max(self.poses.all(), key=lambda message: message.header.stamp)
        return pose, self.truth.at(pose.header.stamp)

    def is_near_the_truth(self):
        pose, truth = self.last()
        off = planar(pose.pose.pose)[:2] - planar(truth.pose.pose)[:2]
        return squared_distance(pose.pose, planar(truth.pose.pose)) < 20 and np.hypot(*off) < 1.0

    def landmarks(self):
        return max(self.entries.all(), key=lambda message: message.header.stamp).landmarks

    def test_the_world_is_mapped_and_the_robot_found_again(self):
        self.assertTrue(until(lambda: self.entries.all() and len(self.landmarks()) >= 15, PATIENCE))
        self.assertTrue(self.is_near_the_truth(), self.last())
        self.assert_map()
        self.assert_transform()
        self.assertTrue(until(lambda: abs(self.scale() - 1 / 1.08) < 0.03), self.scale())
        self.assert_found_again()

    def scale(self):
        """Of odometry, as it is estimated."""
        return float((self.diagnostics.row(STATUS, "scale of odometry") or "nan").split()[0])

    def assert_map(self):
        """No landmark is nearer to another one's truth."""
        (shape,) = rospy.wait_for_message("ground_truth/landmarks", MarkerArray, 15.0).markers
        points = np.array([[point.x, point.y] for point in shape.points])
        true = points.reshape(20, -1, 2).mean(axis=1)  # centres of circles
        found = np.array([[entry.x, entry.y] for entry in self.landmarks()])
        distances = np.linalg.norm(found[:, None] - true, axis=2)
        self.assertLess(distances.min(axis=1).max(), 0.5)
        self.assertEqual(len(set(distances.argmin(axis=1))), len(found))

    def assert_transform(self):
        published = self.filtered.all()[-1]
        stamp = published.header.stamp
        T_map_base = self.tf.at("map", "odom", stamp) @ self.tf.at("odom", "base_link", stamp)
        np.testing.assert_allclose(T_map_base, matrix(published.pose.pose), atol=1e-9)

    def assert_found_again(self):
        for service in ("landmark_simulator/kidnap", "landmark_slam/relocalize"):
            answer = rospy.ServiceProxy(service, Trigger)()
            self.assertTrue(answer.success, answer.message)
        self.poses.forget()
        self.assertTrue(until(lambda: self.poses.all(), PATIENCE), self.diagnostics.summary(STATUS))
        self.assertTrue(until(self.is_near_the_truth))
        self.assert_map()


if __name__ == "__main__":
    rospy.init_node("landmarks_demo_test")
    rostest.rosrun("sextant", "landmarks_demo", LandmarksDemoTest)
