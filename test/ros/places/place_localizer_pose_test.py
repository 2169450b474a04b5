#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np
import rospy
import rostest
from geometry_msgs.msg import PoseWithCovarianceStamped
from posed_street import CAMERA, view, write_street
from ros_probe import WAIT, Recorder, matrix, stamps, until
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Header

from sextant.messages.camera_messages import calibration_to_message


class PlaceLocalizerPoseTest(unittest.TestCase):
    """The map's photos have poses."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        path, _ = write_street(Path(folder.name))
        self.images = rospy.Publisher("/camera/image_raw", Image, queue_size=10)
        self.infos = rospy.Publisher("/camera/camera_info", CameraInfo, queue_size=10)
        self.poses, self.stamps = Recorder("/pose", PoseWithCovarianceStamped), stamps()
        self.addCleanup(self.poses.close)
        given = ["image:=/camera/image_raw", f"_map_file:={path}", "_mode:=single"]
        node = subprocess.Popen(["rosrun", "sextant", "place_localizer", *given])
        self.addCleanup(node.wait, WAIT)
        self.addCleanup(node.terminate)
        connected = lambda: self.images.get_num_connections() and self.infos.get_num_connections()  # noqa: E731
        self.assertTrue(until(connected, WAIT))

    def pose_of(self, image):
        """Position and covariance of the answer to an image."""
        header = Header(stamp=next(self.stamps), frame_id="camera")
        rows, columns = image.shape
        self.images.publish(Image(header, rows, columns, "mono8", 0, columns, image.tobytes()))
        pose = self.poses.at(header.stamp).pose
        return matrix(pose.pose), np.reshape(pose.covariance, (6, 6))

    def test_a_calibrated_image_has_a_metric_pose(self):
        image, T = view(7.4, 0.4, 0.05, seed=99)
        _, coarse = self.pose_of(image)
        self.assertGreater(np.sqrt(coarse[0, 0]), 0.3)  # without a calibration
        self.infos.publish(calibration_to_message(CAMERA.calibration, Header()))
        self.assertTrue(until(lambda: self.pose_of(image)[1][0, 0] < 0.05**2, WAIT))
        pose, covariance = self.pose_of(image)
        np.testing.assert_allclose(pose[:3, 3], T[:3, 3], atol=0.1)
        np.testing.assert_allclose(pose[:3, 0], T[:3, 2], atol=0.01)  # x is ahead
        self.assertGreater(np.linalg.eigvalsh(covariance).min(), 0.0)


if __name__ == "__main__":
    rospy.init_node("place_localizer_pose_test")
    rostest.rosrun("sextant", "place_localizer_pose", PlaceLocalizerPoseTest)
