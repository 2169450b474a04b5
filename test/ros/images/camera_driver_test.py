#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import os
import subprocess
import tempfile
import time
import unittest

import cv2
import numpy as np
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from ros_probe import WAIT
from sensor_msgs.msg import CameraInfo, Image
from sensor_msgs.srv import SetCameraInfo

WIDTH, HEIGHT = 64, 48
CALIBRATION = """image_width: 64
image_height: 48
camera_name: camera
camera_matrix: {rows: 3, cols: 3, data: [50.0, 0.0, 31.0, 0.0, 51.0, 23.0, 0.0, 0.0, 1.0]}
distortion_model: plumb_bob
distortion_coefficients: {rows: 1, cols: 5, data: [0.1, -0.2, 0.001, 0.002, 0.0]}
rectification_matrix: {rows: 3, cols: 3, data: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]}
projection_matrix: {rows: 3, cols: 4, data: [49.0, 0.0, 30.0, 0.0, 0.0, 52.0, 22.0, 0.0, 0.0, 0.0, 1.0, 0.0]}
"""
K = [50.0, 0.0, 31.0, 0.0, 51.0, 23.0, 0.0, 0.0, 1.0]


def pictures(number, channels=3):
    shape = (HEIGHT, WIDTH, channels) if channels > 1 else (HEIGHT, WIDTH)
    return np.random.RandomState(1).randint(0, 256, (number, *shape), np.uint8)


def wait_until(condition):
    end = time.monotonic() + WAIT
    while not condition() and time.monotonic() < end:
        time.sleep(0.05)
    return condition()


class CameraDriverTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.images, self.infos, self.status = [], [], {}
        for topic, kind, store in [
            ("image_raw", Image, self.images.append),
            ("camera_info", CameraInfo, self.infos.append),
            ("/diagnostics", DiagnosticArray, self.diagnose),
        ]:
            self.addCleanup(rospy.Subscriber(topic, kind, store, queue_size=100).unregister)

    def diagnose(self, message):
        status = message.status[-1]
        self.status = {each.key: each.value for each in status.values}
        self.status.update(level=status.level, message=status.message)

    def path(self, name, text=None):
        path = os.path.join(self.folder, name)
        if text is not None:
            with open(path, "w") as file:
                file.write(text)
        return path

    def write(self, images):
        os.mkdir(self.path("images"))
        for index, image in enumerate(images):
            cv2.imwrite(self.path(f"images/{index:03}.png"), image)
        return self.path("images")

    def start(self, **params):
        command = ["rosrun", "sextant", "camera_driver", "__name:=driver"]
        command += [f"_{name}:={value}" for name, value in params.items()]
        with open(self.path("log"), "w") as log:
            node = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT)
        self.addCleanup(self.stop, node)
        return node

    def stop(self, node):
        node.terminate()
        self.assertIsNotNone(node.wait(WAIT))
        if rospy.has_param("/driver"):
            rospy.delete_param("/driver")

    def log(self):
        with open(self.path("log")) as file:
            return file.read()

    def receive(self, number):
        enough = wait_until(lambda: len(self.images) >= number and len(self.infos) >= number)
        self.assertTrue(enough, f"{len(self.images)} images, {len(self.infos)} camera_info; {self.log()}")

    def received(self):
        shape = (HEIGHT, WIDTH, 3) if self.images[0].encoding == "bgr8" else (HEIGHT, WIDTH)
        return np.array([np.frombuffer(image.data, np.uint8).reshape(shape) for image in self.images])

    def test_a_folder_comes_whole_in_order_with_its_calibration(self):
        expected = pictures(8)
        calibration = self.path("camera.yaml", CALIBRATION)
        begin = rospy.Time.now()
        self.start(source=self.write(expected), rate=10, camera_info_url=calibration, frame_id="eye")
        self.receive(8)
        np.testing.assert_array_equal(self.received(), expected)
        stamps = [image.header.stamp for image in self.images]
        np.testing.assert_allclose(np.diff([stamp.to_sec() for stamp in stamps]), 0.1, atol=0.08)
        self.assertTrue(begin < stamps[0] < stamps[-1] < rospy.Time.now())
        for image, info in zip(self.images, self.infos):
            self.assertEqual((image.encoding, image.step, image.header.frame_id), ("bgr8", 3 * WIDTH, "eye"))
            self.assertEqual((info.header.stamp, info.header.frame_id), (image.header.stamp, "eye"))
            self.assertEqual((info.width, info.height, list(info.K)), (WIDTH, HEIGHT, K))
            self.assertEqual(list(info.D), [0.1, -0.2, 0.001, 0.002, 0.0])
            self.assertEqual(info.P[0], 49.0)

    def test_a_loop_stops_after_the_frames_asked_for(self):
        expected = pictures(3, channels=1)
        self.start(source=self.write(expected), encoding="mono8", rate=10, loop=True, frames=7, preload=True)
        self.receive(7)
        np.testing.assert_array_equal(self.received(), expected[[0, 1, 2, 0, 1, 2, 0]])
        self.assertTrue(wait_until(lambda: self.status.get("message") == "finished"), self.status)
        self.assertEqual((self.status["published"], self.status["opened"]), ("7", "3"))
        self.assertEqual(len(self.images), 7)

    def test_a_video_is_played_at_its_own_rate(self):
        path = self.path("video.avi")
        writer = cv2.VideoWriter(path, cv2.VideoWriter_fourcc(*"MJPG"), 12.5, (WIDTH, HEIGHT))
        for image in pictures(10):
            writer.write(cv2.blur(image, (5, 5)))
        writer.release()
        reader = cv2.VideoCapture(path)
        expected = [reader.read()[1] for _ in range(10)]
        self.start(source=path)
        self.receive(10)
        np.testing.assert_array_equal(self.received(), expected)
        duration = (self.images[-1].header.stamp - self.images[0].header.stamp).to_sec()
        self.assertAlmostEqual(duration, 9 / 12.5, delta=0.1)

    def test_a_calibration_of_another_size_is_not_passed_on(self):
        calibration = self.path("camera.yaml", CALIBRATION.replace("height: 48", "height: 60"))
        self.start(source=self.write(pictures(3)), loop=True, rate=20, camera_info_url=calibration)
        self.receive(10)
        for info in self.infos:
            self.assertEqual((info.width, info.height, list(info.K)), (WIDTH, HEIGHT, [0.0] * 9))
        reason = "the calibration is for 64 x 60 pixels, the images have 64 x 48 pixels"
        self.assertEqual(self.log().count(reason), 1, self.log())
        self.assertTrue(wait_until(lambda: self.status.get("level") == DiagnosticStatus.WARN), self.status)
        self.assertIn(reason, self.status["message"])

    def test_the_calibration_tool_sets_and_saves_a_calibration(self):
        calibration = self.path("new.yaml")
        self.start(source=self.write(pictures(3)), loop=True, rate=20, camera_info_url=calibration)
        self.receive(3)
        self.assertEqual(self.infos[-1].K[0], 0.0)
        info = CameraInfo(width=WIDTH, height=HEIGHT, K=K, D=[0.0] * 5, distortion_model="plumb_bob")
        rospy.wait_for_service("set_camera_info", WAIT)
        answer = rospy.ServiceProxy("set_camera_info", SetCameraInfo)(info)
        self.assertTrue(answer.success, answer.status_message)
        self.assertTrue(wait_until(lambda: list(self.infos[-1].K) == K))
        self.assertTrue(os.path.exists(calibration))

    def test_an_image_that_cannot_be_read_is_skipped_counted_and_logged_once(self):
        expected = pictures(4)
        folder = self.write(expected)
        broken = self.path("images/001.png", "no picture")
        self.start(source=folder, rate=20, loop=True)
        self.receive(12)
        np.testing.assert_array_equal(self.received()[:6], expected[[0, 2, 3, 0, 2, 3]])
        self.assertEqual(self.log().count(broken), 1, self.log())
        self.assertTrue(wait_until(lambda: int(self.status.get("not used: image", 0)) >= 3), self.status)

    def test_a_missing_camera_is_logged_once_and_ends_nothing(self):
        node = self.start(source=987)
        self.assertTrue(wait_until(lambda: int(self.status.get("not used: source", 0)) >= 3), self.status)
        self.assertIsNone(node.poll())
        reason = "/dev/video987: No such file or directory; is the camera plugged in?"
        self.assertEqual(self.status["message"], reason)
        self.assertEqual(self.log().count(reason), 1, self.log())

    def test_what_stops_the_start_up_is_named(self):
        empty = self.path("empty")
        os.mkdir(empty)
        good = self.write(pictures(1))
        for params, reason in [
            ({"source": self.path("none.avi")}, self.path("none.avi") + " does not exist"),
            ({"source": empty}, "no image (png, jpg, ...) in the folder " + empty),
            ({"source": self.path("text.jpg", "text")}, "the image cannot be decoded"),
            ({"source": good, "widht": 64}, "unknown parameter /driver/widht"),
            ({"source": good, "width": 65}, "has 64 x 48 pixels"),
            ({"source": good, "rate": "fast"}, "/driver/rate must be a number"),
            ({"source": good, "encoding": "rgb8"}, "allowed is one of mono8, bgr8"),
            ({"source": good, "camera_name": "my/camera"}, "letters, digits and _"),
            ({"source": good, "camera_info_url": self.path("x.yaml", "text")}, "is not a calibration file"),
            ({"source": 0, "preload": True}, "preload is for files"),
        ]:
            node = self.start(**params)
            self.assertEqual(node.wait(WAIT), 1, self.log())
            self.assertIn(reason, self.log())
            rospy.delete_param("/driver")


if __name__ == "__main__":
    rospy.init_node("camera_driver_test")
    rostest.rosrun("sextant", "camera_driver", CameraDriverTest)
