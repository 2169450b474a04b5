#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameters that change while the nodelets run, by dynamic_reconfigure; and their diagnostics."""

import threading
import unittest

import numpy as np
import rospy
import rostest
from dynamic_reconfigure import DynamicReconfigureCallbackException
from dynamic_reconfigure.client import Client
from geometry_msgs.msg import PoseWithCovarianceStamped
from marker_scene import camera_info, image_msg, picture
from ros_probe import WAIT, Diagnostics, Recorder, stamps, until
from sensor_msgs.msg import CameraInfo, CompressedImage, Image

from sextant.msg import MarkerArray

DETECTOR, LOCATOR = "detector: detection", "locator: localization"


class ReconfigureTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.picture = picture()
        cls.stamps = stamps()
        cls.diagnostics = Diagnostics()
        cls.infos = rospy.Publisher("camera_info", CameraInfo, queue_size=1, latch=True)
        cls.infos.publish(camera_info())
        cls.images = rospy.Publisher("image", Image, queue_size=10)
        cls.detector = Client("detector", timeout=WAIT)
        cls.locator = Client("locator", timeout=WAIT)
        cls.markers = Recorder("markers", MarkerArray)
        cls.poses = Recorder("pose", PoseWithCovarianceStamped)

    def show(self):
        stamp = next(self.stamps)
        self.images.publish(image_msg(self.picture, stamp))
        return stamp

    def answer(self, recorder):
        """The next message, of the first image that is looked at."""

        def answered():
            self.answered = recorder.at(self.show(), 0.3)
            return self.answered is not None

        self.assertTrue(until(answered))
        return self.answered

    def change(self, client, **values):
        """Changes the values for this test alone."""
        before = client.get_configuration(timeout=WAIT)
        self.addCleanup(client.update_configuration, {name: before[name] for name in values})
        return client.update_configuration(values)

    def refuse(self, client, node, **values):
        before = client.get_configuration(timeout=WAIT)
        refusals = self.diagnostics.count(node, "not used: reconfiguration")
        with self.assertRaises(DynamicReconfigureCallbackException):
            client.update_configuration(values)
        self.assertTrue(self.diagnostics.reaches(node, "not used: reconfiguration", refusals + 1))
        self.assertEqual(client.get_configuration(timeout=WAIT), before)

    def test_a_first_look_finds_what_the_parameter_server_has(self):
        """Comes first by its name: a change writes what was taken to the parameter server."""
        self.assertEqual(self.detector.get_configuration(timeout=WAIT)["marker_size"], 0.25)
        self.assertEqual(self.detector.get_configuration()["decimate"], 1.0)
        self.assertEqual(self.locator.get_configuration(timeout=WAIT)["max_reprojection_error"], 7.0)
        self.assertEqual(rospy.get_param("locator/max_reprojection_error"), 7)  # as it was written, not 7.0
        self.assertFalse(rospy.has_param("detector/decimate"))

    def test_no_more_images_are_searched_than_asked_for(self):
        self.answer(self.markers)
        self.change(self.detector, rate=10.0)
        shown, camera = [], rospy.Rate(30)
        for _ in range(90):
            shown.append(self.show())
            camera.sleep()
        self.assertTrue(until(lambda: any(map(self.markers.has, shown[-4:]))))
        searched = sum(map(self.markers.has, shown))
        self.assertTrue(28 <= searched <= 32, f"{searched} of 90")
        self.assertTrue(until(lambda: 0 < self.diagnostics.count(DETECTOR, "detection: runs") <= 11))

    def test_size_of_the_markers_changes(self):
        seen = [marker.pose.pose.position.z for marker in self.answer(self.markers).markers]
        changed = self.change(self.detector, marker_size=0.5)
        self.assertEqual(changed["marker_size"], 0.5)
        self.assertEqual(rospy.get_param("detector/marker_size"), 0.5)
        now = [marker.pose.pose.position.z for marker in self.answer(self.markers).markers]
        np.testing.assert_allclose(now, 2 * np.array(seen), rtol=1e-3)

    def test_the_search_changes_and_keeps_its_subscriptions(self):
        self.assertEqual(len(self.answer(self.markers).markers), 2)
        connections = self.images.get_num_connections()
        lost = threading.Event()
        listener = rospy.SubscribeListener()
        listener.peer_unsubscribe = lambda *_: lost.set()
        self.images.impl.add_subscriber_listener(listener)
        self.change(self.detector, min_decision_margin=255.0)
        self.assertEqual(self.answer(self.markers).markers, [])
        self.assertEqual(self.images.get_num_connections(), connections)
        self.assertFalse(lost.is_set())

    def test_the_locator_changes(self):
        self.answer(self.poses)
        self.change(self.locator, estimate_noise=False, corner_sigma=0.3)
        small = np.array(self.answer(self.poses).pose.covariance)
        self.change(self.locator, corner_sigma=0.6)
        large = np.array(self.answer(self.poses).pose.covariance)
        np.testing.assert_allclose(large, 4 * small, rtol=0.05, atol=1e-3 * large.max())

    def test_bad_values_are_refused_and_the_old_ones_stay(self):
        self.refuse(self.detector, DETECTOR, decimate=9.0)
        self.refuse(self.detector, DETECTOR, marker_size=0.5, debug_quality=101)
        self.assertEqual(rospy.get_param("detector/marker_size"), 0.25)
        self.assertEqual({marker.size for marker in self.answer(self.markers).markers}, {0.25})
        self.refuse(self.locator, LOCATOR, mode="best")
        self.refuse(self.locator, LOCATOR, gate=float("nan"))
        self.answer(self.poses)

    def test_changes_in_the_midst_of_images(self):
        """Two clients and the images at once: nothing is lost, and the last values count."""
        answers = len(self.markers.all())
        for i in range(40):
            self.change(self.detector, decimate=1.0 + i % 2)
            self.change(self.locator, corner_sigma=0.2 + 0.01 * i)
            self.show()
        self.assertTrue(until(lambda: len(self.markers.all()) > answers + 10))
        self.assertEqual(rospy.get_param("detector/decimate"), 2.0)
        self.assertAlmostEqual(rospy.get_param("locator/corner_sigma"), 0.59)

    def test_nothing_is_drawn_or_encoded_without_a_listener(self):
        self.answer(self.markers)
        self.assertTrue(self.runs_reach("detection"))
        self.assertEqual(self.runs("debug image"), 0)
        pictures = Recorder("markers/image", Image)
        self.addCleanup(pictures.close)
        self.assertTrue(pictures.connected())
        self.assertEqual(self.answer(pictures).width, 160)
        self.assertTrue(self.runs_reach("debug image"))
        self.assertEqual(self.runs("debug image as JPEG"), 0)
        jpegs = Recorder("markers/image/compressed", CompressedImage)
        self.addCleanup(jpegs.close)
        self.assertTrue(jpegs.connected())
        self.answer(jpegs)
        self.assertTrue(self.runs_reach("debug image as JPEG"))

    def runs(self, stage):
        return self.diagnostics.count(DETECTOR, stage + ": runs")

    def runs_reach(self, stage):
        return until(lambda: self.show() and self.runs(stage) > 0)

    def test_diagnostics_of_the_detector(self):
        self.answer(self.markers)
        self.assertTrue(until(lambda: self.show() and float(self.row("rate (Hz)") or 0) > 0))
        self.assertEqual(self.row("markers per image: mean"), "2.00")
        self.assertEqual(self.row("images without a marker (%)"), "0.0")
        self.assertLess(float(self.row("reprojection error, each marker on its own: RMS (px)")), 0.1)
        # The stamps here are made up, up to seconds ahead of the clock.
        self.assertLess(abs(float(self.row("latency since the image's stamp: mean ms"))), 60e3)
        self.infos.publish(camera_info(width=320))
        self.addCleanup(self.infos.publish, camera_info())
        self.assertTrue(until(lambda: self.show() and self.row("images not used (%)") == "100.0"))
        self.infos.publish(camera_info())
        self.assertTrue(until(lambda: self.show() and self.row("images not used (%)") == "0.0"))

    def row(self, key):
        return self.diagnostics.row(DETECTOR, key)


if __name__ == "__main__":
    rospy.init_node("reconfigure_test")
    rostest.rosrun("sextant", "reconfigure", ReconfigureTest)
