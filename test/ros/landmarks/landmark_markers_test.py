#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot that stands before the markers of a map, and does not know where it is until it sees them."""

import unittest

import numpy as np
import rospy
import rostest
from geometry_msgs.msg import Point, Pose, PoseWithCovariance, PoseWithCovarianceStamped, Quaternion
from landmark_robot import odometry_msg, planar
from located_robot import map_msg
from marker_chain import deviation, publish_mount
from marker_scene import SIZE, T_CAMERA_MARKER, T_MAP_BASE, T_MAP_MARKER, marker_msg, markers_msg
from nav_msgs.msg import Odometry
from ros_probe import Diagnostics, Recorder, TransformRecorder, matrix, quaternion, stamps, until

from sextant.msg import LandmarkMapEntries, MarkerArray, MarkerMapEntries

SLAM = "slam: slam"
TOLERANCE = 0.02  # m and rad; the published poses are exact, their standard deviations 0.02
ODOMETRY = np.array([4.0, 5.0, -0.7])


def seen_msg(id, **fields):
    """A marker with its true pose."""
    T = T_CAMERA_MARKER[id]
    msg = marker_msg(id)
    place = Pose(Point(*T[:3, 3]), Quaternion(*quaternion(T[:3, :3])))
    msg.pose = PoseWithCovariance(place, (0.0004 * np.eye(6)).ravel().tolist())
    msg.size, msg.reprojection_error, msg.alternative_reprojection_error = SIZE, 0.1, 1.0
    for name, value in fields.items():
        setattr(msg, name, value)
    return msg


class LandmarkMarkersTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.stamps = stamps()
        cls.mount = publish_mount()
        cls.diagnostics = Diagnostics()
        cls.transforms = TransformRecorder()
        cls.poses = Recorder("pose", PoseWithCovarianceStamped)
        cls.entries = Recorder("landmark_map/entries", LandmarkMapEntries)
        cls.odometry = rospy.Publisher("odom", Odometry, queue_size=100)
        cls.markers = rospy.Publisher("markers", MarkerArray, queue_size=100)
        cls.maps = rospy.Publisher("marker_map/entries", MarkerMapEntries, queue_size=1, latch=True)

    def show(self, markers):
        """Odometry and what the camera sees of one moment."""
        stamp = next(self.stamps)
        msg = odometry_msg(stamp, ODOMETRY, "link")
        msg.header.frame_id, msg.child_frame_id = "odom", "base_link"
        self.odometry.publish(msg)
        self.markers.publish(markers_msg(stamp, markers))
        return stamp

    def locate(self):
        def answered():
            self.answered = self.show([seen_msg(3), seen_msg(5)])
            return self.poses.at(self.answered, 0.2) is not None

        self.assertTrue(until(answered), self.diagnostics.summary(SLAM))
        return self.answered

    def test_the_place_is_found_in_a_map_of_markers(self):
        for publisher in (self.odometry, self.markers):
            self.assertTrue(until(lambda: publisher.get_num_connections() > 0))  # noqa: B023
        self.maps.publish(map_msg(T_MAP_MARKER))
        self.assertTrue(until(lambda: any(len(msg.landmarks) == 2 for msg in self.entries.all())))
        self.assertTrue(until(lambda: "lost" in self.diagnostics.summary(SLAM) or self.show([])))
        self.locate()
        for _ in range(20):
            stamp = self.show([seen_msg(3), seen_msg(5)])
            self.assertIsNotNone(self.poses.at(stamp))
        T = matrix(self.poses.at(stamp).pose.pose)
        self.assertLess(max(deviation(T, T_MAP_BASE)), TOLERANCE)
        transform = self.transforms.at("map", "base_link", stamp)
        np.testing.assert_allclose(
            transform, T, atol=1e-3
        )  # published with odometry, before the observations
        self.assert_places_are_true()
        self.assert_without_a_size()

    def assert_places_are_true(self):
        """They are exact, and so stay where they are."""
        newest = max(self.entries.all(), key=lambda msg: msg.header.stamp)
        for entry in newest.landmarks:
            T = T_MAP_MARKER[entry.id]
            self.assertEqual(entry.class_name, "tag36h11")
            np.testing.assert_allclose([entry.x, entry.y], T[:2, 3], atol=1e-3)
            self.assertAlmostEqual(abs(entry.heading), np.pi, 2)  # out of the wall x = 3 m

    def assert_without_a_size(self):
        stamp = self.show([seen_msg(3, size=0.0), seen_msg(5)])
        self.assertIsNotNone(self.poses.at(stamp))
        self.assertTrue(self.diagnostics.reaches(SLAM, "not used: marker without a size", 1))
        heading = planar(self.poses.at(stamp).pose.pose)[2]
        self.assertAlmostEqual(heading, np.arctan2(T_MAP_BASE[1, 0], T_MAP_BASE[0, 0]), 1)


if __name__ == "__main__":
    rospy.init_node("landmark_markers_test")
    rostest.rosrun("sextant", "landmark_markers", LandmarkMarkersTest)
