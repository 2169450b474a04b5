#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import unittest

import numpy as np
import rospy
import rostest
import tf2_ros
from geometry_msgs.msg import Point, Pose, PoseWithCovariance, PoseWithCovarianceStamped, Quaternion
from marker_chain import deviation
from marker_scene import (
    FAMILY,
    SIZE,
    T_BASE_CAMERA,
    T_MAP_BASE,
    T_MAP_CAMERA,
    T_MAP_MARKER,
    markers_msg,
    pose,
    turned,
)
from ros_probe import Diagnostics, Recorder, TransformRecorder, matrix, quaternion, stamps, transform, until
from visualization_msgs.msg import Marker as Shape
from visualization_msgs.msg import MarkerArray as Shapes

from sextant.msg import MarkerArray, MarkerMapEntries, MarkerMapEntry

EXACT = 1e-5  # m and rad: the corners are exact
T_ODOM_BASE = pose(turned(-0.7), [4.0, 5.0, 0.0])


class MarkerLocatorTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.stamps = stamps()
        cls.diagnostics = Diagnostics()
        cls.heard_tf = TransformRecorder()
        cls.fixed = tf2_ros.StaticTransformBroadcaster()
        mounts = [
            transform(T_BASE_CAMERA, f"base_{robot}", f"camera_{robot}", rospy.Time.now()) for robot in "bcd"
        ]
        cls.fixed.sendTransform(mounts)
        cls.moving = tf2_ros.TransformBroadcaster()

    def robot(self, name):
        """Its poses, and what tells its markers: both connected."""
        self.name = name
        self.poses = Recorder(f"/{name}/pose", PoseWithCovarianceStamped)
        self.addCleanup(self.poses.close)
        self.markers = rospy.Publisher(f"/{name}/markers", MarkerArray, queue_size=10)
        self.addCleanup(self.markers.unregister)
        self.assertTrue(self.poses.connected())
        self.assertTrue(until(lambda: self.markers.get_num_connections() > 0))

    def show(self, stamp=None):
        stamp = next(self.stamps) if stamp is None else stamp
        self.markers.publish(markers_msg(stamp, frame=f"camera_{self.name}"))
        return stamp

    def locate(self, stamp=None):
        """Stamp of the first pose: mounts may not have come yet."""

        def answered():
            self.answered = self.show(stamp)
            return self.poses.at(self.answered, 0.3) is not None

        self.assertTrue(until(answered), "no pose")
        return self.answered

    def assert_pose(self, T, truth):
        self.assertIsNotNone(T)
        self.assertLess(max(deviation(T, truth)), EXACT)

    def assert_located(self, stamp, truth=T_MAP_BASE):
        msg = self.poses.at(stamp)
        self.assertIsNotNone(msg, "no pose")
        self.assertEqual(msg.header.frame_id, "map")
        self.assert_pose(matrix(msg.pose.pose), truth)

    def drive(self, stamp, robot="d"):
        """Odometry of one instant."""
        self.moving.sendTransform(transform(T_ODOM_BASE, f"odom_{robot}", f"base_{robot}", stamp))

    def test_pose_of_the_camera_with_a_covariance(self):
        self.robot("a")
        stamp = self.locate()
        self.assert_located(stamp, T_MAP_CAMERA)
        covariance = np.reshape(self.poses.at(stamp).pose.covariance, (6, 6))
        np.testing.assert_allclose(covariance, covariance.T, rtol=1e-9)
        self.assertTrue(np.all(np.linalg.eigvalsh(covariance) > 0))
        self.assertLess(np.sqrt(covariance[0, 0]), 0.1)

    def test_map_to_base(self):
        self.robot("b")
        stamp = self.locate()
        self.assert_located(stamp)
        self.assert_pose(self.heard_tf.at("map", "base_b", stamp), T_MAP_BASE)

    def test_a_base_that_has_a_parent_is_not_taken_from_it(self):
        self.robot("c")
        first = next(self.stamps)
        for lag in [0.0, 0.1, 0.2]:  # odometry comes after the image, so that at its stamp there is none yet
            self.drive(first - rospy.Duration(lag + 0.1), "c")
        self.assertTrue(
            until(lambda: self.heard_tf.at("odom_c", "base_c", first - rospy.Duration(0.1), 0.1) is not None)
        )
        for _ in range(3):
            self.assert_located(self.locate())
        self.assertTrue(self.diagnostics.reaches("c/locator: localization", "not used: tf", 3))
        self.assertFalse([key for key in self.heard_tf.seen if key[:2] == ("map", "base_c")])

    def test_map_to_odom_waits_for_odometry_and_never_uses_an_old_one(self):
        self.robot("d")
        self.drive(next(self.stamps))
        stamp = self.show()
        self.assertIsNone(self.poses.at(stamp, 0.2))
        self.drive(stamp)
        self.assert_located(stamp)
        self.assert_pose(self.heard_tf.at("map", "odom_d", stamp), T_MAP_BASE @ np.linalg.inv(T_ODOM_BASE))
        without = self.show()
        self.assertIsNone(self.poses.at(without, 1.2))
        self.drive(without + rospy.Duration(0.005))
        self.assertTrue(self.diagnostics.reaches("d/locator: localization", "not used: transform", 1))
        self.assertFalse(self.poses.has(without))
        self.assertFalse([key for key in self.heard_tf.seen if key[1:] == ("odom_d", without)])

    def test_odometry_that_lags_by_more_than_an_image(self):
        self.robot("d")
        shown = []
        for _ in range(8):
            shown.append(self.show())
            rospy.sleep(1 / 30)
            if len(shown) > 2:
                self.drive(shown[-3])
        for stamp in shown[1:-2]:
            self.assert_located(stamp)

    def test_a_recording_that_is_played_twice(self):
        self.robot("d")
        played = [rospy.Time(second) for second in range(1000, 1015)]  # longer than what tf keeps
        for _ in range(2):
            self.poses.forget()
            for stamp in played:
                self.drive(stamp)
                self.show(stamp)
                self.poses.at(stamp, 0.3)
            located = [stamp for stamp in played if self.poses.has(stamp)]
            self.assertGreaterEqual(len(located), len(played) - 2)  # what comes with the jump may be lost
            for stamp in located:
                self.assert_located(stamp)

    def test_a_map_that_comes_while_running(self):
        self.robot("e")
        self.fixed.sendTransform(transform(T_BASE_CAMERA, "base_e", "camera_e", rospy.Time.now()))
        status = "e/locator: localization"
        self.assertTrue(until(lambda: self.diagnostics.summary(status) == "no marker map yet"))
        self.assertIsNone(self.poses.at(self.show(), 0.2))
        maps = rospy.Publisher("/e/marker_map/entries", MarkerMapEntries, queue_size=1, latch=True)
        self.addCleanup(maps.unregister)
        for shift in [0.0, 1.0]:
            T_moved = pose(np.eye(3), [0, 0, shift])
            maps.publish(map_msg(T_moved))

            def moved(T_moved=T_moved):
                stamp = self.locate()
                return max(deviation(matrix(self.poses.at(stamp).pose.pose), T_moved @ T_MAP_BASE)) < EXACT

            self.assertTrue(until(moved))

    def test_lines_of_sight_for_rviz(self):
        self.robot("b")
        shapes = []
        listener = rospy.Subscriber("/b/visualization", Shapes, lambda msg: shapes.append(msg.markers))
        self.addCleanup(listener.unregister)
        self.assertTrue(until(lambda: listener.get_num_connections() > 0))
        self.assertTrue(until(lambda: self.locate() and shapes))
        lines = next(shape for shape in shapes[-1] if shape.type == Shape.LINE_LIST)
        points = [(p.x, p.y, p.z) for p in lines.points]
        camera = T_MAP_CAMERA[:3, 3]
        np.testing.assert_allclose(points, [camera, [3, 0.5, 1.0], camera, [3, -0.4, 1.3]], atol=1e-4)


def map_msg(T_moved):
    """The scene's map with every marker moved."""
    msg = MarkerMapEntries()
    msg.header.frame_id = "map"
    for id, T_map_marker in T_MAP_MARKER.items():
        T = T_moved @ T_map_marker
        place = Pose(Point(*T[:3, 3]), Quaternion(*quaternion(T[:3, :3])))
        msg.markers.append(MarkerMapEntry(FAMILY, id, SIZE, "", PoseWithCovariance(pose=place)))
    return msg


if __name__ == "__main__":
    rospy.init_node("marker_locator_test")
    rostest.rosrun("sextant", "marker_locator", MarkerLocatorTest)
