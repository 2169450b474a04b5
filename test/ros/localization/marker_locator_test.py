#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import rospy
import rostest
from located_robot import EXACT, T_ODOM_BASE, LocatedRobotTest, map_msg
from marker_chain import deviation
from marker_scene import T_BASE_CAMERA, T_MAP_BASE, T_MAP_CAMERA, T_MAP_MARKER, markers_msg, pose
from ros_probe import matrix, transform, until
from visualization_msgs.msg import Marker as Shape
from visualization_msgs.msg import MarkerArray as Shapes


class MarkerLocatorTest(LocatedRobotTest):
    MOUNTS = [(f"base_{robot}", f"camera_{robot}") for robot in "bcd"]

    def robot(self, name):
        self.name = name
        (self.markers,) = self.connect(name, "markers")

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
        self.assert_pose(self.transforms.at("map", "base_b", stamp), T_MAP_BASE)

    def test_a_base_that_has_a_parent_is_not_taken_from_it(self):
        self.robot("c")
        not_used = "c/locator: localization", "not used: tf"

        def knows_the_parent():
            # Odometry comes after the image, so that at its stamp there is none yet.
            self.drive(next(self.stamps) - rospy.Duration(0.1), "c")
            self.assert_located(self.locate())
            return self.diagnostics.count(*not_used) > 0

        self.assertTrue(until(knows_the_parent))
        self.transforms.seen.clear()
        before = self.diagnostics.count(*not_used)
        for _ in range(3):
            self.assert_located(self.locate())
        self.assertTrue(self.diagnostics.reaches(*not_used, before + 3))
        self.assertFalse([key for key in self.transforms.seen if key[:2] == ("map", "base_c")])

    def test_map_to_odom_waits_for_odometry_and_never_uses_an_old_one(self):
        self.robot("d")
        self.drive(next(self.stamps), "d")
        stamp = self.show()
        self.assertIsNone(self.poses.at(stamp, 0.2))
        self.drive(stamp, "d")
        self.assert_located(stamp)
        self.assert_pose(self.transforms.at("map", "odom_d", stamp), T_MAP_BASE @ np.linalg.inv(T_ODOM_BASE))
        without = self.show()
        self.assertIsNone(self.poses.at(without, 1.2))
        self.drive(without + rospy.Duration(0.005), "d")
        self.assertTrue(self.diagnostics.reaches("d/locator: localization", "not used: transform", 1))
        self.assertFalse(self.poses.has(without))
        self.assertFalse([key for key in self.transforms.seen if key[1:] == ("odom_d", without)])

    def test_odometry_that_lags_by_more_than_an_image(self):
        self.robot("d")
        shown = []
        for _ in range(8):
            shown.append(self.show())
            rospy.sleep(1 / 30)
            if len(shown) > 2:
                self.drive(shown[-3], "d")
        for stamp in shown[1:-2]:
            self.assert_located(stamp)

    def test_a_recording_that_is_played_twice(self):
        self.robot("d")
        played = [rospy.Time(second) for second in range(1000, 1015)]  # longer than what tf keeps
        for _ in range(2):
            self.poses.forget()
            for stamp in played:
                self.drive(stamp, "d")
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
        maps = self.map_of("e")
        for shift in [0.0, 1.0]:
            T_moved = pose(np.eye(3), [0, 0, shift])
            maps.publish(map_msg({id: T_moved @ T for id, T in T_MAP_MARKER.items()}))

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


if __name__ == "__main__":
    rospy.init_node("marker_locator_test")
    rostest.rosrun("sextant", "marker_locator", MarkerLocatorTest)
