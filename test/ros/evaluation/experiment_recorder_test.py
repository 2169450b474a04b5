#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import re
import signal
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np
import rosbag
import rospkg
import rospy
import rostest

PATIENCE = 150.0  # seconds, for 46 simulated ones
EKF = "/odometry/filtered_map"
TOPICS = {"/odom", "/marker_locator/pose", "/odometry/filtered"}
MARKERS_AGAIN = 42.0  # simulated seconds, when the robot has turned and sees markers again after 17 s without


def output_of(command):
    """What a launch file prints until it ends."""
    launch = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        return launch.communicate(timeout=PATIENCE)[0]
    except subprocess.TimeoutExpired:
        launch.send_signal(signal.SIGINT)  # roslaunch ends its nodes
        raise AssertionError(launch.communicate(timeout=40.0)[0]) from None


def positions(bag, topic):
    """(N, 2) x and y by stamp, nanoseconds."""
    messages = (message for _, message, _ in bag.read_messages([topic]))
    return {m.header.stamp.to_nsec(): [m.pose.pose.position.x, m.pose.pose.position.y] for m in messages}


class ExperimentRecorderTest(unittest.TestCase):
    """The launch file as it is, faster and shorter."""

    @classmethod
    def setUpClass(cls):
        with tempfile.TemporaryDirectory() as folder:
            args = [f"output:={folder}/corridor", "frames:=460", "speed:=4.0", "ekf:=true"]
            cls.log = output_of(["roslaunch", "sextant", "corridor_experiment.launch", *args])
            cls.files = {path.name: path.stat().st_size for path in Path(folder).iterdir()}
            with rosbag.Bag(f"{folder}/corridor.bag") as bag:
                topics = bag.get_type_and_topic_info().topics
                cls.drives = {topic: positions(bag, topic) for topic in topics}

    def errors(self, topic, first, last):
        """Metres, in a span of simulated seconds."""
        truth = self.drives["/ground_truth"]
        shared = sorted(self.drives[topic].keys() & truth.keys())
        span = [stamp for stamp in shared if first <= 1e-9 * (stamp - min(truth)) <= last]
        off = np.array([self.drives[topic][stamp] for stamp in span]) - [truth[stamp] for stamp in span]
        return np.hypot(*off.T)

    def test_the_table_has_a_row_of_every_topic(self):
        rows = dict(re.findall(r"corridor\.bag (/\S+): (\d+) poses", self.log))
        self.assertEqual(rows.keys() - {EKF}, TOPICS, self.log)
        self.assertEqual(rows["/odom"], "460")
        self.assertEqual(len(re.findall(r"ATE, m +RMSE", self.log)), len(rows))
        self.assertNotIn("Traceback", self.log)

    def test_the_filter_of_another_package_is_left_out_if_it_is_not_installed(self):
        installed = "robot_localization" in rospkg.RosPack().list()
        self.assertEqual(EKF in self.drives, installed)
        reason = f"rospack does not find robot_localization: {EKF[1:]} is left out"
        self.assertEqual(reason in self.log, not installed, self.log)

    def test_markers_reduce_the_error(self):
        rmse = dict(re.findall(r"corridor\.bag (/\S+):[^\n]*\n +ATE, m +RMSE ([\d.]+)", self.log))
        self.assertLess(float(rmse["/odometry/filtered"]), 0.7 * float(rmse["/odom"]))
        without = self.errors("/odometry/filtered", MARKERS_AGAIN - 5.0, MARKERS_AGAIN - 1.5)
        again = self.errors("/odometry/filtered", MARKERS_AGAIN + 0.5, MARKERS_AGAIN + 2.0)
        self.assertGreater(without.min(), 3.0 * np.median(again))
        self.assertLess(np.median(again), 0.05)

    def test_files(self):
        names = {f"corridor{end}" for end in (".bag", ".csv", ".png", "_bands.png")}
        self.assertEqual(self.files.keys(), names)
        self.assertGreater(min(self.files.values()), 10000)


if __name__ == "__main__":
    rospy.init_node("experiment_recorder_test")
    rostest.rosrun("sextant", "experiment_recorder", ExperimentRecorderTest)
