#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A photo of a real print through the launched nodelets, and the same through `import sextant`."""

import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

import cv2
import numpy as np
import real_data
import rospy
import rostest
from geometry_msgs.msg import PoseWithCovarianceStamped
from ros_probe import WAIT, Recorder, matrix, transform
from sensor_msgs.msg import CameraInfo, CompressedImage, Image
from tf2_ros import StaticTransformBroadcaster

import sextant
from sextant.msg import MarkerArray

FOLDER = real_data.EXTERNAL / "markers/photos"
PHOTO = FOLDER / "403.jpg"
FAMILY, ID, SIZE = "DICT_5X5_1000", 403, 0.145


def raw(stamp):
    pixels = cv2.imread(str(PHOTO))
    height, width, _ = pixels.shape
    msg = Image(height=height, width=width, encoding="bgr8", step=3 * width, data=pixels.tobytes())
    msg.header.stamp, msg.header.frame_id = stamp, "camera"
    return msg


def compressed(stamp):
    msg = CompressedImage(format="jpeg", data=PHOTO.read_bytes())
    msg.header.stamp, msg.header.frame_id = stamp, "camera"
    return msg


def camera_info(calibration):
    return CameraInfo(
        width=calibration.width,
        height=calibration.height,
        distortion_model=calibration.distortion_model,
        D=calibration.D,
        K=np.ravel(calibration.K),
        R=np.ravel(calibration.R),
        P=np.ravel(calibration.P),
    )


@unittest.skipUnless(PHOTO.is_file(), "the external test data (markers/photos) is not there")
class PhotoTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.photos = real_data.Photos(FOLDER)
        self.map = sextant.MarkerMap("map")
        self.map_file = folder.name + "/map.yaml"
        self.params_file = folder.name + "/params.yaml"  # every photo by itself, as Python sees it
        Path(self.params_file).write_text("search: full\n")
        mount = transform(self.photos.T_base_camera, "base_link", "camera", rospy.Time.now())
        self.broadcaster = StaticTransformBroadcaster()
        self.broadcaster.sendTransform(mount)

    def launch(self, T_map_marker, **arguments):
        self.map.add(sextant.MappedMarker(FAMILY, ID, SIZE, T_map_marker))
        sextant.write_marker_map(self.map, self.map_file)
        common = {"image": "photo", "families": f"[{FAMILY}]", "marker_size": SIZE, "map": self.map_file}
        common["detector_params"] = self.params_file
        texts = [f"{name}:={value}" for name, value in {**common, **arguments}.items()]
        process = subprocess.Popen(["roslaunch", "--wait", "sextant", "markers.launch", *texts])
        self.addCleanup(self.end, process)

    def end(self, process):
        process.send_signal(signal.SIGINT)
        process.wait(2 * WAIT)

    def answers(self, topic, message):
        """Markers and pose of the first photo that gave both; it is shown again until then."""
        markers = Recorder("markers", MarkerArray)
        poses = Recorder("pose", PoseWithCovarianceStamped)
        image = rospy.Publisher(topic, type(message(rospy.Time())), queue_size=1)
        info = rospy.Publisher("camera_info", CameraInfo, queue_size=1, latch=True)
        info.publish(camera_info(self.photos.calibration))
        end = time.monotonic() + 3 * WAIT
        while time.monotonic() < end:
            stamp = rospy.Time.now()
            image.publish(message(stamp))
            if poses.at(stamp, timeout=0.5):
                return markers.at(stamp), poses.at(stamp)
        self.fail("no pose of the photo")

    def check_markers(self, markers, image):
        """The message is what Python computes, bit for bit, and the pose is the expected one."""
        params = sextant.DetectorParams()
        params.families = [FAMILY]
        camera = sextant.CameraModel(self.photos.calibration)
        detections = sextant.MarkerDetector(params).detect(image, camera)
        self.assertEqual([(each.family, each.id) for each in markers.markers], [(FAMILY, ID)])
        (marker,), (detection,) = markers.markers, detections
        np.testing.assert_array_equal(np.reshape(marker.corners, (4, 2)), detection.corners)
        best = sextant.solve_marker_pose(camera, detection.corners, SIZE).best
        self.assertEqual(marker.reprojection_error, best.reprojection_error)
        self.assertLessEqual(marker.reprojection_error, 0.11)
        T_camera_marker = matrix(marker.pose.pose)
        np.testing.assert_array_equal(T_camera_marker[:3, 3], best.T_camera_marker[:3, 3])
        np.testing.assert_allclose(T_camera_marker, best.T_camera_marker, rtol=0, atol=1e-14)
        error = sextant.pose_error(self.photos.T_map_marker, self.photos.T_base_camera @ T_camera_marker)
        self.assertLessEqual(np.linalg.norm(error[:3]), 2e-3)
        self.assertLessEqual(np.degrees(np.linalg.norm(error[3:])), 1.0)
        return detections

    def located(self, T_base_camera, detections):
        view = sextant.MarkerView(sextant.CameraModel(self.photos.calibration), T_base_camera, detections)
        return sextant.MarkerLocator().locate(self.map, [view]).pose

    def test_compressed_photo_and_the_pose_of_the_camera(self):
        # Neither map nor mount are turned: quaternions, as messages have them, would round them.
        T_map_marker = sextant.pose_from_xyz_rpy([0.7611, 0.2505, 0.4028], [0, 0, 0])
        self.launch(T_map_marker, compressed="true", base_frame="camera")
        markers, pose = self.answers("photo/compressed", compressed)
        detections = self.check_markers(markers, cv2.imread(str(PHOTO), cv2.IMREAD_GRAYSCALE))
        expected = self.located(np.eye(4), detections)
        T_map_camera = matrix(pose.pose.pose)
        np.testing.assert_array_equal(T_map_camera[:3, 3], expected.T_map_base[:3, 3])
        np.testing.assert_allclose(np.reshape(pose.pose.covariance, (6, 6)), expected.covariance, rtol=1e-9)
        np.testing.assert_allclose(T_map_camera, expected.T_map_base, rtol=0, atol=1e-14)

    def test_raw_photo_and_the_pose_of_the_robot(self):
        self.launch(self.photos.T_map_marker)
        markers, pose = self.answers("photo", raw)
        detections = self.check_markers(markers, cv2.imread(str(PHOTO)))
        T_map_base = matrix(pose.pose.pose)
        # Mount and map come as quaternions: the same but for rounding.
        expected = self.located(self.photos.T_base_camera, detections).T_map_base
        np.testing.assert_allclose(T_map_base, expected, rtol=0, atol=1e-9)
        # The robot is at the map's origin; 1 degree at the marker is 2 cm here.
        self.assertLess(np.linalg.norm(T_map_base[:3, 3]), 0.02)


if __name__ == "__main__":
    rospy.init_node("photo_test")
    rostest.rosrun("sextant", "photo", PhotoTest)
