#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import unittest

import numpy as np
import rospy
import rostest
import tf2_ros
from nav_msgs.msg import Odometry
from ros_probe import Diagnostics, Recorder, transform, until
from sensor_msgs.msg import CameraInfo, Image
from start_up import assert_refused
from std_msgs.msg import Header
from visualization_msgs.msg import Marker, MarkerArray

from sextant.messages.camera_messages import calibration_to_message
from sextant.messages.pose_messages import pose_to_message
from sextant.msg import LandmarkObservations, ObjectBox, Objects
from sextant.simulation.ball_ground import Pillar
from sextant.simulation.ball_simulation import BallSimulation, BallSimulationParams
from sextant.simulation.ball_world import BallWorld

RATE = 15  # images per simulated second
STATUS = "object_locator: objects"
PILLARS = [Pillar(1.0, 0.5, 0.05, "blue_pillar"), Pillar(1.8, -0.3, 0.05, "red_pillar")]
ENCODINGS = {"32FC1": lambda metres: metres, "16UC1": lambda metres: np.round(1e3 * metres).astype(np.uint16)}


class Camera:
    """Publishes images of a ball that rolls past pillars, with their true boxes."""

    def __init__(self):
        world = BallWorld((8.0, 6.0), PILLARS, np.array([1.6, 0.2]), np.array([-0.5, 0.1, 0.0]))
        self.simulation = BallSimulation(world, BallSimulationParams(seed=4))
        self.camera, self._stamp = self.simulation.camera, rospy.Time.now()
        self._topics = {
            "objects": Objects, "odom": Odometry, "depth/image": Image,
            "camera_info": CameraInfo, "depth/camera_info": CameraInfo,
        }  # fmt: skip
        self._publishers = {
            name: rospy.Publisher(name, kind, queue_size=50) for name, kind in self._topics.items()
        }
        self._static = tf2_ros.StaticTransformBroadcaster()
        assert all(until(lambda p=each: p.get_num_connections() > 0) for each in self._publishers.values())

    def publish_frames(self):
        stamp = rospy.Time.now()
        mounts = {"colour": self.camera.T_base_colour, "depth": self.camera.T_base_depth}
        self._static.sendTransform([transform(T, "base_link", name, stamp) for name, T in mounts.items()])

    def take(self, depth=None, encoding="32FC1", size=None):
        """Publish one image, optionally with another depth image; returns its stamp."""
        self.simulation.ground.advance(1.0 / RATE)
        picture = self.simulation.take_images()
        self._stamp += rospy.Duration(1.0 / RATE)
        self.publish("camera_info", calibration_to_message(self.camera.colour, self._header("colour")))
        self.publish("depth/camera_info", calibration_to_message(self.camera.depth, self._header("depth")))
        self.publish("depth/image", self._depth(picture.depth if depth is None else depth, encoding))
        self.publish("objects", self._objects(picture.seen, size or (640, 480)))
        odometry = Odometry(header=self._header("odom"), child_frame_id="base_link")
        odometry.pose.pose = pose_to_message(self.simulation.ground.robot.pose)
        self.publish("odom", odometry)
        return self._stamp

    def publish(self, topic, message):
        self._publishers[topic].publish(message)

    def _header(self, frame):
        return Header(stamp=self._stamp, frame_id=frame)

    def _depth(self, metres, encoding):
        pixels = ENCODINGS[encoding](metres) if encoding in ENCODINGS else metres
        height, width = pixels.shape
        row = width * pixels.itemsize
        return Image(self._header("depth"), height, width, encoding, 0, row, pixels.tobytes())

    def _objects(self, seen, size):
        names = self.simulation.class_names
        boxes = [ObjectBox(names[each.object], 0.9, *map(float, [*each.low, *each.high])) for each in seen]
        boxes.append(ObjectBox("giraffe", 0.5, 10.0, 10.0, 60.0, 60.0))
        return Objects(self._header("colour"), *size, boxes)


class ObjectLocatorTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.camera, cls.diagnostics = Camera(), Diagnostics()
        cls.landmarks, cls.balls = Recorder("landmarks", LandmarkObservations), Recorder("ball", Odometry)
        cls.drawn = []
        cls.markers = rospy.Subscriber("visualization", MarkerArray, cls.drawn.append)
        assert cls.landmarks.connected() and cls.balls.connected()
        cls.camera.take()
        cls.without_frames = until(lambda: "no transform" in cls.diagnostics.summary(STATUS))
        cls.reason = cls.diagnostics.summary(STATUS)
        cls.camera.publish_frames()
        assert until(lambda: cls.landmarks.at(cls.camera.take(), 0.5) is not None)

    def test_without_a_transform_it_names_both_frames(self):
        self.assertTrue(self.without_frames)
        self.assertRegex(self.reason, "no transform from 'colour' to 'base_link'")

    def test_pillars_are_located_in_either_encoding(self):
        for encoding in ENCODINGS:
            message = self.landmarks.at(self.camera.take(encoding=encoding))
            self.assertEqual(message.header.frame_id, "base_link")
            robot = self.camera.simulation.ground.robot
            found = {each.class_name: each for each in message.observations}
            self.assertEqual(sorted(found), ["blue_pillar", "red_pillar"])
            for pillar in PILLARS:
                each = found[pillar.class_name]
                off = np.array([each.x + robot.x - pillar.x, each.y + robot.y - pillar.y])  # it looks along x
                covariance = np.reshape(each.covariance, (3, 3))[:2, :2]
                self.assertLess(np.hypot(*off), 0.02 * np.hypot(pillar.x - robot.x, pillar.y - robot.y))
                self.assertLess(off @ np.linalg.solve(covariance, off), 25.0)
                self.assertEqual(each.id, -1)
                self.assertTrue(np.isnan(each.heading))

    def test_the_ball_is_followed_in_the_frame_of_odometry(self):
        ground = self.camera.simulation.ground
        ground.ball, ground.ball_velocity = np.array([1.6, 0.0]), np.array([0.0, 0.4])
        for _ in range(12):
            stamp = self.camera.take()
            ball = self.balls.at(stamp)
        self.assertEqual((ball.header.frame_id, ball.child_frame_id), ("odom", "ball"))
        place, speed = ball.pose.pose.position, ball.twist.twist.linear
        np.testing.assert_allclose([place.x, place.y], ground.ball, atol=0.03)
        np.testing.assert_allclose([speed.x, speed.y], ground.ball_velocity, atol=0.1)
        self.assertGreater(ball.pose.covariance[0], 0.0)
        self.assertGreater(ball.twist.covariance[7], 0.0)

    def test_bad_depth_is_named_and_the_next_is_used(self):
        camera, count = self.camera, self.diagnostics
        self.assertTrue(count.reaches(STATUS, "images", 1))
        nothing = np.zeros((480, 640), np.float32)
        for depth, encoding, size, reason in (
            (nothing, "32FC1", None, "/depth/image: no pixel has a depth"),
            (nothing + np.nan, "32FC1", None, "/depth/image: no pixel has a depth"),
            (nothing[::2, ::2] + 1, "32FC1", None, "the depth image is 320×240, its camera_info has 640×480"),
            (nothing, "16UC1", None, "no pixel has a depth"),
            (np.zeros((480, 640), np.uint8), "mono8", None, "the encoding 'mono8' is not depth"),
            (nothing + 1, "32FC1", (320, 240), "the image is 320×240, its camera_info has 640×480"),
        ):
            stamp = camera.take(depth, encoding, size)
            self.assertTrue(until(lambda text=reason: text in count.summary(STATUS)), count.summary(STATUS))
            self.assertIsNotNone(self.landmarks.at(camera.take()))
            self.assertFalse(self.landmarks.has(stamp))
        self.assertTrue(until(lambda: count.summary(STATUS) == "objects are located"))
        self.assertEqual(count.row(STATUS, "classes that are not among the kinds"), "giraffe")

    def test_what_is_seen_is_drawn(self):
        self.camera.take()
        self.assertTrue(until(lambda: self.drawn and len(self.drawn[-1].markers) >= 3))
        kinds = [each.type for each in self.drawn[-1].markers if each.action == Marker.ADD]
        self.assertGreaterEqual(kinds.count(Marker.CYLINDER), 1)

    def test_mistakes_stop_the_start_with_the_full_name(self):
        mistakes = (
            ("no_such_parameter", "1", "/bad/no_such_parameter: unknown"),
            ("depth_scale", "3.0", "/bad/depth_scale: must be within"),
            ("kinds", "{cat: {shape: cat, radius: 0.1}}", "/bad/kinds: kinds/cat/shape: must be one of"),
        )
        assert_refused(self, "objects.object_locator", mistakes)


if __name__ == "__main__":
    rospy.init_node("object_locator_test")
    rostest.rosrun("sextant", "object_locator_test", ObjectLocatorTest)
