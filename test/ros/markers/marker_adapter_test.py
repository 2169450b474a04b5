#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The detections of a package that is not installed become poses in the map."""

import unittest

import numpy as np
import rospy
import rostest
from foreign_messages import classes_of
from geometry_msgs.msg import PoseWithCovarianceStamped, Quaternion, Vector3
from marker_scene import CAMERA, T_CAMERA_MARKER, T_MAP_CAMERA, camera_info
from ros_probe import Recorder, matrix, quaternion, stamps, until
from sensor_msgs.msg import CameraInfo

MESSAGE, PARTS = classes_of("fiducial_msgs/FiducialTransformArray")
TURNED = np.diag([-1.0, -1.0, 1.0, 1.0])  # fiducials' axes of AprilTags


def transforms_msg(stamp, frame=CAMERA):
    """What aruco_detect publishes of the scene."""
    message = MESSAGE()
    message.header.stamp, message.header.frame_id = stamp, frame
    for id, T in T_CAMERA_MARKER.items():
        theirs = T @ TURNED
        transform = PARTS["Transform"](Vector3(*theirs[:3, 3]), Quaternion(*quaternion(theirs[:3, :3])))
        message.transforms.append(PARTS["FiducialTransform"](fiducial_id=id, transform=transform))
    return message


class MarkerAdapterTest(unittest.TestCase):
    def test_transforms_of_fiducials_give_the_pose_of_the_camera(self):
        poses = Recorder("pose", PoseWithCovarianceStamped)
        self.assertTrue(poses.connected())
        infos = rospy.Publisher("camera/camera_info", CameraInfo, queue_size=1, latch=True)
        infos.publish(camera_info())
        publisher = rospy.Publisher("fiducial_transforms", MESSAGE, queue_size=10)
        self.assertTrue(until(lambda: publisher.get_num_connections() == 1))
        stamp = stamps()

        def located():
            now = next(stamp)
            publisher.publish(transforms_msg(now, "another"))  # refused, and the next one is used
            publisher.publish(transforms_msg(now))
            return poses.at(now, 0.5)

        self.assertTrue(until(lambda: located() is not None))
        found = poses.all()[-1]
        self.assertEqual(found.header.frame_id, "map")
        np.testing.assert_allclose(matrix(found.pose.pose), T_MAP_CAMERA, atol=1e-5)
        # The covariance is that of corners with a noise of pose_sigma: of about 1 px in 600 px at 2 m
        deviation = np.sqrt(np.reshape(found.pose.covariance, (6, 6)).diagonal()[:3])
        self.assertTrue((deviation > 1e-3).all() and (deviation < 0.1).all(), deviation)


if __name__ == "__main__":
    rospy.init_node("marker_adapter_test")
    rostest.rosrun("sextant", "marker_adapter", MarkerAdapterTest)
