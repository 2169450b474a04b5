#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import math
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np
import rospy
import rostest
from nav_msgs.msg import OccupancyGrid
from PIL import Image as Picture
from ros_probe import WAIT, Recorder, stamps, until
from sensor_msgs.msg import Image
from std_msgs.msg import Header
from std_srvs.srv import Trigger
from visualization_msgs.msg import Marker, MarkerArray

from sextant.msg import Places
from sextant.place_maps.overview_renderer import PLACE
from sextant.place_maps.probability_colours import probability_colour

# 40 m x 20 m, turned by a quarter to the left; the overview is shown at twice its size
METRIC = "frame=town;resolution=0.1;origin=7,3," + repr(math.pi / 2)
EXACT = {1: (50, 50), 2: (150, 50), 3: (250, 150), 4: (350, 150)}
CLUSTERS = {1: (100, 50), 2: (100, 50), 3: (300, 150), 4: (300, 150)}


def command(*args):
    return ["rosrun", "sextant", "place_visualizer", *args]


class PlaceVisualizerTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="a town ")
        cls.addClassCleanup(folder.cleanup)
        cls.folder, cls.stamps = Path(folder.name), stamps()
        park = Picture.new("RGB", (400, 200), (90, 200, 90))
        park.paste((0, 0, 0), (0, 0, 25, 25))
        park.save(cls.folder / "park.png")
        cls.places = rospy.Publisher("places", Places, queue_size=100)
        maps = (("exact", EXACT), ("clusters", CLUSTERS), ("metric", EXACT, METRIC))
        for name, *content in maps:
            cls.start(name, cls.write(name + ".txt", *content))
        for name, *_ in maps:
            rospy.wait_for_service(f"/{name}/view/reload", WAIT)
        assert until(lambda: cls.places.get_num_connections() == len(maps))

    @classmethod
    def write(cls, name, positions, *fields):
        lines = [";".join(["park.png;400;200", *fields])]
        lines += [f"{number};{number}.jpg;{x};{y}" for number, (x, y) in positions.items()]
        (cls.folder / name).write_text("\n".join(lines) + "\n")
        return "_map_file:=" + str(cls.folder / name)

    @classmethod
    def start(cls, name, given):
        """A visualizer in a namespace of its own; its log is NAME.log in the folder."""
        log = open(cls.folder / f"{name}.log", "w")  # noqa: SIM115
        args = [f"__ns:=/{name}", "__name:=view", "places:=/places", "_rate:=20", given]
        node = subprocess.Popen(command(*args), stdout=log, stderr=log)
        cls.addClassCleanup(cls.stop, node, log)

    @staticmethod
    def stop(node, log):
        node.terminate()
        node.wait(WAIT)
        log.close()

    def images(self, name):
        """A recorder of the images of one node."""
        images = Recorder(f"/{name}/places/image", Image)
        self.addCleanup(images.close)
        self.assertTrue(images.connected())
        return images

    def log(self, name):
        return (self.folder / f"{name}.log").read_text()

    def publish(self, *answer, stamp=None):
        stamp = stamp or next(self.stamps)
        ids, probabilities = zip(*answer) if answer else ((), ())
        self.places.publish(Places(Header(stamp=stamp, frame_id="camera"), ids, probabilities))
        return stamp

    def picture(self, message):
        self.assertIsNotNone(message)
        self.assertEqual((message.encoding, message.step), ("rgb8", 3 * message.width))
        return np.frombuffer(message.data, np.uint8).reshape(message.height, message.width, 3)

    def colour(self, message, position):
        return tuple(self.picture(message)[2 * position[1], 2 * position[0]].tolist())

    def test_whoever_looks_sees_the_places_at_once_and_the_newest_answer(self):
        nowhere = self.publish((0, 0.0), stamp=rospy.Time(5))  # a bag begins: without a trail
        first = self.images("exact")
        for position in EXACT.values():
            self.assertEqual(self.colour(first.at(nowhere), position), PLACE)
        published = [self.publish((1 + i % 4, 0.75)) for i in range(200)]
        self.assertEqual(self.colour(first.at(published[-1]), EXACT[4]), probability_colour(0.75))
        self.assertLess(len(first.all()), 100)
        first.close()
        late = self.images("exact").at(published[-1])
        self.assertEqual(self.colour(late, EXACT[4]), probability_colour(0.75))

    def test_several_maps_show_the_same_answers(self):
        exact, clusters = self.images("exact"), self.images("clusters")
        stamp = self.publish((2, 0.625), (3, 0.25))
        for images, positions in ((exact, EXACT), (clusters, CLUSTERS)):
            message = images.at(stamp)
            self.assertEqual(message.header.frame_id, "camera")
            self.assertEqual(self.colour(message, positions[2]), probability_colour(0.625))
            self.assertEqual(self.colour(message, positions[3]), probability_colour(0.25))

    def test_what_cannot_be_shown_is_logged_and_the_next_answer_is_shown(self):
        images = self.images("clusters")
        unknown = self.publish((77, 0.5), (1, 0.375))
        self.assertEqual(self.colour(images.at(unknown), CLUSTERS[1]), probability_colour(0.375))
        self.assertTrue(until(lambda: "are not shown: 77" in self.log("clusters")))
        self.places.publish(Places(Header(stamp=next(self.stamps)), [1, 2], [0.5]))
        self.assertTrue(until(lambda: "2 places with 1 probabilities" in self.log("clusters")))
        nowhere = self.publish((0, 0.0))
        self.assertEqual(self.colour(images.at(nowhere), CLUSTERS[3]), PLACE)

    def test_rviz_gets_the_overview_and_dots_in_the_metric_frame(self):
        overview = rospy.wait_for_message("/metric/places/overview", OccupancyGrid, WAIT)
        self.assertEqual(overview.header.frame_id, "town")
        info = overview.info
        self.assertEqual((info.width, info.height), (800, 400))
        self.assertAlmostEqual(info.resolution, 0.05)
        self.assertEqual((info.origin.position.x, info.origin.position.y), (7, 3))
        self.assertAlmostEqual(info.origin.orientation.z, math.sqrt(0.5))
        cells = np.reshape(overview.data, (400, 800))[::-1]  # as the picture: a green park with a black pond
        grey = 255 - 2.55 * cells
        self.assertLess(grey[:40, :40].max() + 30, grey[60:, 60:].min())
        _, dots = rospy.wait_for_message("/metric/places/map", MarkerArray, WAIT).markers
        # right in the overview is y of the town, up is against its x
        points = [(point.x, point.y) for point in dots.points]
        np.testing.assert_allclose(points, [(-8, 8), (-8, 18), (2, 28), (2, 38)], atol=1e-9)
        received = []
        listener = rospy.Subscriber("/metric/places/visualization", MarkerArray, received.append)
        self.addCleanup(listener.unregister)
        self.publish((2, 0.75), (1, 0.25))
        self.assertTrue(until(lambda: any(points[1] == self.best(each)[0] for each in received)))
        expected = np.divide(probability_colour(0.75), 255)
        np.testing.assert_allclose(self.best(received[-1])[1], expected, atol=1e-6)

    def best(self, array):
        """Where the best hypothesis stands, and its colour."""
        spheres = [each for each in array.markers if each.ns == "best"]
        where = [((each.points[0].x, each.points[0].y), each.colors[0]) for each in spheres]
        return (where[0][0], [where[0][1].r, where[0][1].g, where[0][1].b]) if where else (None, None)

    def test_a_changed_map_is_read_again_but_not_a_wrong_one(self):
        reload_map = rospy.ServiceProxy("/metric/view/reload", Trigger)
        self.addCleanup(reload_map)
        self.addCleanup(self.write, "metric.txt", EXACT, METRIC)
        self.write("metric.txt", CLUSTERS)
        self.assertEqual(reload_map().message, "4 photos")
        images = self.images("metric")
        stamp = self.publish((1, 0.5))
        self.assertEqual(self.colour(images.at(stamp), CLUSTERS[3]), PLACE)
        self.assertTrue(until(lambda: "no metric frame" in self.log("metric")))
        markers = rospy.wait_for_message("/metric/places/map", MarkerArray, WAIT).markers
        self.assertEqual([each.action for each in markers], [Marker.DELETEALL])
        self.write("metric.txt", {1: (50, 5000)})
        answer = reload_map()
        self.assertFalse(answer.success)
        self.assertIn("metric.txt:2: photo 1: y is 5000, outside the overview", answer.message)

    def test_what_stops_the_start_up_is_named(self):
        given = self.write("map.txt", EXACT)
        no_overview = self.folder / "other.txt"
        no_overview.write_text("lacking.png;400;200\n")
        for args, reason in [
            ([given, "_trial:=3"], "/refused/trial: unknown parameter; did you mean trail?"),
            ([f"_map_file:={no_overview}"], "lacking.png"),
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
