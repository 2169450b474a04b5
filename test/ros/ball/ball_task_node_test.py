#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import signal
import subprocess
import sys
import threading
import time
import unittest

import numpy as np
import rospy
import rostest
import tf2_ros
from geometry_msgs.msg import Twist
from nav_msgs.msg import OccupancyGrid, Odometry
from ros_probe import Diagnostics, transform, until
from sensor_msgs.msg import CameraInfo, Image
from start_up import assert_refused
from std_msgs.msg import Bool, Header
from std_srvs.srv import Trigger

from sextant.msg import BallTaskState, Objects

RATE = 20.0  # Hz
STATUS = "ball_task: task"
CODE = "from sextant.nodes.ball.ball_task import main; main()"
BROKEN = """
import sextant.nodes.ball.ball_task as node
step, count = node.BallTask.step, []
def broken(task, view):
    count.append(1 // (20 - len(count)))
    return step(task, view)
node.BallTask.step = broken
node.main()
"""
SIZE, FOCAL, HIGH = (64, 48), 40.0, 0.3  # of a depth camera that looks straight ahead, pixels and metres


def odometry(frame, stamp):
    message = Odometry(child_frame_id="base_link")
    message.header.frame_id, message.header.stamp = frame, stamp
    message.pose.pose.orientation.w = 1.0
    return message


def floor_image(stamp):
    """16UC1 of a floor, by the pinhole camera's formula."""
    below = np.arange(SIZE[1]) - SIZE[1] // 2
    depth = np.where(below > 3, 1000.0 * HIGH * FOCAL / np.maximum(below, 1), 0.0)
    pixels = np.repeat(depth[:, np.newaxis], SIZE[0], axis=1).astype("<u2")
    message = Image(height=SIZE[1], width=SIZE[0], encoding="16UC1", step=2 * SIZE[0], data=pixels.tobytes())
    message.header.frame_id, message.header.stamp = "depth", stamp
    return message


class Robot:
    """Stands at the map's origin and publishes its poses."""

    def __init__(self, namespace=""):
        self.commands, self.states, self.late, self.sees = [], [], 0.0, True
        self._odom = rospy.Publisher(namespace + "odom", Odometry, queue_size=10)
        self._pose = rospy.Publisher(namespace + "odometry/filtered", Odometry, queue_size=10)
        self._depth = rospy.Publisher(namespace + "depth/image", Image, queue_size=1)
        rospy.Subscriber(namespace + "cmd_vel", Twist, self.commands.append)
        rospy.Subscriber(namespace + "ball_task/state", BallTaskState, self.states.append)
        self._publishes, self._ended = threading.Event(), threading.Event()
        self._thread = threading.Thread(target=self._publish, daemon=True)
        self._thread.start()

    def publish(self, is_publishing=True, late=0.0):
        """Starts or stops the poses. :param late: seconds by which their stamps are old"""
        self.late = late
        (self._publishes.set if is_publishing else self._publishes.clear)()

    def _publish(self):
        while not self._ended.wait(1.0 / RATE):
            if self._publishes.is_set():
                stamp = rospy.Time.now() - rospy.Duration(self.late)
                self._odom.publish(odometry("odom", stamp))
                self._pose.publish(odometry("map", stamp))
                if self.sees:
                    self._depth.publish(floor_image(stamp))

    def is_in(self, state):
        return until(lambda: bool(self.states) and self.states[-1].state == state, 10.0)

    def command(self):
        """The next one: (m/s, rad/s); None: there comes none."""
        count = len(self.commands)
        if not until(lambda: len(self.commands) > count, 2.0):
            return None
        return self.commands[-1].linear.x, self.commands[-1].angular.z

    def end(self):
        self._ended.set()
        self._thread.join()


class BallTaskNodeTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot, cls.diagnostics = Robot(), Diagnostics()
        cls.bumper = rospy.Publisher("bumper", Bool, queue_size=1)
        mount = np.eye(4)
        mount[:3, :3], mount[:3, 3] = [[0, 0, 1], [-1, 0, 0], [0, -1, 0]], [0.1, 0.0, HIGH]
        cls.tf = tf2_ros.StaticTransformBroadcaster()
        cls.tf.sendTransform(transform(mount, "base_link", "depth", rospy.Time.now()))
        cls.info = rospy.Publisher("depth/camera_info", CameraInfo, queue_size=1, latch=True)
        K = [FOCAL, 0, SIZE[0] // 2, 0, FOCAL, SIZE[1] // 2, 0, 0, 1]
        cls.info.publish(
            CameraInfo(width=SIZE[0], height=SIZE[1], distortion_model="plumb_bob", K=K, D=[0] * 5)
        )
        assert until(lambda: cls.bumper.get_num_connections() > 0)

    def call(self, name):
        rospy.wait_for_service("ball_task/" + name, 15.0)
        self.assertTrue(rospy.ServiceProxy("ball_task/" + name, Trigger)().success)

    def begin(self):
        self.robot.publish()
        self.call("start")
        self.assertTrue(self.robot.is_in("searching"))

    def restart(self):
        """As of a clock that was set back: nothing is remembered."""
        self.robot.publish(late=100.0)
        self.assertTrue(self.robot.is_in("waiting"))
        self.robot.publish()

    def tearDown(self):
        self.bumper.publish(False)
        self.call("stop")

    def test_it_waits_for_the_start_then_looks_around_until_it_is_stopped(self):
        self.assertTrue(self.robot.is_in("stopped"))
        self.robot.publish()
        self.assertIsNone(self.robot.command())
        self.begin()
        speed, turn_rate = self.robot.command()
        self.assertEqual((speed, turn_rate), (0.0, 0.7))  # search_turn_rate
        self.call("stop")
        self.assertTrue(self.robot.is_in("stopped"))
        self.assertTrue(until(lambda: self.robot.commands[-1] == Twist()))  # after the state
        self.assertIsNone(self.robot.command())  # another node may drive

    def test_commands_come_as_often_as_odometry(self):
        self.begin()
        self.robot.commands.clear()
        time.sleep(1.0)
        self.assertTrue(0.5 * RATE <= len(self.robot.commands) <= 1.5 * RATE, len(self.robot.commands))

    def test_without_poses_it_stands_and_after_a_while_it_has_failed(self):
        self.begin()
        self.robot.publish(False)
        self.assertTrue(self.robot.is_in("waiting"))
        self.assertEqual(self.robot.command(), (0.0, 0.0))
        self.assertIn("/odometry/filtered", self.robot.states[-1].reason)
        self.assertFalse(self.robot.states[-1].ended)
        self.robot.publish()
        self.assertTrue(self.robot.is_in("searching"))
        self.robot.publish(False)
        self.assertTrue(self.robot.is_in("failed"))
        self.assertTrue(self.robot.states[-1].ended)
        self.assertTrue(until(lambda: self.robot.commands[-1] == Twist()))  # after the state
        self.assertTrue(until(lambda: self.diagnostics.summary(STATUS).startswith("failed: no pose")))

    def test_where_no_pose_ever_comes_it_has_failed_too(self):
        self.robot.publish(False)
        self.call("start")
        self.assertTrue(self.robot.is_in("failed"))

    def test_when_the_depth_camera_is_dead_it_stands(self):
        self.begin()
        self.robot.sees = False
        self.assertTrue(self.robot.is_in("waiting"))
        self.assertIn("no message on /depth/image in the last 0.5 s", self.robot.states[-1].reason)
        self.assertEqual(self.robot.command(), (0.0, 0.0))
        self.robot.sees = True
        self.assertTrue(self.robot.is_in("searching"))

    def test_when_the_detector_is_dead_it_stands(self):
        """Only once it has published: without a detector, other nodes may publish ball and pillars."""
        self.begin()
        objects = rospy.Publisher("objects", Objects, queue_size=1)
        self.assertTrue(until(lambda: objects.get_num_connections() > 0))
        objects.publish(Objects(header=Header(stamp=rospy.Time.now())))
        self.assertTrue(self.robot.is_in("waiting"))
        self.assertIn("no message on /objects", self.robot.states[-1].reason)
        objects.publish(Objects(header=Header(stamp=rospy.Time.now())))
        self.assertTrue(self.robot.is_in("searching"))
        self.restart()

    def test_it_does_not_drive_by_poses_of_another_time(self):
        for late in (5.0, -5.0):
            self.begin()
            self.robot.publish(late=late)
            self.assertTrue(self.robot.is_in("waiting"))
            self.robot.commands.clear()
            self.assertEqual(self.robot.command(), (0.0, 0.0))
            self.robot.publish(False)

    def test_the_bumper_drives_it_back(self):
        self.begin()
        self.bumper.publish(True)
        self.assertTrue(self.robot.is_in("recovering"))
        self.assertTrue(until(lambda: self.robot.commands[-1].linear.x < 0.0))
        self.bumper.publish(False)
        self.call("stop")
        self.assertTrue(self.robot.is_in("stopped"))
        self.begin()  # what touched it before is forgotten

    def test_depth_images_become_the_floor(self):
        floors = []
        subscriber = rospy.Subscriber("floor", OccupancyGrid, floors.append)
        self.begin()
        self.assertTrue(until(lambda: bool(floors) and 0 in floors[-1].data))
        subscriber.unregister()
        floor = floors[-1]
        cells = np.array(floor.data).reshape(floor.info.height, floor.info.width)
        rows, columns = np.nonzero(cells == 0)
        x = floor.info.origin.position.x + floor.info.resolution * (columns + 0.5)
        y = floor.info.origin.position.y + floor.info.resolution * (rows + 0.5)
        nearest = 0.1 + HIGH * FOCAL / (SIZE[1] / 2 - 1)  # of the lowest row
        self.assertTrue(0.0 <= x.min() - nearest + 0.05 < 0.1, x.min())
        self.assertTrue(2.5 < x.max() < 3.05, x.max())  # grid_max_range
        self.assertAlmostEqual(y.min(), -y.max(), delta=0.15)
        self.assertEqual((cells == 100).sum(), 0)


class EndTest(unittest.TestCase):
    def test_what_fails_in_a_step_does_not_leave_the_robot_driving(self):
        robot = Robot("/broken/")
        command = [sys.executable, "-c", BROKEN, "__ns:=/broken", "_use_depth:=false"]
        node = subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL)
        robot.publish()
        _, errors = node.communicate(timeout=20.0)
        self.assertEqual(node.returncode, 1)
        self.assertIn(b"ZeroDivisionError", errors)
        self.assertTrue(any(each.angular.z > 0.0 for each in robot.commands))
        self.assertTrue(until(lambda: robot.commands[-1] == Twist(), 2.0))
        robot.end()

    def test_on_a_shutdown_its_last_command_is_to_stand(self):
        robot = Robot("/other/")
        node = subprocess.Popen([sys.executable, "-c", CODE, "__ns:=/other", "_use_depth:=false"])
        robot.publish()
        self.assertTrue(until(lambda: any(each.angular.z > 0.0 for each in robot.commands)))
        node.send_signal(signal.SIGINT)
        self.assertEqual(node.wait(20.0), 0)
        self.assertTrue(until(lambda: robot.commands[-1] == Twist(), 2.0))
        robot.end()

    def test_mistakes_stop_the_start_with_the_full_name(self):
        mistakes = (
            ("no_such_parameter", "1", "/bad/no_such_parameter: unknown"),
            ("max_kicks", "1.5", "/bad/max_kicks: must be a whole number"),
            ("run_up", "0.2", "/bad/run_up: must be at least"),
        )
        assert_refused(self, "ball.ball_task", mistakes)


def suite():
    loader = unittest.TestLoader()
    return unittest.TestSuite(map(loader.loadTestsFromTestCase, (BallTaskNodeTest, EndTest)))


if __name__ == "__main__":
    rospy.init_node("ball_task_node_test")
    rostest.rosrun("sextant", "ball_task_node_test", "__main__.suite")
