#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import os
import subprocess
import tempfile
import time
import unittest

import cv2
import rospy
import rostest
from geometry_msgs.msg import PoseWithCovarianceStamped
from nav_msgs.msg import Odometry, Path
from std_msgs.msg import Bool
from std_srvs.srv import SetBool, SetBoolResponse

from sextant.msg import MarkerMapEntries, MarkerMapEntry

FRAMES = 20
EXPECTED = """\
      position error, cm         angle error, degrees       frames
       mean    95 %    worst      mean    95 %    worst   with a pose
far    3.00    3.00     3.00      0.00    0.00     0.00   20 of 20
odd    0.50    1.00     1.00      0.00    0.00     0.00   10 of 20
"""


def set_pose(pose, x):
    pose.position.x, pose.orientation.w = x, 1.0


class DriveRecorderTest(unittest.TestCase):
    def setUp(self):
        self.truth = rospy.Publisher("ground_truth", Odometry, queue_size=100)
        self.poses = {
            mode: rospy.Publisher(mode + "/pose", PoseWithCovarianceStamped, queue_size=100)
            for mode in ("far", "odd")
        }
        self.finished = rospy.Publisher("finished", Bool, queue_size=1, latch=True)
        self.map = rospy.Publisher("marker_map/entries", MarkerMapEntries, queue_size=1, latch=True)
        self.started = []
        service = rospy.Service("begin", SetBool, self.on_start)
        self.addCleanup(service.shutdown)

    def on_start(self, request):
        self.started.append(request.data)
        return SetBoolResponse(True, "")

    def start(self, *params):
        node = subprocess.Popen(
            ["rosrun", "sextant", "drive_recorder", "__name:=recorder", "_modes:=[far, odd]", *params],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        self.addCleanup(node.kill)
        return node

    def publish_map(self):
        entry = MarkerMapEntry(family="tag36h11", id=1, size=0.2)
        set_pose(entry.pose.pose, 1.0)
        self.map.publish(MarkerMapEntries(markers=[entry]))

    def wait_for_start(self):
        end = time.monotonic() + 20
        while not self.started and time.monotonic() < end:
            time.sleep(0.05)
        self.assertEqual(self.started, [True])

    def drive(self):
        """The first locator is 3 cm off; the second has every other frame, by turns true and 1 cm off."""
        for index in range(FRAMES):
            truth, pose = Odometry(), PoseWithCovarianceStamped()
            truth.header.stamp = pose.header.stamp = rospy.Time(10, index)
            set_pose(truth.pose.pose, 0.1 * index)
            self.truth.publish(truth)
            set_pose(pose.pose.pose, 0.1 * index + 0.03)
            self.poses["far"].publish(pose)
            if index % 2 == 0:
                set_pose(pose.pose.pose, 0.1 * index + 0.01 * (index // 2 % 2))
                self.poses["odd"].publish(pose)

    def test_table_picture_and_trail_of_a_known_drive(self):
        with tempfile.TemporaryDirectory() as folder:
            picture = os.path.join(folder, "drive.png")
            trails = []
            rospy.Subscriber("ground_truth/path", Path, trails.append)
            node = self.start("_plot:=" + picture, "_start_service:=begin")
            self.publish_map()
            self.wait_for_start()
            self.drive()
            self.finished.publish(True)
            output, _ = node.communicate(timeout=20)
            self.assertEqual(node.returncode, 0, output)
            self.assertIn(EXPECTED, output)
            self.assertIn("plot of the drive: " + picture, output)
            self.assertGreater(cv2.imread(picture).std(), 10)
            self.assertEqual(trails[-1].poses[-1].pose.position.x, 0.1 * 17)  # the 18th: every sixth frame

    def test_what_never_comes_is_named(self):
        node = self.start("_timeout:=5.0", "_modes:=[far, absent]")
        output, _ = node.communicate(timeout=20)
        self.assertEqual(node.returncode, 1, output)
        self.assertIn("nothing is published on /absent/pose", output)


if __name__ == "__main__":
    rospy.init_node("drive_recorder_test")
    rostest.rosrun("sextant", "drive_recorder", DriveRecorderTest)
