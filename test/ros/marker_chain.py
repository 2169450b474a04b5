# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Detector and locator before the scene: feeds images, and knows which poses are true."""

import unittest

import numpy as np
import rospy
import tf2_ros
from geometry_msgs.msg import PoseWithCovarianceStamped
from marker_scene import CAMERA, T_BASE_CAMERA, T_MAP_BASE, camera_info, image_msg, picture
from ros_probe import Diagnostics, Recorder, matrix, stamps, transform, until
from sensor_msgs.msg import CameraInfo, Image

from sextant.msg import MarkerArray

TOLERANCE = 0.005  # m and rad; the chain errs by less than 0.001 here, a wrong planar solution by far more


def publish_mount():
    """The static transform from base_link to the camera; keep the broadcaster."""
    broadcaster = tf2_ros.StaticTransformBroadcaster()
    broadcaster.sendTransform(transform(T_BASE_CAMERA, "base_link", CAMERA, rospy.Time.now()))
    return broadcaster


def deviation(T, truth):
    """Of two poses (4 x 4): (metres, radians)."""
    turn = np.linalg.inv(T[:3, :3]) @ truth[:3, :3]
    sine = np.linalg.norm([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / 2
    angle = np.arctan2(sine, (np.trace(turn) - 1) / 2)
    return np.linalg.norm(T[:3, 3] - truth[:3, 3]), angle


class PoseTest(unittest.TestCase):
    """A test that fails when any pose that was published in it is not true."""

    def setUp(self):
        self.poses = Recorder("pose", PoseWithCovarianceStamped)
        self.addCleanup(self.poses.close)
        self.assertTrue(self.poses.connected())

    def tearDown(self):
        for msg in self.poses.all():
            self.assert_true(matrix(msg.pose.pose))
            self.assertEqual(msg.header.frame_id, "map")

    def assert_true(self, T, truth=T_MAP_BASE):
        metres, radians = deviation(T, truth)
        self.assertLess(metres, TOLERANCE)
        self.assertLess(radians, TOLERANCE)


class ChainTest(PoseTest):
    """Image and camera_info in, markers and pose out, both nodelets in one manager."""

    @classmethod
    def setUpClass(cls):
        cls.picture = picture()
        cls.stamps = stamps()
        cls.mount = publish_mount()
        cls.diagnostics = Diagnostics()
        cls.images = rospy.Publisher("image", Image, queue_size=10)
        cls.infos = rospy.Publisher("camera_info", CameraInfo, queue_size=10)

    def setUp(self):
        super().setUp()
        self.markers = Recorder("markers", MarkerArray)
        self.addCleanup(self.markers.close)
        self.assertTrue(self.markers.connected())
        self.assertTrue(until(lambda: self.images.get_num_connections() > 0))
        self.assertTrue(until(lambda: self.infos.get_num_connections() > 0))

    def show(self, image=None):
        """Publishes an image (default: the good one) and returns its stamp."""
        image = image_msg(self.picture, None) if image is None else image
        image.header.stamp = next(self.stamps)
        self.images.publish(image)
        return image.header.stamp

    def assert_still_right(self):
        """A good calibration and a good image give a pose again; tearDown sees that it is true."""

        def answered():
            self.infos.publish(camera_info())
            return self.poses.at(self.show(), 0.3) is not None

        self.assertTrue(until(answered), "no pose of a good image any more")
