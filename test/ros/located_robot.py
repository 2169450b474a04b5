# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Robots whose locators a test publishes to: each has a namespace, and its letter ends their frames."""

import unittest

import rospy
import tf2_ros
from geometry_msgs.msg import Point, Pose, PoseWithCovariance, PoseWithCovarianceStamped, Quaternion
from marker_chain import deviation
from marker_scene import FAMILY, SIZE, T_BASE_CAMERA, T_MAP_BASE, pose, turned
from ros_probe import (
    Diagnostics,
    Recorder,
    TransformRecorder,
    matrix,
    quaternion,
    stamps,
    subscribers_of,
    transform,
    until,
)

from sextant.msg import MarkerArray, MarkerMapEntries, MarkerMapEntry

EXACT = 1e-5  # m and rad: the corners are exact
T_ODOM_BASE = pose(turned(-0.7), [4.0, 5.0, 0.0])


class LocatedRobotTest(unittest.TestCase):
    MOUNTS = ()  # (base, camera) frames of all robots

    @classmethod
    def setUpClass(cls):
        cls.stamps = stamps()
        cls.diagnostics = Diagnostics()
        cls.transforms = TransformRecorder()
        cls.fixed = tf2_ros.StaticTransformBroadcaster()
        now = rospy.Time.now()
        cls.fixed.sendTransform([transform(T_BASE_CAMERA, *frames, now) for frames in cls.MOUNTS])
        cls.moving = tf2_ros.TransformBroadcaster()

    def connect(self, robot, *topics):
        """Subscribes to its poses; returns the publishers of markers on each topic. All are connected."""
        self.poses = Recorder(f"/{robot}/pose", PoseWithCovarianceStamped)
        self.addCleanup(self.poses.close)
        self.assertTrue(self.poses.connected())
        publishers = [rospy.Publisher(f"/{robot}/{topic}", MarkerArray, queue_size=10) for topic in topics]
        for publisher in publishers:
            self.addCleanup(publisher.unregister)
            self.assertTrue(until(lambda: publisher.get_num_connections() > 0))  # noqa: B023
        for tf, topic in ((self.moving, "/tf"), (self.fixed, "/tf_static")):
            self.assertTrue(
                until(lambda: tf.pub_tf.get_num_connections() >= len(subscribers_of(topic))),  # noqa: B023
                f"not all of {subscribers_of(topic)} are connected to {topic}",
            )
        return publishers

    def map_of(self, robot):
        """The publisher of the robot's map."""
        maps = rospy.Publisher(f"/{robot}/marker_map/entries", MarkerMapEntries, queue_size=1, latch=True)
        self.addCleanup(maps.unregister)
        return maps

    def drive(self, stamp, robot, T_odom_base=T_ODOM_BASE):
        """Odometry of one instant."""
        self.moving.sendTransform(transform(T_odom_base, f"odom_{robot}", f"base_{robot}", stamp))

    def assert_pose(self, T, truth, tolerance=EXACT):
        self.assertIsNotNone(T)
        self.assertLess(max(deviation(T, truth)), tolerance)

    def assert_located(self, stamp, truth=T_MAP_BASE):
        msg = self.poses.at(stamp)
        self.assertIsNotNone(msg, "no pose")
        self.assertEqual(msg.header.frame_id, "map")
        self.assert_pose(matrix(msg.pose.pose), truth)


def map_msg(places):
    """A map of markers: T_map_marker by id."""
    msg = MarkerMapEntries()
    msg.header.frame_id = "map"
    for id, T in places.items():
        place = Pose(Point(*T[:3, 3]), Quaternion(*quaternion(T[:3, :3])))
        msg.markers.append(MarkerMapEntry(FAMILY, id, SIZE, "", PoseWithCovariance(pose=place)))
    return msg
