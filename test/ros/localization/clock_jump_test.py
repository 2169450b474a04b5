#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A bag is played, and played again: /clock, tf and the images' stamps jump back."""

import rospy
import rostest
import tf2_ros
from marker_chain import PoseTest
from marker_scene import CAMERA, T_BASE_CAMERA, camera_info, image_msg, picture
from ros_probe import Diagnostics, transform, until
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, Image

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
        cls.moving_mount = tf2_ros.TransformBroadcaster()  # a camera that can be turned: tf ages

    def play(self, begin):
        """All of one bag; the stamps of its images."""
        played = [rospy.Time.from_sec(begin + STEP * step) for step in range(int(LENGTH / STEP))]
        for stamp in played:
            self.clock.publish(Clock(stamp))
            self.moving_mount.sendTransform(transform(T_BASE_CAMERA, "base_link", CAMERA, stamp))
            self.images.publish(image_msg(self.picture, stamp))
            self.poses.at(stamp, 0.2)
        return played

    def count_poses(self, played):
        return sum(self.poses.has(stamp) for stamp in played)

    def test_poses_come_again(self):
        self.assertTrue(until(lambda: self.images.get_num_connections() > 0))
        self.assertTrue(until(lambda: self.clock.get_num_connections() > 0))
        for begin in [1000.0, 1000.5, 100.0]:  # again, and one that was recorded long before
            self.poses.forget()
            played = self.play(begin)
            self.assertGreaterEqual(self.count_poses(played), 0.9 * len(played), begin)
        self.assertTrue(until(lambda: self.diagnostics.summary("locator: localization") == "working"))
        self.assertTrue(self.diagnostics.reaches("locator: localization", "not used: clock", 2))


if __name__ == "__main__":
    rospy.init_node("clock_jump_test")
    rostest.rosrun("sextant", "clock_jump", ClockJumpTest)
