#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import unittest

import numpy as np
import rospy
import rostest
import tf2_ros
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from ros_probe import Recorder, TransformRecorder, matrix, until
from sensor_msgs.msg import CameraInfo, Image
from start_up import assert_refused
from std_msgs.msg import Bool
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray

from sextant.geometry.plane_poses import in_frame
from sextant.msg import Objects
from sextant.simulation.ball_world import random_world

SEED, LATENCY = 37, 0.2  # as in the .test file
RADIUS, HEIGHT = 0.05, 0.4  # of pillars, metres
START = 10_000_000_000  # nanoseconds


def planar(message):
    """(3,) of an Odometry."""
    T = matrix(message.pose.pose)
    return np.array([T[0, 3], T[1, 3], np.arctan2(T[1, 0], T[0, 0])])


def pixels_of(message):
    """As an array."""
    kind, channels = {"rgb8": (np.uint8, 3), "16UC1": (np.uint16, 1), "32FC1": (np.float32, 1)}[
        message.encoding
    ]
    assert message.step == message.width * channels * np.dtype(kind).itemsize
    array = np.frombuffer(message.data, kind).reshape(message.height, message.width, channels)
    return array if channels > 1 else array[..., 0]


class Watch(Recorder):
    """Stamps of received messages, and when they came by the clock."""

    def __init__(self, topic, type_):
        self.received = {}
        super().__init__(topic, type_)

    def _on_message(self, msg):
        self.received[msg.header.stamp] = rospy.Time.now()
        super()._on_message(msg)


class PictureTest(unittest.TestCase):
    """A robot that stands and looks at pillars whose places are known."""

    @classmethod
    def setUpClass(cls):
        cls.truth, cls.odometry = Recorder("ground_truth", Odometry), Recorder("odom", Odometry)
        cls.ball, cls.tf = Recorder("ground_truth/ball", Odometry), TransformRecorder()
        cls.infos = [Recorder(f"{name}/camera_info", CameraInfo) for name in ("colour", "depth")]
        cls.objects, cls.depth = Recorder("ground_truth/objects", Objects), Recorder("depth/image", Image)
        assert all(each.connected() for each in (cls.truth, cls.ball, cls.objects, cls.depth, *cls.infos))
        cls.buffer = tf2_ros.Buffer(rospy.Duration(60.0))
        cls.listener = tf2_ros.TransformListener(cls.buffer)
        cls.colour = Watch("colour/image", Image)  # the robot waits for it
        assert until(lambda: len(cls.colour.all()) > 12, 60)
        cls.stamps = sorted(cls.colour.received)[1:10]
        cls.world = random_world(3, SEED)
        cls.pillars = in_frame(cls.world.robot, np.array([[each.x, each.y] for each in cls.world.pillars]))

    def mount(self, frame):
        return matrix(self.buffer.lookup_transform("base_link", frame, rospy.Time(0)).transform)

    def test_true_boxes_are_where_the_pillars_are_projected(self):
        stamp, checked = self.stamps[0], 0
        info, objects = self.infos[0].at(stamp), self.objects.at(stamp)
        T_map_camera = matrix(self.truth.at(stamp).pose.pose) @ self.mount(info.header.frame_id)
        image = pixels_of(self.colour.at(stamp)).astype(float)
        boxes = [[each.left, each.top, each.right, each.bottom] for each in objects.objects]
        for pillar, at in zip(self.world.pillars, self.pillars):
            expected = self.box(info, T_map_camera, at)
            same = [number for number, each in enumerate(boxes) if np.allclose(each, expected, atol=1.0)]
            if same and pillar.class_name == "blue_pillar":
                self.assertEqual(objects.objects[same[0]].class_name, "blue_pillar")
                left, top, right, bottom = np.array(expected, int) + (2, 2, -2, -2)
                inside = image[top:bottom, left:right].mean(axis=(0, 1))
                self.assertGreater(inside[2], 1.3 * inside[0])
                checked += 1
        self.assertGreater(checked, 1)
        self.assertEqual(
            (objects.width, objects.height, objects.header.frame_id), (320, 240, "colour_optical_frame")
        )
        self.assertEqual(sum(each.class_name == "ball" for each in objects.objects), 1)

    def box(self, info, T_map_camera, at):
        """Of a pillar's silhouette."""
        angles = np.linspace(0.0, 2.0 * np.pi, 361)
        ring = at + RADIUS * np.column_stack([np.cos(angles), np.sin(angles)])
        rims = [[*point, z, 1.0] for point in ring for z in (0.0, HEIGHT)]
        seen = (np.linalg.inv(T_map_camera) @ np.transpose(rims))[:3].T
        if seen[:, 2].min() < 0.1:
            return [-1, -1, -1, -1]
        pixels = seen @ np.reshape(info.K, (3, 3)).T
        pixels = pixels[:, :2] / pixels[:, 2:]
        low, high = np.ceil(pixels.min(axis=0)), np.floor(pixels.max(axis=0)) + 1
        return [*np.clip(low, 0, (320, 240)), *np.clip(high, 0, (320, 240))]

    def test_depths_lie_on_pillars_ball_and_floor(self):
        stamp = self.stamps[0]
        info, message = self.infos[1].at(stamp), self.depth.at(stamp)
        self.assertEqual((message.encoding, message.header.frame_id), ("16UC1", "depth_optical_frame"))
        depth, K = 1e-3 * pixels_of(message), np.reshape(info.K, (3, 3))
        u, v = np.meshgrid(np.arange(320), np.arange(240))
        rays = np.dstack([(u - K[0, 2]) / K[0, 0], (v - K[1, 2]) / K[1, 1], np.ones(u.shape)])
        T = matrix(self.truth.at(stamp).pose.pose) @ self.mount("depth_optical_frame")
        points = (rays * depth[..., None])[depth > 0] @ T[:3, :3].T + T[:3, 3]
        is_above = (points[:, 2] > 0.12) & (points[:, 2] < 0.38)
        off = np.min([np.linalg.norm(points[:, :2] - at, axis=1) for at in self.pillars], axis=0)
        on_pillars = is_above & (off < 0.1)
        self.assertGreater(np.sum(on_pillars), 200)
        np.testing.assert_allclose(off[on_pillars], RADIUS, atol=0.003)  # of millimetres
        middle = self.ball.at(stamp).pose.pose.position
        to_ball = np.linalg.norm(points - (middle.x, middle.y, middle.z), axis=1)
        self.assertGreater(np.sum(abs(to_ball - 0.05) < 0.003), 20)
        self.assertGreater(np.sum(abs(points[:, 2]) < 0.003), 5000)

    def test_calibrations_come_with_every_picture(self):
        for recorder, frame, fov in zip(self.infos, ("colour", "depth"), (0.96, 1.387)):
            for stamp in self.stamps:
                info = recorder.at(stamp)
                self.assertEqual((info.width, info.height, info.distortion_model), (320, 240, "plumb_bob"))
                self.assertEqual(info.header.frame_id, frame + "_optical_frame")
                self.assertAlmostEqual(info.K[0], 160.0 / np.tan(fov / 2.0))

    def test_pictures_come_late_with_the_stamp_of_their_moment(self):
        stamps = [stamp.to_nsec() for stamp in self.stamps]
        np.testing.assert_array_equal(np.diff(stamps), 100_000_000)
        self.assertGreaterEqual(stamps[0], START)
        late = [(received - stamp).to_sec() for stamp, received in self.colour.received.items()]
        self.assertGreaterEqual(min(late), 0.0)
        self.assertGreater(max(late), LATENCY - 0.05)  # the clock's ticks come another way, some late
        for stamp in self.stamps:
            self.assertEqual(pixels_of(self.colour.at(stamp)).shape, (240, 320, 3))
            self.assertIsNotNone(self.depth.at(stamp))
            T = self.tf.at("odom", "base_link", stamp)
            np.testing.assert_allclose(T, matrix(self.odometry.at(stamp).pose.pose), atol=1e-12)

    def test_the_world_is_drawn(self):
        markers = rospy.wait_for_message("ground_truth/visualization", MarkerArray, 15.0).markers
        drawn = [each for each in markers if each.type == Marker.CYLINDER]
        self.assertEqual(markers[0].action, Marker.DELETEALL)
        places = [[each.pose.position.x, each.pose.position.y] for each in drawn]
        np.testing.assert_allclose(places, self.pillars, atol=1e-9)
        self.assertTrue(all(each.header.frame_id == "map" for each in markers))
        (line,) = (each for each in markers if each.type == Marker.LINE_STRIP)
        np.testing.assert_allclose([[each.x, each.y] for each in line.points], self.pillars[:2], atol=1e-9)
        (ball,) = (each for each in markers if each.type == Marker.SPHERE)
        expected = in_frame(self.world.robot, self.world.ball)
        np.testing.assert_allclose([ball.pose.position.x, ball.pose.position.y], expected, atol=1e-9)


class DrivenTest(unittest.TestCase):
    """A robot that drives."""

    def setUp(self):
        self.truth, self.odometry = (
            Recorder("driven/" + name, Odometry) for name in ("ground_truth", "odom")
        )
        self.commands, self.bumps = rospy.Publisher("driven/cmd_vel", Twist, queue_size=1), []
        self.bumper = rospy.Subscriber("driven/bumper", Bool, lambda message: self.bumps.append(message.data))
        self.assertTrue(self.odometry.connected() and self.truth.connected())
        self.assertTrue(until(lambda: self.commands.get_num_connections() > 0 and self.bumps))

    def last(self, recorder=None):
        return max((recorder or self.truth).all(), key=lambda message: message.header.stamp)

    def drive(self, speed, turn_rate, condition, timeout=20.0):
        command = Twist()
        command.linear.x, command.angular.z = speed, turn_rate

        def is_there():
            self.commands.publish(command)
            return condition()

        self.assertTrue(until(is_there, timeout))

    def test_1_it_follows_cmd_vel_and_odometry_is_near_the_truth(self):
        self.assertTrue(until(self.truth.all))
        np.testing.assert_allclose(planar(self.last()), 0.0, atol=1e-9)  # the map begins where it does
        self.drive(0.0, 1.0, lambda: abs(planar(self.last())[2]) > 1.0)
        self.drive(-0.3, 0.2, lambda: np.hypot(*planar(self.last())[:2]) > 0.3)
        self.assertTrue(until(lambda: self.last().twist.twist.linear.x == 0.0))  # without new commands
        rested = self.last()
        self.truth.forget()
        self.assertTrue(until(lambda: len(self.truth.all()) > 10))
        self.assertEqual(self.last().pose.pose, rested.pose.pose)
        odometry = self.odometry.at(rested.header.stamp)
        np.testing.assert_allclose(planar(odometry), planar(rested), atol=0.1)
        self.assertFalse(np.allclose(planar(odometry), planar(rested), atol=1e-4))  # wheels slip
        for covariance in (odometry.pose.covariance, odometry.twist.covariance):
            self.assertGreater(np.linalg.eigvalsh(np.reshape(covariance, (6, 6))).min(), 1e-9)
        self.assertEqual((odometry.header.frame_id, odometry.child_frame_id), ("odom", "base_link"))
        self.assertEqual((rested.header.frame_id, rested.child_frame_id), ("map", "base_link"))

    def test_2_a_wall_presses_the_bumper_until_it_goes_back(self):
        self.assertEqual(self.bumps, [False])
        self.drive(0.7, 0.0, lambda: self.bumps[-1])
        self.assertTrue(until(lambda: self.last().twist.twist.linear.x < 0.6))
        self.drive(-0.3, 0.0, lambda: not self.bumps[-1])
        self.assertEqual(self.bumps, [False, True, False])

    def test_3_after_a_reset_it_is_in_the_next_world(self):
        ball = Recorder("driven/ground_truth/ball", Odometry)
        self.assertTrue(until(ball.all))
        answer = rospy.ServiceProxy("driven/ball_simulator/reset", Trigger)()
        self.assertTrue(answer.success)
        self.assertIn("seed 8", answer.message)
        self.assertTrue(until(lambda: np.allclose(planar(self.last()), 0.0, atol=1e-9)))
        stamp = self.last().header.stamp
        np.testing.assert_allclose(planar(self.odometry.at(stamp)), 0.0, atol=1e-9)
        world, at = random_world(2, 8), ball.at(stamp).pose.pose.position
        np.testing.assert_allclose([at.x, at.y], in_frame(world.robot, world.ball), atol=1e-9)

    def test_depth_in_metres_and_calibrations_that_need_no_picture(self):
        info = rospy.wait_for_message("driven/depth/camera_info", CameraInfo, 15.0)
        self.assertEqual((info.width, info.height), (160, 120))
        message = rospy.wait_for_message("driven/depth/image", Image, 15.0)
        depth = pixels_of(message)
        self.assertEqual(message.encoding, "32FC1")
        self.assertTrue(0.2 < np.nanmedian(depth) < 7.0)
        self.assertTrue(0.001 < np.mean(np.isnan(depth)) < 0.2)
        self.assertGreater(np.nanmin(depth), 0.25)

    def test_transforms_are_left_to_others_when_asked(self):
        transforms = Recorder("driven/tf", TFMessage)
        self.truth.forget()
        self.assertTrue(until(lambda: len(self.truth.all()) > 20))
        self.assertEqual(transforms.all(), [])

    def test_what_is_not_a_number_moves_nothing(self):
        command = Twist()
        command.linear.x = float("nan")
        for _ in range(5):
            self.commands.publish(command)
        self.truth.forget()
        self.assertTrue(until(lambda: len(self.truth.all()) > 10))
        self.assertTrue(np.all(np.isfinite(planar(self.last()))))


class StartUpTest(unittest.TestCase):
    def test_mistakes_stop_the_start_with_the_full_name(self):
        mistakes = (
            ("no_such_parameter", "1", "/bad/no_such_parameter: unknown"),
            ("task", "4", "/bad/task: must be one of 2, 3"),
            ("depth_encoding", "mono16", "/bad/depth_encoding: must be one of 16UC1, 32FC1"),
            ("ball_restitution", "1.5", "/bad/ball_restitution: must be within [0, 1]"),
        )
        assert_refused(self, "simulation.ball_simulator", mistakes)


def suite():
    loader = unittest.TestLoader()
    return unittest.TestSuite(map(loader.loadTestsFromTestCase, (PictureTest, DrivenTest, StartUpTest)))


if __name__ == "__main__":
    rospy.init_node("ball_simulator_test")
    rostest.rosrun("sextant", "ball_simulator_test", "__main__.suite")
