#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A bag is played, and played again: /clock, tf and the images' stamps jump back."""

import numpy as np
import rospy
import rostest
import tf2_ros
from geometry_msgs.msg import PoseWithCovarianceStamped
from marker_chain import PoseTest
from marker_scene import CAMERA, T_BASE_CAMERA, camera_info, image_msg, picture
from ros_probe import Diagnostics, Recorder, transform, until
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, Image

from sextant.msg import MarkerArray

STEP = 0.1  # s between images
LENGTH = 13.0  # s, longer than what tf keeps


class ClockJumpTest(PoseTest):
    @classmethod
    def setUpClass(cls):
        cls.picture = picture()
        cls.diagnostics = Diagnostics()
        cls.clock = rospy.Publisher("/clock", Clock, queue_size=10)
        cls.images = rospy.Publisher("image", Image, queue_size=10)
        cls.infos = rospy.Publisher("camera_info", CameraInfo, queue_size=10, latch=True)
        cls.infos.publish(camera_info())
        side = rospy.Publisher("side/markers", MarkerArray, queue_size=10)  # a second camera, the same view
        rospy.Subscriber("markers", MarkerArray, side.publish, queue_size=10)
        cls.moving_mount = tf2_ros.TransformBroadcaster()  # a camera that can be turned: tf ages

    def setUp(self):
        super().setUp()
        self.pair_poses = Recorder("pair/pose", PoseWithCovarianceStamped)
        self.addCleanup(self.pair_poses.close)
        self.assertTrue(self.pair_poses.connected())

    def show(self, stamp):
        """Publishes an instant; whether both locators located it."""
        self.clock.publish(Clock(stamp))
        self.moving_mount.sendTransform(transform(T_BASE_CAMERA, "base_link", CAMERA, stamp))
        self.images.publish(image_msg(self.picture, stamp))
        return bool(self.poses.at(stamp, 0.2)) and bool(self.pair_poses.at(stamp, 0.2))

    def play(self, begin):
        """All of one bag; the part of its images that both located."""
        self.poses.forget()
        self.pair_poses.forget()
        steps = range(int(LENGTH / STEP))
        return np.mean([self.show(rospy.Time.from_sec(begin + STEP * step)) for step in steps])

    def test_poses_come_again(self):
        before = (rospy.Time.from_sec(900 + STEP * step) for step in range(900))
        self.assertTrue(until(lambda: self.show(next(before))), "not everything is connected")
        for begin in [1000.0, 1000.5, 100.0]:  # again, and one that was recorded long before
            self.assertGreaterEqual(self.play(begin), 0.9, begin)
        self.assertTrue(until(lambda: self.diagnostics.summary("locator: localization") == "working"))
        for locator in ["locator: localization", "pair: localization"]:
            self.assertTrue(self.diagnostics.reaches(locator, "not used: clock", 2), locator)
        self.assertFalse(  # the pair counts each jump once, not of each camera; its next diagnostics agree
            self.diagnostics.reaches("pair: localization", "not used: clock", 3, timeout=2.5)
        )


if __name__ == "__main__":
    rospy.init_node("clock_jump_test")
    rostest.rosrun("sextant", "clock_jump", ClockJumpTest)
