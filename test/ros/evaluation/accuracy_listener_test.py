#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import os
import re
import subprocess
import tempfile
import threading
import time
import unittest

import numpy as np
import rospy
import rostest
from geometry_msgs.msg import PoseWithCovarianceStamped, TransformStamped
from nav_msgs.msg import Odometry
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage

from sextant.srv import MeasureAccuracy

SIGMA, BIAS, PUBLISHED = 0.02, 0.05, 0.03  # m
PLACE = 1.5


class AccuracyListenerTest(unittest.TestCase):
    """A robot that stands at x = 1.5 m, whose poses are 5 cm too far and scatter by 2 cm."""

    def setUp(self):
        self.random = np.random.default_rng(1)
        self.place, self.swing = 4.0, 0.0  # it stood elsewhere before
        self.has_odometry = True
        self.pose = rospy.Publisher("pose", PoseWithCovarianceStamped, queue_size=100)
        self.truth = rospy.Publisher("ground_truth", Odometry, queue_size=100)
        self.tf = rospy.Publisher("/tf", TFMessage, queue_size=100)
        self.ended = threading.Event()
        thread = threading.Thread(target=self.publish)
        thread.start()
        self.addCleanup(thread.join)
        self.addCleanup(self.ended.set)

    def start(self, *params):
        folder = tempfile.mkdtemp()
        command = ["rosrun", "sextant", "accuracy_listener", "__name:=listener", "_axis:=x", *params]
        output = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
        node = subprocess.Popen(command, cwd=folder, **output)
        self.addCleanup(node.communicate, timeout=20)
        self.addCleanup(node.terminate)
        return folder, node

    def service(self, name, type_):
        rospy.wait_for_service(name, 30.0)
        return rospy.ServiceProxy(name, type_)

    def publish(self):
        while not self.ended.wait(0.02):
            now = rospy.Time.now()
            message = PoseWithCovarianceStamped()
            message.header.stamp, message.header.frame_id = now, "map"
            place = message.pose.pose.position
            at = self.place + self.swing * np.sin(4.0 * now.to_sec())
            place.x, place.y, place.z = [at + BIAS, 0.0, 0.3] + SIGMA * self.random.normal(size=3)
            message.pose.pose.orientation.w = 1.0
            message.pose.covariance = np.diag([PUBLISHED**2] * 6).ravel()
            true = Odometry()
            true.header, true.pose.pose.position.x, true.pose.pose.orientation.w = message.header, at, 1.0
            frame = TransformStamped(header=message.header, child_frame_id="base_truth")
            frame.transform.translation.x, frame.transform.rotation.w = at, 1.0
            if self.has_odometry:
                self.truth.publish(true)
            self.tf.publish(TFMessage([frame]))
            self.pose.publish(message)

    def test_measured_places(self):
        folder, _ = self.start("_true:={y: 0.0}", "_output:=run")
        with open(os.path.join(folder, "run.yaml"), "w") as file:
            file.write("corner_sigma: 0.2")  # of an earlier accuracy_statistics
        measure = self.service("listener/measure", MeasureAccuracy)
        write = self.service("listener/write", Trigger)
        self.assertIn("there is no measurement yet", write().message)
        self.assertFalse(measure(PLACE, 0.0).success)
        refused = measure(np.nan, 1.0)
        self.assertFalse(refused.success)
        self.assertTrue(np.isnan(refused.mean).all())
        time.sleep(1.0)  # poses of the other place are received
        self.place = PLACE
        time.sleep(0.2)
        answer = measure(PLACE, 4.0)
        self.assertTrue(answer.success, answer.message)
        self.assertGreater(answer.poses, 100)
        np.testing.assert_allclose(answer.bias[:2], [BIAS, 0.0], atol=0.01)
        self.assertTrue(np.isnan(answer.bias[2]))
        np.testing.assert_allclose(answer.std[:3], SIGMA, rtol=0.3)
        np.testing.assert_allclose(answer.published[:3], PUBLISHED, rtol=1e-6)
        np.testing.assert_allclose(np.diag(np.reshape(answer.covariance, (6, 6)))[:3], SIGMA**2, rtol=0.6)
        self.assertIn("x = 1.5 m", answer.message)
        written = write()
        self.assertTrue(written.success, written.message)
        files = ["run.html", "run.xlsx", "run.yaml", "run_errors.png", "run_spread.png"]
        self.assertEqual(sorted(os.listdir(folder)), files)
        self.assertIn("run.yaml: left from an earlier run", written.message)
        self.assertIn("roll, pitch, yaw have no variance", written.message)
        self.assertTrue(self.service("listener/reset", Trigger)().success)
        self.assertFalse(write().success)

    def test_against_a_truth(self):
        self.swing = 1.0  # metres: poses and truths of other stamps would not fit
        for params in ([], ["_truth_frame:=/base_truth"]):
            self.has_odometry = not params
            _, node = self.start(*params)
            compare = self.service("listener/compare", Trigger)
            self.service("listener/measure", MeasureAccuracy)(PLACE, 3.0)
            answer = compare()
            self.assertTrue(answer.success, answer.message)
            rmse = float(re.search(r"ATE, m +RMSE ([\d.]+)", answer.message).group(1))
            self.assertAlmostEqual(rmse, np.sqrt(BIAS**2 + 0.3**2 + 3 * SIGMA**2), delta=0.01)
            self.assertIn("NEES", answer.message)
            node.terminate()
            node.wait(20)

    def test_parameters_that_cannot_be(self):
        for params, reason in (
            (["_true:={x: 1.0}"], "the true x is the distance"),
            (["_true:={w: 1.0}"], "'w' is not an axis"),
            (["_axis:=w"], "must be one of x, y, z"),
            (["_axes:=x"], "unknown parameter"),
        ):
            _, node = self.start(*params)
            out, _ = node.communicate(timeout=30)
            self.assertEqual(node.returncode, 1)
            self.assertIn(reason, out)


if __name__ == "__main__":
    rospy.init_node("accuracy_listener_test")
    rostest.rosrun("sextant", "accuracy_listener", AccuracyListenerTest)
