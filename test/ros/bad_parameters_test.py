#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A node that was given what cannot be does not start, and says which parameter, or which line of the map, it is."""
import os
import subprocess
import tempfile
import unittest

import rospy
import rostest
from nodelet.srv import NodeletList, NodeletLoad
from ros_probe import WAIT

AT_ONCE = 4  # processes
DETECTOR = [
    ("_siez:=0.2", "unknown parameter /{node}/siez"),
    ("_threads:=many", "parameter /{node}/threads must be a whole number"),
    ("_threads:=1.5", "parameter /{node}/threads must be a whole number"),
    ("_threads:=65", "parameter /{node}/threads is 65, allowed is [1, 64]"),
    ("_decimate:=0.5", "parameter /{node}/decimate is 0.5, allowed is [1, 8]"),
    ("_decimate:=.nan", "parameter /{node}/decimate is nan"),
    ("_corner_sigma:=0", "parameter /{node}/corner_sigma must be in (0, 10] px"),
    ("_rectified:=1", "parameter /{node}/rectified must be true or false"),
    ("_families:=tag36h11", "parameter /{node}/families must be a list of texts"),
    ("_families:=[]", "parameter /{node}/families is empty"),
    ("_families:=[tag99h99]", "parameter /{node}/families: unknown marker family 'tag99h99'"),
    ("_marker_size:=-0.1", "parameter /{node}/marker_size is -0.1"),
    ("_marker_sizes:={'5': large}", "parameter /{node}/marker_sizes must be a table of names and numbers"),
    ("_marker_sizes:={'five': 0.1}", "parameter /{node}/marker_sizes: 'five' names no marker"),
    ("_debug_quality:=0", "parameter /{node}/debug_quality must be in [1, 100]"),
]
LOCATOR = [
    ("_publish_tf:=true", "unknown parameter /{node}/publish_tf"),
    ("_mode:=best", "parameter /{node}/mode is 'best', allowed are nearest, average and joint"),
    ("_mode:=3", "parameter /{node}/mode must be a text"),
    ("_tf_output:=odom", "parameter /{node}/tf_output is 'odom'"),
    ("_max_reprojection_error:=0", "parameter /{node}/max_reprojection_error is 0"),
    ("_transform_timeout:=11", "parameter /{node}/transform_timeout must be in [0, 10] s"),
    ("_cameras:=[]", "parameter /{node}/cameras is empty"),
    ("_sizes:={'five': 0.1}", "sizes: 'five' is no marker id"),
    ("_map_file:=/nowhere/map.txt", "/nowhere/map.txt"),
]
# (name of the file, text, line, reason)
MAPS = [
    ("map.txt", "3 0 0 1 0 0 0\n5 0 0 1 0 0\n", 2, "has 6 fields"),
    ("map.txt", "3 0 0 1 0 0 0 extra\n", 1, "has 8 fields"),
    ("map.txt", "# comment\n\n3 0 0 one 0 0 0\n", 3, "'one' is not a number"),
    ("map.txt", "3 0 0 nan 0 0 0\n", 1, "'nan' is not finite"),
    ("map.txt", "3 0 0 1 0 0 0\nid3 1 0 1 0 0 0\n", 2, "it is there twice"),
    ("map.txt", "587 0 0 1 0 0 0\n", 1, "the family's ids are 0 to 586"),
    ("map.txt", "map 0 0 0 0 0 0\n", 1, "'map' is the map's own frame"),
    ("map.yaml", "frame: map\nmarkers:\n  - {id: 3, family: tag36h11, size: 0.2, position: [0, 0]", 3, ""),
    (
        "map.yaml",
        "frame: map\nmarkers:\n"
        "  - {id: 3, family: tag36h11, size: 0.2, position: [0, 0, 0], rpy: [0, 0, 0]}\n"
        "  - {id: 3, family: tag36h11, size: 0.2, position: [1, 0, 0], rpy: [0, 0, 0]}\n",
        4,
        "it is there twice",
    ),
]


def start(type_, node, argument):
    return subprocess.Popen(
        ["rosrun", "sextant", type_, "__name:=" + node, argument],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        universal_newlines=True,
    )


class BadParametersTest(unittest.TestCase):
    def assert_refused(self, type_, cases):
        """@param cases (argument, what the log must have) """
        for begin in range(0, len(cases), AT_ONCE):
            started = []
            for number, (argument, reason) in enumerate(cases[begin : begin + AT_ONCE], begin):
                node = f"{type_}_{number}"
                started.append((start(type_, node, argument), argument, reason.format(node=node)))
            for process, argument, reason in started:
                self.assert_ended(process, argument, reason)

    def assert_ended(self, process, argument, reason):
        try:
            log = process.communicate(timeout=WAIT)[0]
        except subprocess.TimeoutExpired:
            process.kill()
            self.fail(argument + " was taken: " + process.communicate()[0])
        self.assertEqual(process.returncode, 1, argument + ": " + log)
        self.assertIn(reason, log)

    def test_detector(self):
        self.assert_refused("marker_detector", DETECTOR)

    def test_locator(self):
        self.assert_refused("marker_locator", LOCATOR)

    def test_malformed_maps_are_refused_with_line_and_reason(self):
        with tempfile.TemporaryDirectory() as folder:
            cases = []
            for number, (name, text, line, reason) in enumerate(MAPS):
                path = os.path.join(folder, f"{number}_{name}")
                with open(path, "w") as file:
                    file.write(text)
                cases.append((path, line, reason))
            self.assert_refused("marker_locator", [("_map_file:=" + path, f"{path}:{line}: ") for path, line, _ in cases])
            self.assert_refused("marker_locator", [("_map_file:=" + path, reason) for path, _, reason in cases])

    def test_a_nodelet_that_is_refused_leaves_its_manager_alone(self):
        rospy.wait_for_service("manager/load_nodelet", WAIT)
        load = rospy.ServiceProxy("manager/load_nodelet", NodeletLoad)
        rospy.set_param("/refused", {"threads": 0, "mode": "best"})
        for type_ in ["sextant/MarkerDetector", "sextant/MarkerLocator"]:
            with self.assertRaises(rospy.ServiceException):
                load("/refused", type_, [], [], [], "")
        rospy.delete_param("/refused")
        self.assertTrue(load("/refused", "sextant/MarkerDetector", [], [], [], "").success)
        self.assertEqual(rospy.ServiceProxy("manager/list", NodeletList)().nodelets, ["/refused"])


if __name__ == "__main__":
    rospy.init_node("bad_parameters_test")
    rostest.rosrun("sextant", "bad_parameters", BadParametersTest)
