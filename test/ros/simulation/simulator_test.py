#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import time
import unittest

import numpy as np
import rospy
import rostest
import tf2_ros
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, Image
from start_up import assert_refused
from std_msgs.msg import Bool
from tf2_msgs.msg import TFMessage

from sextant.messages.pose_messages import pose_from_message
from sextant.simulation.drive import DriveParams, SimulatedDrive

FRAMES = 45
PARAMS = DriveParams(width=160, height=120, distortion=[-0.2, 0.05, 0.001, -0.001, 0.0], seed=3)
TOPICS = {
    "/clock": Clock,
    "odom": Odometry,
    "ground_truth": Odometry,
    "camera/camera_info": CameraInfo,
    "finished": Bool,
    "camera/image_raw": Image,
}


def wait_until(condition, seconds=60.0):
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            raise AssertionError(f"nothing happened for {seconds:.0f} s")
        time.sleep(0.02)


class Drive:
    """All messages of the node of the path, received once for all tests."""

    received = {topic: [] for topic in TOPICS}

    @classmethod
    def listen(cls):
        cls.tf = tf2_ros.Buffer(rospy.Duration(60.0))
        cls.listener = tf2_ros.TransformListener(cls.tf)
        for topic, kind in TOPICS.items():  # the image last: the drive waits for its listener
            cls.subscriber = rospy.Subscriber(topic, kind, cls.received[topic].append, queue_size=1000)
            wait_until(lambda: cls.subscriber.get_num_connections() > 0)
        wait_until(lambda: any(message.data for message in cls.received["finished"]))
        for topic in ("odom", "ground_truth", "camera/camera_info", "camera/image_raw"):
            wait_until(lambda topic=topic: len(cls.received[topic]) >= FRAMES)

    @classmethod
    def stamps(cls, topic):
        return [message.header.stamp.to_nsec() for message in cls.received[topic]]


class PathTest(unittest.TestCase):
    def test_every_frame_comes_once_with_one_stamp_on_all_topics(self):
        expected = [10**9 + round(k * 1e9 / 30.0) for k in range(FRAMES)]
        for topic in ("camera/image_raw", "camera/camera_info", "odom", "ground_truth"):
            self.assertEqual(Drive.stamps(topic), expected, topic)

    def test_images_and_truth_are_those_of_the_library(self):
        drive = SimulatedDrive(PARAMS)
        for frame, image, truth in zip(
            drive.frames(FRAMES), Drive.received["camera/image_raw"], Drive.received["ground_truth"]
        ):
            self.assertEqual(
                (image.encoding, image.step, image.header.frame_id), ("mono8", 160, "camera_optical_frame")
            )
            self.assertEqual(image.data, frame.image.tobytes())
            self.assertEqual((truth.header.frame_id, truth.child_frame_id), ("map", "base_link"))
            np.testing.assert_allclose(pose_from_message(truth.pose.pose), frame.T_map_base, atol=1e-9)

    def test_calibration_is_the_cameras(self):
        calibration = SimulatedDrive(PARAMS).calibration
        info = Drive.received["camera/camera_info"][0]
        self.assertEqual((info.width, info.height, info.distortion_model), (160, 120, "plumb_bob"))
        self.assertEqual(list(info.D), PARAMS.distortion)
        np.testing.assert_array_equal(np.reshape(info.K, (3, 3)), calibration.K)
        np.testing.assert_array_equal(np.reshape(info.P, (3, 4)), calibration.P)

    def test_odometry_has_a_covariance_that_can_be_inverted(self):
        for message in Drive.received["odom"]:
            for covariance in (message.pose.covariance, message.twist.covariance):
                self.assertGreater(np.linalg.eigvalsh(np.reshape(covariance, (6, 6))).min(), 1e-9)
        last = np.reshape(Drive.received["odom"][-1].pose.covariance, (6, 6))
        self.assertGreater(last[0, 0], 1e-5)

    def test_tf_has_odometry_at_every_image_and_the_mount(self):
        for stamp, odometry in zip(Drive.stamps("camera/image_raw"), Drive.received["odom"]):
            found = Drive.tf.lookup_transform(
                "odom", "base_link", rospy.Time(nsecs=stamp), rospy.Duration(0.0)
            )
            self.assertAlmostEqual(found.transform.translation.x, odometry.pose.pose.position.x, places=9)
        mount = Drive.tf.lookup_transform("base_link", "camera_optical_frame", rospy.Time(0)).transform
        self.assertEqual((mount.translation.x, mount.translation.y, mount.translation.z), (0.1, 0.0, 1.0))
        self.assertAlmostEqual(abs(mount.rotation.x), 0.5)

    def test_clock_ticks_finely_and_goes_on_after_the_last_frame(self):
        ticks = [message.clock.to_nsec() for message in list(Drive.received["/clock"])]
        steps = np.diff(ticks)
        self.assertGreaterEqual(np.min(steps), 0)
        self.assertLessEqual(np.median(steps), 10**7)  # rospy may drop some when busy
        wait_until(lambda: Drive.received["/clock"][-1].clock.to_nsec() > Drive.stamps("odom")[-1] + 10**9)
        self.assertEqual(len(Drive.received["camera/image_raw"]), FRAMES)


class CommandTest(unittest.TestCase):
    def setUp(self):
        self.truth = []
        self.command = rospy.Publisher("driven/cmd_vel", Twist, queue_size=1)
        self.subscriber = rospy.Subscriber(
            "driven/ground_truth", Odometry, self.truth.append, queue_size=1000
        )
        wait_until(lambda: self.truth and self.command.get_num_connections() > 0)

    def tearDown(self):
        self.subscriber.unregister()

    def drive(self, speed, turn_rate, frames):
        """The frames while commands came."""
        command = Twist()
        command.linear.x, command.angular.z = speed, turn_rate
        begin = len(self.truth)
        end = time.monotonic() + 60.0
        while len(self.truth) < begin + frames and time.monotonic() < end:
            self.command.publish(command)
            time.sleep(0.01)
        self.assertGreaterEqual(len(self.truth), begin + frames)
        return self.truth[begin:]

    def test_robot_obeys_and_stops_when_nobody_commands(self):
        frames = self.drive(0.2, 0.6, 60)  # on a busy machine it may rest in between: no command came in time
        is_turning = [m.twist.twist.angular.z != 0.0 for m in frames]
        self.assertGreater(sum(is_turning), 20)
        for before, frame, obeys in zip(frames, frames[1:], is_turning[1:]):
            moved = np.linalg.inv(pose_from_message(before.pose.pose)) @ pose_from_message(frame.pose.pose)
            seconds = (frame.header.stamp - before.header.stamp).to_sec()
            radius, turn = 0.2 / 0.6, 0.6 * seconds * obeys  # a circle
            np.testing.assert_allclose(
                moved[:2, 3], [radius * np.sin(turn), radius * (1.0 - np.cos(turn))], atol=1e-6
            )
            speed = frame.twist.twist.linear.x, frame.twist.twist.angular.z
            self.assertEqual(speed, (0.2, 0.6) if obeys else (0.0, 0.0))
        wait_until(lambda: self.truth[-1].twist.twist.linear.x == 0.0)
        rested = self.truth[-1].pose.pose
        wait_until(lambda: len(self.truth) > len(frames) + 100)
        self.assertEqual(self.truth[-1].pose.pose, rested)

    def test_walls_hold_the_robot(self):
        for message in self.drive(3.0, 0.0, 150):
            self.assertLess(
                np.max(np.abs([message.pose.pose.position.x, message.pose.pose.position.y])), 2.8 + 1e-9
            )
        self.assertEqual(self.truth[-1].twist.twist.linear.x, 0.0)

    def test_odometry_transform_is_left_to_others_when_asked(self):
        transforms = []
        subscriber = rospy.Subscriber("driven/tf", TFMessage, transforms.append)
        seen = len(self.truth)
        wait_until(lambda: len(self.truth) > seen + 30)
        subscriber.unregister()
        self.assertEqual(transforms, [])


class StartUpTest(unittest.TestCase):
    def test_mistakes_stop_the_start_with_the_full_name(self):
        mistakes = (
            ("no_such_parameter", "1", "unknown"),
            ("noise_sigma", "loud", "must be"),
            ("width", "-5", "must be within [16, 8192]"),
            ("motion", "fly", "must be one of"),
            ("map_file", "/no/such/map.yaml", "/no/such/map.yaml"),
            ("family", "tag99h99", "tag99h99"),
        )
        assert_refused(self, "simulation.simulator", mistakes)


def suite():
    loader = unittest.TestLoader()
    return unittest.TestSuite(map(loader.loadTestsFromTestCase, (PathTest, CommandTest, StartUpTest)))


if __name__ == "__main__":
    rospy.init_node("simulator_test")
    Drive.listen()
    rostest.rosrun("sextant", "simulator_test", "__main__.suite")
