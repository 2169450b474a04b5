#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import os
import subprocess
import tempfile
import unittest

import cv2
import numpy as np
import rospy
import rostest
from geometry_msgs.msg import Point, Pose, PoseWithCovariance, Quaternion
from opencv_aruco import opencv_detector
from ros_probe import WAIT
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray

from sextant.msg import MarkerMapEntries, MarkerMapEntry
from sextant.srv import AddMarker

HALF = np.sqrt(0.5)
TEXT_MAP = """# name Tx Ty Tz Rx Ry Rz
Id7 1 2 3 0 0 1.5707963267948966
9 -1 0 0.5 1.5707963267948966 0 0
camera 0.1 0 0.5 0 0 0
"""
YAML_MAP = """frame: map
markers:
  - {id: 7, family: DICT_4X4_50, size: 0.3, position: [1, 2, 2.5], rpy: [0, 0, 0]}
"""
TEXT_PARAMS = ["_family:=DICT_4X4_50", "_size:=0.3", "_sizes:={'9': 0.1}", "_parents:={camera: base_link}"]


def command(*args):
    return ["rosrun", "sextant", "marker_broadcaster", *args]


class MarkerBroadcasterTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = os.path.join(self.folder.name, "map.txt")

    def start(self, text=TEXT_MAP, params=TEXT_PARAMS, name="map.txt"):
        self.path = os.path.join(self.folder.name, name)
        self.write(text)
        node = subprocess.Popen(command("__name:=broadcaster", "_map_file:=" + self.path, *params))
        self.addCleanup(self.stop, node)
        rospy.wait_for_service("broadcaster/add_marker", WAIT)  # the last one that is advertised

    def stop(self, node):
        node.terminate()
        node.wait(WAIT)
        rospy.delete_param("/broadcaster")

    def write(self, text):
        with open(self.path, "w") as file:
            file.write(text)

    def entries(self):
        message = rospy.wait_for_message("marker_map/entries", MarkerMapEntries, WAIT)
        return {entry.id: entry for entry in message.markers}

    def transforms(self):
        message = rospy.wait_for_message("/tf_static", TFMessage, WAIT)
        return {each.child_frame_id: each for each in message.transforms}

    def reload(self):
        return rospy.ServiceProxy("broadcaster/reload", Trigger)()

    def add(self, entry, save=False):
        return rospy.ServiceProxy("broadcaster/add_marker", AddMarker)(entry, save)

    def test_transforms_have_the_names_parents_and_poses_of_the_file(self):
        self.start()
        transforms = self.transforms()
        self.assertEqual(
            {name: each.header.frame_id for name, each in transforms.items()},
            {"Id7": "map", "9": "map", "camera": "base_link"},
        )
        pose = transforms["Id7"].transform
        self.assertEqual([pose.translation.x, pose.translation.y, pose.translation.z], [1.0, 2.0, 3.0])
        q = transforms["Id7"].transform.rotation
        np.testing.assert_allclose([q.x, q.y, q.z, q.w], [0, 0, HALF, HALF], atol=1e-9)
        q = transforms["9"].transform.rotation
        np.testing.assert_allclose([q.x, q.y, q.z, q.w], [HALF, 0, 0, HALF], atol=1e-9)

    def test_the_locator_receives_every_marker_with_its_size(self):
        self.start()
        message = rospy.wait_for_message("marker_map/entries", MarkerMapEntries, WAIT)
        self.assertEqual(message.header.frame_id, "map")
        self.assertEqual(
            [(each.family, each.id, each.size, each.name) for each in message.markers],
            [("DICT_4X4_50", 7, 0.3, "Id7"), ("DICT_4X4_50", 9, 0.1, "9")],
        )

    def test_boards_can_be_read_by_a_detector(self):
        self.start()
        drawn = rospy.wait_for_message("marker_map", MarkerArray, WAIT).markers
        self.assertEqual(drawn[0].action, Marker.DELETEALL)
        boards = [each for each in drawn if each.type == Marker.TRIANGLE_LIST]
        board = next(each for each in boards if each.pose.position.x == 1.0)
        picture = front_view(board, pixels_per_metre=500)
        found = opencv_detector("DICT_4X4_50")(picture)
        self.assertEqual(list(found), [7])
        # 0.3 m in the middle of 1 m, top left first: upright
        square = [[174.5, 174.5], [324.5, 174.5], [324.5, 324.5], [174.5, 324.5]]
        np.testing.assert_allclose(found[7], square, atol=2)
        self.assertEqual([each.text for each in drawn if each.type == Marker.TEXT_VIEW_FACING], ["7", "9"])

    def test_reload_takes_the_new_file(self):
        self.start()
        self.write("8 0 0 1 0 0 0\n")
        self.assertTrue(self.reload().success)
        self.assertEqual(list(self.transforms()), ["8"])
        self.assertEqual(list(self.entries()), [8])

    def test_reload_of_a_malformed_file_changes_nothing(self):
        self.start()
        self.write("8 0 0 1 0 0 0\n9 0 0 nonsense 0 0 0\n")
        answer = self.reload()
        self.assertFalse(answer.success)
        self.assertIn(self.path + ":2: ", answer.message)
        self.assertEqual(list(self.entries()), [7, 9])

    def test_a_marker_is_added_saved_and_there_when_the_file_is_read_again(self):
        self.start(YAML_MAP, [], name="map.yaml")
        answer = self.add(entry_of(3), save=True)
        self.assertTrue(answer.success, answer.message)
        self.assertEqual(self.entries()[3].name, "DICT_4X4_50/3")
        self.assertTrue(self.reload().success)
        heights = {id: entry.pose.pose.position.z for id, entry in self.entries().items()}
        self.assertEqual(heights, {3: 1.0, 7: 2.5})

    def test_what_the_file_cannot_hold_is_neither_saved_nor_added(self):
        self.start()
        entry = entry_of(3, name="Id3")
        entry.size = 0.77  # would come back as the parameter's
        answer = self.add(entry, save=True)
        self.assertFalse(answer.success)
        self.assertIn("the plain text format cannot represent", answer.message)
        self.assertEqual(list(self.entries()), [7, 9])

    def test_an_added_marker_that_is_not_saved_leaves_the_file_alone(self):
        self.start()
        self.assertTrue(self.add(entry_of(3)).success)
        self.assertEqual(list(self.entries()), [3, 7, 9])
        with open(self.path) as file:
            self.assertEqual(file.read(), TEXT_MAP)

    def test_what_is_no_marker_is_not_added(self):
        self.start()
        refused = {
            "family": entry_of(3, family="DICT_4X4_51"),
            "id": entry_of(50),
            "size": entry_of(3, size=0.0),
            "quaternion": entry_of(3, q=(0.0, 0.0, 0.0, 0.0)),
            "Id7": entry_of(3, name="Id7"),
        }
        for reason, entry in refused.items():
            answer = self.add(entry, save=True)
            self.assertFalse(answer.success, reason)
            self.assertIn(reason, answer.message)
        self.assertEqual(list(self.entries()), [7, 9])

    def test_what_stops_the_start_up_is_named(self):
        self.write("7 0 0 1 0 0\n")
        given = ["_map_file:=" + self.path]
        for args, reason in [
            ([], "/refused/map_file: required"),
            (given, self.path + ":1: "),
            ([*given, "_siez:=0.2"], "/refused/siez: unknown parameter; did you mean size?"),
            ([*given, "_size:=large"], "/refused/size: must be a finite number"),
            ([*given, "_size:=-1.0"], "size"),
            ([*given, "_sizes:={seven: 0.2}"], "/refused/sizes: must have marker ids as keys"),
        ]:
            ended = subprocess.run(
                command("__name:=refused", *args),
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                timeout=WAIT,
            )
            self.assertEqual(ended.returncode, 1, ended.stdout)
            self.assertIn(reason, ended.stdout)
            if rospy.has_param("/refused"):
                rospy.delete_param("/refused")


def entry_of(id, family="DICT_4X4_50", size=0.3, q=(0.0, 0.0, 0.0, 1.0), name=""):
    pose = Pose(Point(0, 0, 1), Quaternion(*q))
    return MarkerMapEntry(family, id, size, name, PoseWithCovariance(pose=pose))


def front_view(board, pixels_per_metre):
    """Picture of 1 m x 1 m around the board's centre as one stands before it, the nearer on top."""
    points = np.array([(p.x, p.y, p.z) for p in board.points]).reshape(-1, 3, 3)
    greys = np.array([c.r for c in board.colors]).reshape(-1, 3)[:, 0]
    picture = np.full((pixels_per_metre, pixels_per_metre), 128, np.uint8)
    for index in np.argsort(points[:, :, 2].min(axis=1), kind="stable"):
        triangle = (points[index, :, :2] * [1, -1] + 0.5) * pixels_per_metre - 0.5
        cv2.fillConvexPoly(picture, np.round(triangle).astype(np.int32), int(255 * greys[index]))
    return picture


if __name__ == "__main__":
    rospy.init_node("marker_broadcaster_test")
    rostest.rosrun("sextant", "marker_broadcaster", MarkerBroadcasterTest)
