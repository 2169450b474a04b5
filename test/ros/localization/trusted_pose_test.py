#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import rospy
import rostest
from geometry_msgs.msg import PoseWithCovarianceStamped
from located_robot import T_ODOM_BASE, LocatedRobotTest, map_msg
from marker_scene import (
    FAMILY,
    T_MAP_BASE,
    T_MAP_CAMERA,
    T_MAP_MARKER,
    WALL_AXES,
    corners_at,
    marker_msg,
    markers_msg,
    pose,
)
from ros_probe import Recorder, until

T_MAP_ODOM = T_MAP_BASE @ np.linalg.inv(T_ODOM_BASE)
RESIDUAL = "residual against the map (standard deviations)"


class TrustedPoseTest(LocatedRobotTest):
    MOUNTS = [("base_a", "camera_left"), ("base_a", "camera_right"), ("base_b", "camera_b")]

    def test_two_cameras_are_one_problem(self):
        left, right = self.connect("a", "left", "right")

        def show():
            stamp = [next(self.stamps) for _ in range(20)][-1]  # far from the one before
            later = stamp + rospy.Duration(0.004)
            left.publish(markers_msg(stamp, [marker_msg(3)], "camera_left"))
            right.publish(markers_msg(later, [marker_msg(5)], "camera_right"))
            return later

        self.assertTrue(until(lambda: self.poses.at(show(), 0.3) is not None))
        together = show()
        self.assert_located(together)
        used = "mapped markers used in the last image"
        self.assertTrue(self.diagnostics.reaches("a/locator: localization", used, 2))
        alone = next(self.stamps)
        left.publish(markers_msg(alone, [marker_msg(3)], "camera_left"))
        variance = [self.poses.at(stamp).pose.covariance[7] for stamp in (together, alone)]
        self.assertLess(variance[0], 0.25 * variance[1])

    def test_map_to_odom_goes_on_between_images(self):
        (markers,) = self.connect("b", "markers")

        def located():
            self.stamp = next(self.stamps)
            self.drive(self.stamp, "b")
            markers.publish(markers_msg(self.stamp, frame="camera_b"))
            return self.poses.at(self.stamp, 0.3) is not None

        self.assertTrue(until(located))
        stamps_sent = [self.stamp + rospy.Duration(0.1 * i) for i in range(1, 4)]
        for stamp in stamps_sent:
            self.drive(stamp, "b")
            self.assert_pose(self.transforms.at("map", "odom_b", stamp), T_MAP_ODOM)
        sent = [key[2] for key in self.transforms.seen if key[:2] == ("map", "odom_b")]
        self.assertEqual(sent, sorted(set(sent)))  # never back in time, never twice

    def test_what_contradicts_the_odometry_is_refused_until_it_lasts(self):
        (markers,) = self.connect("b", "markers")
        slid = pose(np.eye(3), [0, 2.0, 0]) @ T_ODOM_BASE  # odometry only, the markers do not agree
        starts = Recorder("/b/initialpose", PoseWithCovarianceStamped)
        self.addCleanup(starts.close)
        self.assertTrue(starts.connected())
        shown = []

        def show(T_odom_base):
            stamp = next(self.stamps)
            shown.append(stamp)
            self.drive(stamp, "b", T_odom_base)
            markers.publish(markers_msg(stamp, frame="camera_b"))
            return self.poses.at(stamp, 0.5) is not None

        self.assertTrue(until(lambda: show(T_ODOM_BASE)))
        self.assertEqual([show(slid) for _ in range(4)], [False, False, True, True])
        self.assertEqual(starts.at(shown[-2]).pose, self.poses.at(shown[-2]).pose)  # for amcl, once
        self.assertFalse([stamp for stamp in shown[-4:] if stamp != shown[-2] and starts.has(stamp)])
        status = "b/locator: localization"
        self.assertTrue(self.diagnostics.reaches(status, "no pose: the markers contradict the odometry", 2))
        T_moved = pose(np.eye(3), [0, 2.0, 0])
        stamp = next(self.stamps)
        self.drive(stamp, "b", slid)
        T = self.transforms.at("map", "odom_b", stamp)
        self.assert_pose(T, T_MAP_ODOM @ np.linalg.inv(T_moved), 1e-3)

    def test_a_moved_marker_is_named(self):
        (markers,) = self.connect("c", "markers")
        maps = self.map_of("c")
        stands = {**T_MAP_MARKER, 8: pose(WALL_AXES, [3, 0.0, 1.1])}
        surveyed = {**stands, 8: pose(WALL_AXES, [3, 0.08, 1.1])}
        maps.publish(map_msg(surveyed))
        T_camera_map = np.linalg.inv(T_MAP_CAMERA)
        seen = [marker_msg(id, corners=corners_at(T_camera_map @ T)) for id, T in stands.items()]
        status = "c/locator: localization"
        text = f"marker 8 ({FAMILY}) is 8 cm from its position in the map"

        def named():
            stamp = next(self.stamps)
            markers.publish(markers_msg(stamp, seen, "camera_c"))
            self.poses.at(stamp, 0.3)
            return text in (self.diagnostics.summary(status) or "")

        self.assertTrue(until(named))
        residual = {id: float(self.diagnostics.row(status, f"{RESIDUAL}: {FAMILY}/{id}")) for id in stands}
        self.assertGreater(residual.pop(8), 2.5)  # beyond the gate: the root of 50 / 8
        self.assertLess(max(residual.values()), 0.1)
        last = next(self.stamps)
        markers.publish(markers_msg(last, seen, "camera_c"))
        self.assert_located(last, T_MAP_CAMERA)


if __name__ == "__main__":
    rospy.init_node("trusted_pose_test")
    rostest.rosrun("sextant", "trusted_pose", TrustedPoseTest)
