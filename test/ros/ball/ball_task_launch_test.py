#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import unittest

import numpy as np
import rospy
import rostest
from nav_msgs.msg import Odometry, Path
from ros_probe import Recorder, until
from std_msgs.msg import Bool
from std_srvs.srv import Trigger
from visualization_msgs.msg import MarkerArray

from sextant.geometry.plane_poses import in_frame
from sextant.msg import BallTaskState
from sextant.simulation.ball_world import random_world

SEED = 4  # as in the .test file
RADIUS = 0.177  # of the robot, metres
PATIENCE = 75.0  # s of the wall's clock


def place(message):
    return np.array([message.pose.pose.position.x, message.pose.pose.position.y])


class BallTaskTest(unittest.TestCase):
    """The shipped launch file, from images to the task, against the ground truth."""

    @classmethod
    def setUpClass(cls):
        cls.robot, cls.ball = Recorder("ground_truth", Odometry), Recorder("ground_truth/ball", Odometry)
        cls.states, cls.bumps, cls.drawn, cls.plans = [], [], [], []
        rospy.Subscriber("ball_task/state", BallTaskState, cls.states.append)
        rospy.Subscriber("bumper", Bool, lambda message: cls.bumps.append(message.data))
        rospy.Subscriber("visualization", MarkerArray, cls.drawn.append)
        rospy.Subscriber("plan", Path, cls.plans.append)
        assert cls.robot.connected() and cls.ball.connected()
        world = random_world(2, SEED)
        cls.posts = in_frame(world.robot, np.array([[each.x, each.y] for each in world.pillars[:2]]))
        cls.start = in_frame(world.robot, world.ball)

    def last(self, recorder):
        return place(max(recorder.all(), key=lambda message: message.header.stamp))

    def before(self, point):
        """Metres before the goal's line, and metres along it from the first post."""
        along = (self.posts[1] - self.posts[0]) / np.linalg.norm(self.posts[1] - self.posts[0])
        across = np.array([along[1], -along[0]])
        across *= np.sign((self.start - self.posts[0]) @ across)
        return (point - self.posts[0]) @ across, (point - self.posts[0]) @ along

    def test_the_ball_is_behind_the_goal_and_the_robot_before_it(self):
        rospy.wait_for_service("ball_task/start", 15.0)
        self.assertTrue(rospy.ServiceProxy("ball_task/start", Trigger)().success)
        self.assertTrue(until(lambda: self.states and self.states[-1].state not in ("stopped", "waiting")))
        self.assertTrue(until(lambda: self.states[-1].ended, PATIENCE))
        self.assertEqual(self.states[-1].state, "done", self.states[-1].reason)
        stopped = self.states[-1].header.stamp
        self.robot.forget()
        self.assertTrue(until(lambda: any(each.header.stamp > stopped for each in self.robot.all())))
        behind, along = self.before(self.last(self.ball))
        self.assertLess(behind, 0.0)
        self.assertTrue(0.0 < along < np.linalg.norm(self.posts[1] - self.posts[0]), along)
        self.assertAlmostEqual(self.before(self.last(self.robot))[0] - RADIUS, 0.2, delta=0.05)
        self.assertNotIn(True, self.bumps)
        self.assertGreaterEqual(self.states[-1].kicks, 1)
        self.check_what_was_shown()

    def check_what_was_shown(self):
        order = list(dict.fromkeys(each.state for each in self.states))
        expected = ["searching", "approaching", "aligning", "kicking", "watching", "stopping", "done"]
        self.assertEqual([state for state in order if state in expected], expected)
        line = next(each for each in self.drawn[-1].markers if each.ns == "goal")
        ends = np.array([[each.x, each.y] for each in line.points])
        off = np.linalg.norm(ends[:, np.newaxis] - self.posts, axis=2).min(axis=1)
        self.assertLess(off.max(), 0.2)
        self.assertTrue(any(len(plan.poses) > 1 for plan in self.plans))


if __name__ == "__main__":
    rospy.init_node("ball_task_launch_test")
    rostest.rosrun("sextant", "ball_task_launch_test", BallTaskTest)
