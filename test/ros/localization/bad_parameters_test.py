#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What cannot be is not started with: the log names the parameter, or the line of the map."""

import math
import os
import signal
import subprocess
import tempfile
import unittest

import rospy
import rostest
from ros_probe import WAIT, Recorder
from roslib.packages import find_node

from sextant.msg import MarkerArray

AT_ONCE = 4  # processes
# (parameter, value, text in the log)
DETECTOR = [
    ("siez", 0.2, "unknown parameter /{node}/siez"),
    ("threads", "many", "parameter /{node}/threads must be a whole number"),
    ("threads", 1.5, "parameter /{node}/threads must be a whole number"),
    ("threads", 65, "parameter /{node}/threads is 65, allowed is [1, 64]"),
    ("rate", -1, "parameter /{node}/rate is -1, allowed is [0, 1000] Hz"),
    ("decimate", 0.5, "parameter /{node}/decimate is 0.5, allowed is [1, 8]"),
    ("decimate", math.nan, "parameter /{node}/decimate is nan, allowed is [1, 8]"),
    ("corner_sigma", 0, "parameter /{node}/corner_sigma is 0, allowed is (0, 10] px"),
    ("rectified", 1, "parameter /{node}/rectified must be true or false"),
    ("families", "tag36h11", "parameter /{node}/families must be a list of strings"),
    ("families", [], "parameter /{node}/families is empty"),
    ("families", ["tag99h99"], "parameter /{node}/families: unknown marker family 'tag99h99'"),
    ("marker_size", -0.1, "parameter /{node}/marker_size is -0.1"),
    ("marker_sizes", {"5": "large"}, "parameter /{node}/marker_sizes must be a table of names and numbers"),
    ("marker_sizes", {"five": 0.1}, "parameter /{node}/marker_sizes: 'five' is not a marker"),
    ("debug_quality", 0, "parameter /{node}/debug_quality is 0, allowed is [1, 100]"),
]
LOCATOR = [
    ("publish_tf", True, "unknown parameter /{node}/publish_tf"),
    ("mode", "best", "parameter /{node}/mode is 'best', allowed is one of average, joint, nearest"),
    ("mode", 3, "parameter /{node}/mode must be a text"),
    ("tf_output", "odom", "parameter /{node}/tf_output is 'odom'"),
    ("max_reprojection_error", 0, "parameter /{node}/max_reprojection_error is 0"),
    ("transform_timeout", 11, "parameter /{node}/transform_timeout is 11, allowed is [0, 10] s"),
    ("cameras", [], "parameter /{node}/cameras is empty"),
    ("cameras", ["front markers"], "parameter /{node}/cameras: 'front markers' is not a topic name"),
    ("sizes", {"five": 0.1}, "sizes: 'five' is not a marker id"),
    ("map_file", "/nowhere/map.txt", "/nowhere/map.txt"),
]
SLAM = [
    ("mode", "joint", "unknown parameter /{node}/mode"),
    ("gate", 1.0, "parameter /{node}/gate is 1, allowed is [0.5, 1"),
    ("new_landmark_gate", 0.9, "parameter /{node}/new_landmark_gate is 0.9"),
    ("scale_sigma", 2, "parameter /{node}/scale_sigma is 2, allowed is [0, 1]"),
    ("candidate_observations", 2.5, "parameter /{node}/candidate_observations must be a whole number"),
    ("candidate_max_age", 0, "parameter /{node}/candidate_max_age is 0, allowed is (0, 3600] s"),
    ("match_inlier_probability", 1, "parameter /{node}/match_inlier_probability is 1"),
    ("max_range", -1, "parameter /{node}/max_range is -1, allowed is (0, 1000] m"),
    ("rotation_from_rotation", 11, "parameter /{node}/rotation_from_rotation is 11, allowed is [0, 10] rad"),
    ("lag", 0, "parameter /{node}/lag is 0, allowed is (0, 60] s"),
    ("tilt_sigma", math.nan, "parameter /{node}/tilt_sigma is nan"),
    ("lost_after", -1, "parameter /{node}/lost_after is -1"),
    ("cameras", ["front markers"], "parameter /{node}/cameras: 'front markers' is not a topic name"),
    ("start", "here", "parameter /{node}/start is 'here', allowed"),
    ("start_pose", [1.0, 2.0], "parameter /{node}/start_pose has 2 numbers"),
    ("pose_sigma", [0.1, 0.1, 0.0], "parameter /{node}/pose_sigma is 0, allowed is (0, 1000]"),
    ("odom_frame", "map", "parameter /{node}/map_frame is 'map': map, odometry and"),
    ("tf_output", "odom", "parameter /{node}/tf_output is 'odom'"),
    ("marker_map_file", "/nowhere/map.txt", "/nowhere/map.txt"),
    ("map_file", "/dev/null", "/dev/null"),
]
# What would be found out only after topics are advertised would end the whole manager.
NODELETS = [
    ("sextant/CameraDriver", "rate", -1),
    ("sextant/MarkerDetector", "threads", 0),
    ("sextant/MarkerLocator", "mode", "best"),
    ("sextant/LandmarkSlam", "gate", 2),
    ("sextant/MarkerLocator", "cameras", ["front markers"]),
]
# (name of the file, text, line, reason)
MAPS = [
    ("map.txt", "3 0 0 1 0 0 0\n5 0 0 1 0 0\n", 2, "has 6 fields"),
    ("map.txt", "3 0 0 1 0 0 0 extra\n", 1, "has 8 fields"),
    ("map.txt", "# comment\n\n3 0 0 one 0 0 0\n", 3, "'one' is not a number"),
    ("map.txt", "3 0 0 nan 0 0 0\n", 1, "'nan' is not finite"),
    ("map.txt", "3 0 0 1 0 0 0\nid3 1 0 1 0 0 0\n", 2, "marker 3 (tag36h11): it is listed twice"),
    ("map.txt", "587 0 0 1 0 0 0\n", 1, "marker 587 (tag36h11): the ids of this family are 0 to 586"),
    ("map.txt", "map 0 0 0 0 0 0\n", 1, "'map' is the frame of the map"),
    ("map.yaml", "frame: map\nmarkers:\n  - {id: 3, family: tag36h11, size: 0.2, position: [0, 0]", 3, ""),
    (
        "map.yaml",
        "frame: map\nmarkers:\n"
        "  - {id: 3, family: tag36h11, size: 0.2, position: [0, 0, 0], rpy: [0, 0, 0]}\n"
        "  - {id: 3, family: tag36h11, size: 0.2, position: [1, 0, 0], rpy: [0, 0, 0]}\n",
        4,
        "marker 3 (tag36h11): it is listed twice",
    ),
]


def start(*command):
    return subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True
    )


class BadParametersTest(unittest.TestCase):
    def assert_refused(self, type_, cases):
        """Every case in a node of its own."""
        for begin in range(0, len(cases), AT_ONCE):
            started = []
            for number, (name, value, reason) in enumerate(cases[begin : begin + AT_ONCE], begin):
                node = f"{type_}_{number}"
                rospy.set_param(f"/{node}", {name: value})
                self.addCleanup(rospy.delete_param, f"/{node}")
                started.append(
                    (start(find_node("sextant", type_)[0], "__name:=" + node), reason.format(node=node))
                )
            for process, reason in started:
                self.assert_ended(process, reason)

    def assert_ended(self, process, reason, status=1):
        try:
            log = process.communicate(timeout=WAIT)[0]
        except subprocess.TimeoutExpired:
            process.kill()
            self.fail("it started, but: " + reason)
        self.assertIn(reason, log)
        self.assertEqual(process.returncode, status, log)

    def test_detector(self):
        self.assert_refused("marker_detector", DETECTOR)

    def test_locator(self):
        self.assert_refused("marker_locator", LOCATOR)

    def test_slam(self):
        self.assert_refused("landmark_slam", SLAM)

    def test_malformed_maps_are_refused_with_line_and_reason(self):
        with tempfile.TemporaryDirectory() as folder:
            cases = []
            for number, (name, text, line, reason) in enumerate(MAPS):
                path = os.path.join(folder, f"{number}_{name}")
                with open(path, "w") as file:
                    file.write(text)
                cases.append(("map_file", path, f"{path}:{line}: {reason}"))
            self.assert_refused("marker_locator", cases)

    def load(self, type_, manager, name):
        return start(find_node("nodelet", "nodelet")[0], "load", type_, manager, "__name:=" + name)

    def assert_not_loaded(self, manager):
        rospy.wait_for_service(manager + "/load_nodelet", WAIT)
        for type_, name, value in NODELETS:
            rospy.set_param("/refused", {name: value})
            process = self.load(type_, manager, "refused")
            self.assert_ended(process, "Failed to load nodelet", status=255)
            rospy.delete_param("/refused")

    def test_a_nodelet_that_is_refused_leaves_its_manager_alone(self):
        self.assert_not_loaded("manager")
        loaded = self.load("sextant/MarkerDetector", "manager", "taken")
        self.addCleanup(loaded.wait, WAIT)
        self.addCleanup(loaded.terminate)
        self.assertTrue(Recorder("markers", MarkerArray).connected())

    def test_a_manager_that_refused_nodelets_ends_in_order(self):
        manager = start(find_node("nodelet", "nodelet")[0], "manager", "__name:=refusing")
        self.addCleanup(manager.kill)
        self.assert_not_loaded("refusing")
        manager.send_signal(signal.SIGINT)
        self.assert_ended(manager, "'front markers' is not a topic name", status=0)


if __name__ == "__main__":
    rospy.init_node("bad_parameters_test")
    rostest.rosrun("sextant", "bad_parameters", BadParametersTest)
