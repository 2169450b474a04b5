#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import time
import unittest

import cv2
import numpy as np
import rospy
import rostest
from marker_chain import TOLERANCE, deviation
from marker_scene import CAMERA, FAMILY, SIZE, T_CAMERA_MARKER, K, camera_info, corners_of, image_msg, picture
from ros_probe import WAIT, Diagnostics, Recorder, TransformRecorder, matrix, stamps, subscribers_of, until
from sensor_msgs.msg import CameraInfo, CompressedImage, Image
from std_srvs.srv import SetBool

from sextant.msg import MarkerArray

DOCKING = "docking_detector: detection"


def jpeg_msg(data, format_="mono8; jpeg compressed "):
    msg = CompressedImage(format=format_, data=data)
    msg.header.frame_id = CAMERA
    return msg


def encoded(pixels, ending=".jpg"):
    return cv2.imencode(ending, pixels)[1].tobytes()


class MarkerDetectorTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.picture = picture()
        cls.stamps = stamps()
        cls.diagnostics = Diagnostics()
        cls.transforms = TransformRecorder()
        cls.infos = rospy.Publisher("camera_info", CameraInfo, queue_size=1, latch=True)
        cls.infos.publish(camera_info())
        cls.images = rospy.Publisher("image", Image, queue_size=10)
        cls.jpegs = rospy.Publisher("image/compressed", CompressedImage, queue_size=10)

    def recorder(self, topic, type_):
        recorder = Recorder(topic, type_)
        self.addCleanup(recorder.close)
        self.assertTrue(recorder.connected())
        return recorder

    def show(self, msg, publisher):
        msg.header.stamp = next(self.stamps)
        publisher.publish(msg)
        return msg.header.stamp

    def seen(self, recorder, publisher, make):
        """Markers by id of the first image looked at: the calibration has a connection of its own."""

        def answered():
            self.answer = recorder.at(self.show(make(), publisher), 0.3)
            return self.answer is not None and len(self.answer.markers) == 2

        self.assertTrue(until(answered))
        return {marker.id: marker for marker in self.answer.markers}

    def good(self):
        return image_msg(self.picture, None)

    def assert_pose(self, T, truth):
        metres, radians = deviation(T, truth)
        # Of one marker alone, 2 m away: a corner's 0.02 px are this much along the line of sight.
        self.assertLess(metres, 3 * TOLERANCE)
        self.assertLess(radians, 0.05)

    def test_corners_and_poses_are_true(self):
        seen = self.seen(self.recorder("markers", MarkerArray), self.images, self.good)
        self.assertEqual(set(seen), {3, 5})
        for id, marker in seen.items():
            self.assertEqual((marker.family, marker.size, marker.hamming), (FAMILY, SIZE, 0))
            np.testing.assert_allclose(np.reshape(marker.corners, (4, 2)), corners_of(id), atol=0.1)
            self.assert_pose(matrix(marker.pose.pose), T_CAMERA_MARKER[id])
            self.assertLess(marker.reprojection_error, 0.1)
            if marker.alternative_reprojection_error >= 0:
                self.assertGreater(marker.alternative_reprojection_error, marker.reprojection_error)
            self.assertTrue(np.all(np.diag(np.reshape(marker.pose.covariance, (6, 6))) > 0))
        self.assertEqual(self.answer.header.frame_id, CAMERA)
        self.assertEqual(self.answer.camera_info.K, tuple(K.ravel()))
        self.assertFalse(self.answer.rectified)

    def test_compressed_images_and_sizes_of_single_markers(self):
        received = self.recorder("docking/markers", MarkerArray)
        for ending in [".jpg", ".png"]:
            seen = self.seen(
                received, self.jpegs, lambda ending=ending: jpeg_msg(encoded(self.picture, ending))
            )
            self.assertEqual((seen[3].size, seen[5].size), (SIZE, 2 * SIZE))
            self.assert_pose(matrix(seen[3].pose.pose), T_CAMERA_MARKER[3])
            distance = np.linalg.norm(matrix(seen[5].pose.pose)[:3, 3])
            self.assertAlmostEqual(distance, 2 * np.linalg.norm(T_CAMERA_MARKER[5][:3, 3]), delta=0.05)

    def test_markers_as_tf_without_a_map(self):
        self.assertTrue(until(lambda: self.jpegs.get_num_connections() > 0))
        stamp = self.show(jpeg_msg(encoded(self.picture)), self.jpegs)
        T = self.transforms.at(CAMERA, "seen/tag36h11/3", stamp)
        self.assert_pose(T, T_CAMERA_MARKER[3])
        unstamped = jpeg_msg(encoded(self.picture))
        unstamped.header.stamp = rospy.Time(0)
        self.jpegs.publish(unstamped)
        self.seen(
            self.recorder("docking/markers", MarkerArray), self.jpegs, lambda: jpeg_msg(encoded(self.picture))
        )
        self.assertFalse([key for key in self.transforms.seen if key[2] == rospy.Time(0)])

    def test_what_cannot_be_decoded_is_counted(self):
        received = self.recorder("docking/markers", MarkerArray)
        good = encoded(self.picture)
        png = encoded(self.picture, ".png")
        huge = png[:16] + b"\xff" * 8 + png[24:]  # width and height of its header
        before = self.diagnostics.count(DOCKING, "not used: image")
        bad = []
        for data in [b"", b"nonsense", bytes(1000), good[:20], png[:40], huge]:
            bad.append(self.show(jpeg_msg(data), self.jpegs))
            self.seen(received, self.jpegs, lambda: jpeg_msg(good))
        self.assertTrue(self.diagnostics.reaches(DOCKING, "not used: image", before + 1))
        self.assertFalse([stamp for stamp in bad if received.has(stamp)])

    def test_images_are_received_only_while_there_is_a_subscriber(self):
        self.assertTrue(until(lambda: subscribers_of("/image") == []))
        received = Recorder("markers", MarkerArray)
        self.assertTrue(until(lambda: subscribers_of("/image") == ["/manager"]))
        self.assertTrue(until(lambda: subscribers_of("/camera_info").count("/manager") == 1))
        received.close()
        self.assertTrue(until(lambda: subscribers_of("/image") == []))
        self.assertTrue(until(lambda: self.diagnostics.summary("detector: detection") == "no subscriber"))

    def test_detection_is_switched_off_and_on(self):
        enable = rospy.ServiceProxy("detector/enable", SetBool)
        enable.wait_for_service(WAIT)
        received = self.recorder("markers", MarkerArray)
        self.seen(received, self.images, self.good)
        self.assertTrue(enable(False).success)
        self.assertTrue(until(lambda: subscribers_of("/image") == []))
        self.assertTrue(until(lambda: self.images.get_num_connections() == 0))
        off = self.show(self.good(), self.images)
        self.assertTrue(enable(True).success)
        self.assertTrue(until(lambda: self.images.get_num_connections() == 1))
        self.seen(received, self.images, self.good)
        self.assertFalse(received.has(off))

    def test_debug_picture_raw_and_compressed(self):
        raw = self.recorder("markers/image", Image)
        jpeg = self.recorder("markers/image/compressed", CompressedImage)
        begin = time.monotonic()
        for _ in range(30):
            self.show(self.good(), self.images)
            time.sleep(0.04)
        self.assertTrue(until(lambda: raw.all() and jpeg.all()))
        most = 5.0 * (time.monotonic() - begin) + 1
        self.assertLessEqual(len(raw.all()), most)
        msg = raw.all()[-1]
        self.assertEqual((msg.width, msg.height, msg.encoding), (320, 240, "bgr8"))
        drawn = np.frombuffer(msg.data, np.uint8).reshape(240, 320, 3)
        decoded = cv2.imdecode(np.frombuffer(jpeg.all()[-1].data, np.uint8), cv2.IMREAD_COLOR)
        self.assertLess(np.abs(decoded.astype(int) - drawn).mean(), 3)
        colour = np.ptp(drawn.astype(int), axis=2) > 60
        middle = corners_of(5).mean(axis=0) / 2
        rows, columns = np.nonzero(colour[:200, 200:])  # not the line below that explains the residuals
        np.testing.assert_allclose([columns.mean() + 200, rows.mean()], middle, atol=8)


if __name__ == "__main__":
    rospy.init_node("marker_detector_test")
    rostest.rosrun("sextant", "marker_detector", MarkerDetectorTest)
