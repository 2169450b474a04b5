#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import math
import os
import subprocess
import tempfile
import unittest
from pathlib import Path
from urllib.parse import unquote, urlparse

import numpy as np
import rospy
import rostest
from PIL import Image as Picture
from ros_probe import Recorder, stamps, until
from sensor_msgs.msg import Image
from std_msgs.msg import Header
from std_srvs.srv import Trigger
from visualization_msgs.msg import Marker, MarkerArray

from sextant.msg import Places
from sextant.places.place_picture import PLACE
from sextant.places.probability_scale import probability_colour

WAIT = 20.0
# 40 m x 20 m, turned by a quarter to the left; the overview is shown at twice its size
METRIC = "frame=town;resolution=0.1;origin=7,3," + repr(math.pi / 2)
EXACT = {1: (50, 50), 2: (150, 50), 3: (250, 150), 4: (350, 150)}
CLUSTERS = {1: (100, 50), 2: (100, 50), 3: (300, 150), 4: (300, 150)}


def command(*args):
    return ["rosrun", "sextant", "place_visualizer", *args]


class PlaceVisualizerTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="a town ")
        self.addCleanup(folder.cleanup)
        self.folder, self.stamps = Path(folder.name), stamps()
        Picture.new("RGB", (400, 200), (90, 200, 90)).save(self.folder / "park.png")
        self.places = rospy.Publisher("places", Places, queue_size=100)

    def write(self, name, positions, *fields):
        lines = [";".join(["park.png;400;200", *fields])]
        lines += [f"{number};{number}.jpg;{x};{y}" for number, (x, y) in positions.items()]
        (self.folder / name).write_text("\n".join(lines) + "\n")
        return "_map_file:=" + str(self.folder / name)

    def start(self, name, *args):
        """A visualizer in a namespace, with what it says."""
        log = open(self.folder / f"{name}.log", "w")  # noqa: SIM115
        namespace = [f"__ns:=/{name}", "__name:=view", "places:=/places"]
        node = subprocess.Popen(command(*namespace, *args), stdout=log, stderr=log)
        self.addCleanup(self.stop, node, name, log)
        rospy.wait_for_service(f"/{name}/view/reload", WAIT)
        return Recorder(f"/{name}/places/image", Image)

    def stop(self, node, name, log):
        node.terminate()
        node.wait(WAIT)
        log.close()
        rospy.delete_param(f"/{name}/view")

    def log(self, name):
        return (self.folder / f"{name}.log").read_text()

    def say(self, *answer, frame="camera"):
        stamp = next(self.stamps)
        ids, probabilities = zip(*answer) if answer else ((), ())
        self.places.publish(Places(Header(stamp=stamp, frame_id=frame), ids, probabilities))
        return stamp

    def connected(self, count):
        self.assertTrue(until(lambda: self.places.get_num_connections() >= count))

    def picture(self, message):
        self.assertIsNotNone(message)
        self.assertEqual((message.encoding, message.step), ("rgb8", 3 * message.width))
        return np.frombuffer(message.data, np.uint8).reshape(message.height, message.width, 3)

    def colour(self, message, position):
        return tuple(self.picture(message)[2 * position[1], 2 * position[0]].tolist())

    def test_whoever_looks_sees_the_map_at_once_and_later_the_last_answer(self):
        images = self.start("early", self.write("map.txt", EXACT))
        self.assertTrue(until(images.all))
        for position in EXACT.values():
            self.assertEqual(self.colour(images.all()[0], position), PLACE)
        images.close()
        self.connected(1)
        stamp = self.say((3, 0.7))
        late = Recorder("/early/places/image", Image)
        self.assertEqual(self.colour(late.at(stamp), EXACT[3]), probability_colour(0.7))

    def test_several_maps_show_the_same_answers(self):
        exact = self.start("exact", self.write("exact.txt", EXACT))
        clusters = self.start("clusters", self.write("clusters.txt", CLUSTERS))
        self.assertTrue(exact.connected() and clusters.connected())
        self.connected(2)
        stamp = self.say((2, 0.6), (3, 0.3))
        for images, positions in ((exact, EXACT), (clusters, CLUSTERS)):
            message = images.at(stamp)
            self.assertEqual(message.header.frame_id, "camera")
            self.assertEqual(self.colour(message, positions[2]), probability_colour(np.float32(0.6)))
            self.assertEqual(self.colour(message, positions[3]), probability_colour(np.float32(0.3)))

    def test_what_cannot_be_shown_is_said_and_the_next_answer_is_shown(self):
        images = self.start("strange", self.write("map.txt", EXACT), "_rate:=100")
        self.assertTrue(images.connected())
        self.connected(1)
        unknown = self.say((77, 0.5), (1, 0.4))
        self.assertEqual(self.colour(images.at(unknown), EXACT[1]), probability_colour(np.float32(0.4)))
        self.assertTrue(until(lambda: "does not have, they are not shown: 77" in self.log("strange")))
        self.places.publish(Places(Header(stamp=next(self.stamps)), [1, 2], [0.5]))
        self.assertTrue(until(lambda: "2 places with 1 probabilities" in self.log("strange")))
        nowhere = self.say((0, 0.0))
        self.assertEqual(self.colour(images.at(nowhere), EXACT[2]), PLACE)

    def test_the_newest_answer_wins(self):
        images = self.start("fast", self.write("map.txt", EXACT), "_rate:=5")
        self.assertTrue(images.connected())
        self.connected(1)
        said = [self.say((1 + i % 4, 0.5)) for i in range(60)]
        self.assertIsNotNone(images.at(said[-1]))
        self.assertLess(len(images.all()), 10)

    def test_rviz_gets_the_overview_and_dots_in_the_metric_frame(self):
        self.start("metric", self.write("map.txt", EXACT, METRIC))
        _, overview, dots = rospy.wait_for_message("/metric/places/map", MarkerArray, WAIT).markers
        self.assertEqual((overview.type, overview.header.frame_id), (Marker.MESH_RESOURCE, "town"))
        mesh = Path(unquote(urlparse(overview.mesh_resource).path))
        self.assertIn("20.0", mesh.read_text())
        self.assertEqual(Picture.open(mesh.with_suffix(".png")).size, (800, 400))
        self.assertEqual((overview.pose.position.x, overview.pose.position.y), (7, 3))
        self.assertAlmostEqual(overview.pose.orientation.z, math.sqrt(0.5))
        # x of the overview is y of the town, up in the overview is against x
        points = [(point.x, point.y) for point in dots.points]
        np.testing.assert_allclose(points, [(-8, 8), (-8, 18), (2, 28), (2, 38)], atol=1e-9)
        self.connected(1)
        self.say((2, 0.75), (1, 0.25))
        best = {}
        answers = rospy.Subscriber(
            "/metric/places/visualization",
            MarkerArray,
            lambda array: best.update({each.ns: each for each in array.markers}),
        )
        self.assertTrue(until(lambda: "best" in best))
        answers.unregister()
        self.assertEqual([(point.x, point.y) for point in best["best"].points], [points[1]])
        colour = best["best"].colors[0]
        np.testing.assert_allclose(
            [colour.r, colour.g, colour.b], np.divide(probability_colour(0.75), 255), atol=1e-6
        )

    def test_a_map_that_was_changed_is_read_again_but_not_a_wrong_one(self):
        images = self.start("changed", self.write("map.txt", {1: (50, 50)}, METRIC))
        reload_map = rospy.ServiceProxy("/changed/view/reload", Trigger)
        self.write("map.txt", EXACT)
        self.assertEqual(reload_map().message, "4 photos")
        self.assertTrue(until(lambda: any(self.colour(each, EXACT[3]) == PLACE for each in images.all())))
        self.assertTrue(until(lambda: "no metric frame" in self.log("changed")))
        markers = rospy.wait_for_message("/changed/places/map", MarkerArray, WAIT).markers
        self.assertEqual([each.action for each in markers], [Marker.DELETEALL])
        self.write("map.txt", {1: (50, 5000)})
        answer = reload_map()
        self.assertFalse(answer.success)
        self.assertIn("map.txt:2: photo 1: y is 5000, outside the overview", answer.message)

    def test_what_stops_the_start_up_is_named(self):
        given = self.write("map.txt", EXACT)
        no_overview = self.folder / "other.txt"
        no_overview.write_text("lacking.png;400;200\n")
        for args, reason in [
            ([], "/refused/map_file: required"),
            ([given + "x"], "No such file or directory"),
            ([f"_map_file:={no_overview}"], "lacking.png"),
            ([given, "_trial:=3"], "/refused/trial: unknown parameter; did you mean trail?"),
            ([self.write("m.txt", EXACT, METRIC), "_mesh_folder:=/nowhere"], "/nowhere/overview_"),
            ([given, "_window:=true"], "there is no display for the window: set DISPLAY"),
        ]:
            ended = subprocess.run(
                command("__name:=refused", *args),
                env={name: value for name, value in os.environ.items() if "DISPLAY" not in name},
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                timeout=WAIT,
            )
            self.assertEqual(ended.returncode, 1, ended.stdout)
            self.assertIn(reason, ended.stdout)
            if rospy.has_param("/refused"):
                rospy.delete_param("/refused")


if __name__ == "__main__":
    rospy.init_node("place_visualizer_test")
    rostest.rosrun("sextant", "place_visualizer", PlaceVisualizerTest)
