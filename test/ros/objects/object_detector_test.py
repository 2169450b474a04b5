#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
import rospy
import rostest
from made_yolo import constant_network
from ros_probe import Diagnostics, Recorder, stamps, subscribers_of, until
from sensor_msgs.msg import Image
from start_up import assert_refused
from std_msgs.msg import Header

from sextant.detection_scores.average_precision import overlaps
from sextant.msg import Objects
from sextant.simulation.ball_ground import Pillar
from sextant.simulation.ball_simulation import BallSimulation, BallSimulationParams
from sextant.simulation.ball_world import BallWorld

try:
    from vision_msgs.msg import Detection2DArray, VisionInfo
except ImportError:
    Detection2DArray = None

STATUS = "object_detector: objects"
STAMP = stamps()
NAMES = ["cup", "fork"]
NODE = [sys.executable, "-c", "from sextant.nodes.objects.object_detector import main; main()"]
WORLD = BallWorld(
    (8.0, 6.0),
    [Pillar(1.2, 0.35, 0.05, "blue_pillar"), Pillar(1.6, -0.4, 0.05, "red_pillar")],
    np.array([1.1, 0.0]),
    np.array([-0.2, 0.0, 0.0]),
)


class Camera:
    """Publishes images on `image` while it has subscribers."""

    def __init__(self):
        self.simulation = BallSimulation(WORLD, BallSimulationParams(seed=5))
        self._publisher = rospy.Publisher("image", Image, queue_size=10)

    def take(self):
        self.simulation.ground.advance(0.1)
        return self.simulation.take_images()

    def publish(self, pixels, encoding="rgb8", cut=0):
        """Returns the stamp. :param cut: bytes that are lacking"""
        stamp, (height, width) = next(STAMP), pixels.shape[:2]
        data = pixels.tobytes()
        step = len(data) // max(1, height)
        header = Header(stamp=stamp, frame_id="lens")
        self._publisher.publish(Image(header, height, width, encoding, 0, step, data[: len(data) - cut]))
        return stamp

    def number_of_subscribers(self):
        return self._publisher.get_num_connections()


def boxes_of(message):
    return np.array([[each.left, each.top, each.right, each.bottom] for each in message.objects]).reshape(
        -1, 4
    )


def started(name, **params):
    """A separate node that publishes NAME/objects."""
    given = [f"_{key}:={value}" for key, value in params.items()]
    return subprocess.Popen([*NODE, f"__name:={name}", f"objects:={name}/objects", *given])


class ObjectDetectorTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.camera, cls.diagnostics = Camera(), Diagnostics()
        cls.objects = Recorder("objects", Objects)
        assert cls.objects.connected() and until(cls.camera.number_of_subscribers)

    def test_objects_are_where_the_simulation_has_them(self):
        names = self.camera.simulation.class_names
        for _ in range(5):
            picture = self.camera.take()
            message = self.objects.at(self.camera.publish(picture.colour))
            self.assertEqual((message.header.frame_id, message.width, message.height), ("lens", 640, 480))
            self.assertEqual(len(picture.seen), 3)
            left = overlaps(boxes_of(message), np.array([[*each.low, *each.high] for each in picture.seen]))
            for number, each in enumerate(picture.seen):
                best = int(left[:, number].argmax())
                self.assertGreater(left[best, number], 0.8)
                self.assertEqual(message.objects[best].class_name, names[each.object])
            scores = [each.score for each in message.objects]
            self.assertEqual(scores, sorted(scores, reverse=True))

    def test_either_order_of_colours_gives_the_same(self):
        colour = self.camera.take().colour
        one, other = (
            self.objects.at(self.camera.publish(pixels, encoding))
            for pixels, encoding in ((colour, "rgb8"), (np.ascontiguousarray(colour[..., ::-1]), "bgr8"))
        )
        self.assertEqual(one.objects, other.objects)

    def test_an_empty_picture_gives_an_empty_list(self):
        message = self.objects.at(self.camera.publish(np.full((240, 320, 3), 128, np.uint8)))
        self.assertEqual((message.objects, message.width, message.height), ([], 320, 240))

    def test_of_many_pictures_at_once_the_newest_is_looked_at(self):
        colour = self.camera.take().colour
        published = [self.camera.publish(colour) for _ in range(20)]
        self.assertIsNotNone(self.objects.at(published[-1]))
        found = [each.header.stamp for each in self.objects.all() if each.header.stamp in published]
        self.assertEqual(found, sorted(found))

    @unittest.skipIf(Detection2DArray is None, "vision_msgs is not installed")
    def test_vision_msgs_have_the_same(self):
        received = Recorder("objects/detections", Detection2DArray)
        self.assertTrue(received.connected())
        stamp = self.camera.publish(self.camera.take().colour)
        message, same = self.objects.at(stamp), received.at(stamp)
        info = rospy.wait_for_message("objects/detections_info", VisionInfo, 15.0)
        names = rospy.get_param(info.database_location)
        self.assertEqual(len(same.detections), len(message.objects))
        for box, detection in zip(message.objects, same.detections):
            (result,), size = detection.results, (detection.bbox.size_x, detection.bbox.size_y)
            self.assertEqual((names[result.id], result.score), (box.class_name, box.score))
            self.assertEqual(size, (box.right - box.left, box.bottom - box.top))
            self.assertEqual(detection.bbox.center.x, (box.left + box.right) / 2)
        received.close()

    def test_boxes_are_drawn_for_who_looks(self):
        pictures = Recorder("objects/image", Image)
        self.assertTrue(pictures.connected())
        colour = self.camera.take().colour
        stamp = self.camera.publish(colour)
        shown, message = pictures.at(stamp), self.objects.at(stamp)
        self.assertEqual((shown.encoding, shown.header.frame_id), ("rgb8", "lens"))
        changed = np.any(np.frombuffer(shown.data, np.uint8).reshape(colour.shape) != colour, axis=2)
        for left, top, right, bottom in boxes_of(message).astype(int):
            self.assertTrue(changed[top, left:right].all() and changed[top:bottom, left].all())
        self.assertLess(changed.mean(), 0.2)
        pictures.close()

    def test_a_bad_picture_is_named_and_the_next_is_used(self):
        seen, colour = self.diagnostics, self.camera.take().colour
        for number, (pixels, encoding, cut, reason) in enumerate(
            [
                (
                    colour[..., 0],
                    "mono8",
                    0,
                    "/image: the encoding 'mono8' has no colours, publish rgb8 or bgr8",
                ),
                (colour, "rgb8", 1000, "/image: the image is cut short: 920600 bytes of 921600"),
                (colour[:0], "rgb8", 0, "/image: the image is empty (640 x 0)"),
                (
                    np.zeros((48, 64), np.float32),
                    "32FC1",
                    0,
                    "/image: the encoding '32FC1' is not an image of a camera",
                ),
                (colour, "rgb9", 0, "/image: the encoding 'rgb9' is not an image of a camera"),
            ]
        ):
            stamp = self.camera.publish(np.ascontiguousarray(pixels), encoding, cut)
            self.assertTrue(until(lambda text=reason: text in seen.summary(STATUS)), seen.summary(STATUS))
            self.assertEqual(seen.count(STATUS, "rejected images"), number + 1)
            self.assertIsNotNone(self.objects.at(self.camera.publish(colour)))
            self.assertFalse(self.objects.has(stamp))
        self.assertTrue(until(lambda: seen.summary(STATUS) == "objects are detected"))
        self.assertGreater(seen.count(STATUS, "objects"), 0)
        self.assertRegex(seen.row(STATUS, "colours"), r"^\d+\.\d ms$")

    def test_a_made_network_detects_its_objects_and_only_with_a_subscriber(self):
        answer = np.zeros((1, 6, 84), np.float32)
        answer[0, :, 3] = [32, 32, 16, 8, 0, 0.75]
        answer[0, :, 5] = [10, 12, 4, 4, 0.5, 0]
        model = constant_network(Path(tempfile.mkdtemp()) / "net.onnx", [answer], names=NAMES)
        node = started("made", model=model, backend="opencv")
        try:
            self.assertTrue(until(lambda: "no subscribers" in self.diagnostics.summary("made: objects")))
            self.assertNotIn("/made", subscribers_of("/image"))
            objects = Recorder("made/objects", Objects)
            self.assertTrue(until(lambda: self.camera.number_of_subscribers() == 2))
            self.assertTrue(objects.connected())
            message = objects.at(self.camera.publish(self.camera.take().colour))
            self.assertEqual([each.class_name for each in message.objects], ["fork", "cup"])
            np.testing.assert_allclose([each.score for each in message.objects], [0.75, 0.5], atol=1e-6)
            # 640 × 480 lie in the middle of 64 × 64
            np.testing.assert_allclose(
                boxes_of(message), [[240, 200, 400, 280], [80, 20, 120, 60]], atol=1e-3
            )
            status = "made: objects"
            self.assertTrue(self.diagnostics.reaches(status, "images", 1))
            for stage in ("letter box", "network", "decoding"):
                self.assertRegex(self.diagnostics.row(status, stage), r"^\d+\.\d ms$")
            objects.close()
            self.assertTrue(until(lambda: "/made" not in subscribers_of("/image")))
        finally:
            node.terminate()
            self.assertIsNotNone(node.wait(20))

    def test_mistakes_stop_the_start_with_the_reason(self):
        folder = Path(tempfile.mkdtemp())
        (folder / "text.onnx").write_text("no model\n")
        model = constant_network(folder / "net.onnx", [np.zeros((1, 6, 84), np.float32)], names=NAMES)
        mistakes = (
            ("no_such_parameter", "1", "/bad/no_such_parameter: unknown"),
            ("detector", "nose", "/bad/detector: must be one of network, colour"),
            ("confidence", "2.0", "/bad/confidence: must be within"),
            ("ranges", "{cup: {hue: 3}}", "/bad/ranges: ranges/cup/hue_tolerance: required"),
            ("model", str(folder / "none.onnx"), "none.onnx"),
            ("model", str(folder / "text.onnx"), "text.onnx: is no ONNX file"),
            ("classes", "[a, b, c]", "classes are 3 names, but"),
            ("size", "320", "size is 320, but"),
        )
        assert_refused(self, "objects.object_detector", mistakes, model=model, backend="opencv")


if __name__ == "__main__":
    rospy.init_node("object_detector_test")
    rostest.rosrun("sextant", "object_detector_test", ObjectDetectorTest)
