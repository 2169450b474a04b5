#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import unittest

import numpy as np
import rospy
import rostest
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from ros_probe import Recorder, TransformRecorder, matrix, until
from start_up import assert_refused
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

from sextant.geometry.plane_poses import composed, in_frame, relative
from sextant.msg import LandmarkObservations
from sextant.simulation.landmark_world import LandmarkWorld, LandmarkWorldParams

DURATION, RATE, DELAY = 6.0, 20, 0.3  # as in the .test file
PARAMS = LandmarkWorldParams(
    seed=3, classes=2, duration=DURATION, delay=DELAY, range_noise=(0.03, 0.0), odometry_rate=RATE
)
START = 10_000_000_000  # nanoseconds


def stamp_of(seconds):
    """Of a step of the drive."""
    return rospy.Time(nsecs=START + round(1e9 * seconds))


def planar(message):
    """(3,) of an Odometry."""
    T = matrix(message.pose.pose)
    return np.array([T[0, 3], T[1, 3], np.arctan2(T[1, 0], T[0, 0])])


class Watch(Recorder):
    """Stamps of received messages, and when they came by the clock."""

    def __init__(self, topic, type_):
        self.received = {}
        super().__init__(topic, type_)

    def _on_message(self, msg):
        self.received[msg.header.stamp] = rospy.Time.now()
        super()._on_message(msg)


class DriveTest(unittest.TestCase):
    """The whole drive is known beforehand."""

    @classmethod
    def setUpClass(cls):
        cls.odometry, cls.truth = Recorder("odom", Odometry), Recorder("ground_truth", Odometry)
        cls.tf = TransformRecorder()
        assert cls.odometry.connected() and cls.truth.connected()
        cls.observations = Watch("landmarks", LandmarkObservations)  # the drive waits for it
        cls.steps = list(LandmarkWorld(PARAMS).steps())
        assert until(lambda: cls.odometry.has(stamp_of(DURATION)), 60)

    def test_odometry_and_truth_are_those_of_the_world(self):
        pose, start = np.zeros(3), LandmarkWorld(PARAMS).start
        for step in self.steps:
            stamp, pose = stamp_of(step.stamp), composed(pose, step.odometry_step)
            published, true = self.odometry.at(stamp), self.truth.at(stamp)
            np.testing.assert_allclose(planar(published), pose, atol=1e-9)
            np.testing.assert_allclose(planar(true), relative(start, step.pose), atol=1e-9)
            self.assertEqual((published.header.frame_id, published.child_frame_id), ("odom", "base_link"))
            self.assertEqual((true.header.frame_id, true.child_frame_id), ("map", "base_link"))
            self.assertAlmostEqual(published.twist.twist.linear.x, step.odometry_step[0] * RATE)
            self.assertAlmostEqual(true.twist.twist.angular.z, step.turn_rate)
            T = self.tf.at("odom", "base_link", stamp)
            np.testing.assert_allclose(T, matrix(published.pose.pose), atol=1e-12)

    def test_observations_come_late_with_the_stamp_of_their_moment(self):
        scans = [step.scan for step in self.steps if step.scan]
        stamps = [stamp_of(scan.stamp) for scan in scans]
        self.assertEqual(sorted(message.header.stamp for message in self.observations.all()), stamps)
        for stamp, scan in zip(stamps, scans):
            message = self.observations.at(stamp)
            self.assertEqual(message.header.frame_id, "base_link")
            published = [(each.class_name, each.id, [each.x, each.y]) for each in message.observations]
            self.assertEqual(
                published, [(seen.class_name, -1, list(seen.position)) for seen in scan.observations]
            )
            for each, seen in zip(message.observations, scan.observations):
                np.testing.assert_array_equal(np.reshape(each.covariance, (3, 3))[:2, :2], seen.covariance)
                self.assertTrue(np.isnan(each.heading))
        late = [(self.observations.received[stamp] - stamp).to_sec() for stamp in stamps]
        self.assertGreater(max(late), DELAY - 0.05)  # the clock's ticks come another way, some late

    def test_the_true_landmarks_are_outlined(self):
        world = LandmarkWorld(PARAMS)
        (shape,) = rospy.wait_for_message("ground_truth/landmarks", MarkerArray, 15.0).markers
        self.assertEqual(shape.header.frame_id, "map")
        points = np.array([[point.x, point.y] for point in shape.points]).reshape(len(world.positions), -1, 2)
        for circle, position in zip(points, in_frame(world.start, world.positions)):
            np.testing.assert_allclose(np.hypot(*(circle - position).T), 0.08, atol=1e-9)


class CommandTest(unittest.TestCase):
    """A robot of its own, that drives straight ahead until it receives a command."""

    def setUp(self):
        self.truth, self.odometry = (
            Recorder("commanded/" + name, Odometry) for name in ("ground_truth", "odom")
        )
        self.commands = rospy.Publisher("commanded/cmd_vel", Twist, queue_size=1)
        self.assertTrue(self.odometry.connected() and self.truth.connected())
        self.assertTrue(until(lambda: self.commands.get_num_connections() > 0))

    def last(self):
        return max(self.truth.all(), key=lambda message: message.header.stamp)

    def test_it_moves_randomly_until_the_first_command(self):
        self.assertTrue(until(self.truth.all))
        self.assertEqual(self.last().twist.twist.linear.x, 0.5)
        command = Twist()
        command.linear.x, command.angular.z = 0.2, -0.5

        def obeys():
            self.commands.publish(command)
            twist = self.last().twist.twist
            return (twist.linear.x, twist.angular.z) == (0.2, -0.5)

        self.assertTrue(until(obeys))
        self.assertTrue(until(lambda: self.last().twist.twist == Twist()))  # no more commands
        rested = self.last()
        self.truth.forget()
        self.assertTrue(until(lambda: len(self.truth.all()) > 10))
        self.assertEqual(self.last().pose.pose, rested.pose.pose)
        self.assert_carried()

    def assert_carried(self):
        before, T_odom_base = planar(self.last()), planar(self.odometry.at(self.last().header.stamp))
        answer = rospy.ServiceProxy("commanded/landmark_simulator/kidnap", Trigger)()
        self.assertTrue(answer.success)
        self.assertTrue(until(lambda: not np.array_equal(planar(self.last()), before)))
        distance = np.hypot(*(planar(self.last()) - before)[:2])
        self.assertEqual(answer.message, f"carried {distance:.1f} m away, without odometry")
        np.testing.assert_array_equal(planar(self.odometry.at(self.last().header.stamp)), T_odom_base)

    def test_transforms_are_left_to_others_when_asked(self):
        transforms = Recorder("commanded/tf", TFMessage)
        self.truth.forget()
        self.assertTrue(until(lambda: len(self.truth.all()) > 20))
        self.assertEqual(transforms.all(), [])


class StartUpTest(unittest.TestCase):
    def test_mistakes_stop_the_start_with_the_full_name(self):
        mistakes = (
            ("no_such_parameter", "1", "/bad/no_such_parameter: unknown"),
            ("range_noise", "[0.1]", "/bad/range_noise: must be two numbers"),
            ("detection_probability", "0.0", "/bad/detection_probability: must be within"),
        )
        assert_refused(self, "simulation.landmark_simulator", mistakes)


def suite():
    loader = unittest.TestLoader()
    return unittest.TestSuite(map(loader.loadTestsFromTestCase, (DriveTest, CommandTest, StartUpTest)))


if __name__ == "__main__":
    rospy.init_node("landmark_simulator_test")
    rostest.rosrun("sextant", "landmark_simulator_test", "__main__.suite")
