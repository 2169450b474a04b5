#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import signal
import subprocess
import tempfile
import unittest

import rospy
import rostest
from rosgraph_msgs.msg import Clock

SIMULATORS = ("simulator", "landmark_simulator", "ball_simulator")
PATIENCE = 60.0  # seconds


class SimulatedTimeTest(unittest.TestCase):
    """A master outlives the simulations on it: what starts afterwards shall have a time."""

    def start(self, *command):
        log = tempfile.TemporaryFile("w+")
        self.addCleanup(log.close)
        process = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT)
        self.addCleanup(process.kill)
        return process

    def simulate(self, simulator, *args):
        rospy.set_param("/use_sim_time", True)
        self.addCleanup(rospy.set_param, "/use_sim_time", False)
        return self.start("rosrun", "sextant", simulator, *args)

    def interrupt(self, process, clock="/clock"):
        """As soon as it publishes."""
        rospy.wait_for_message(clock, Clock, PATIENCE)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(PATIENCE), 0)

    def test_every_simulator_removes_it_at_its_end(self):
        for simulator in SIMULATORS:
            process = self.simulate(simulator)
            self.interrupt(process)
            self.assertFalse(rospy.has_param("/use_sim_time"), simulator)

    def test_a_simulator_that_refuses_to_start_removes_it(self):
        for simulator in SIMULATORS:
            process = self.simulate(simulator, "_nonsense:=1", f"__name:=refused_{simulator}")
            self.assertEqual(process.wait(PATIENCE), 1)
            self.assertFalse(rospy.has_param("/use_sim_time"), simulator)

    def test_a_clock_that_others_publish_stays(self):
        process = self.simulate("landmark_simulator", "__name:=second")
        clock = rospy.Publisher("/clock", Clock, queue_size=1)
        self.addCleanup(clock.unregister)
        self.interrupt(process)
        self.assertTrue(rospy.get_param("/use_sim_time"))

    def test_a_clock_of_its_own_is_not_that_of_the_master(self):
        process = self.simulate("landmark_simulator", "__name:=third", "/clock:=/third/clock")
        self.interrupt(process, "/third/clock")
        self.assertTrue(rospy.get_param("/use_sim_time"))

    def test_a_demo_leaves_none(self):
        process = self.start("roslaunch", "sextant", "landmarks_demo.launch")
        self.addCleanup(rospy.set_param, "/use_sim_time", False)
        self.interrupt(process)
        self.assertFalse(rospy.has_param("/use_sim_time"))


if __name__ == "__main__":
    rospy.init_node("simulated_time_test")
    rostest.rosrun("sextant", "simulated_time", SimulatedTimeTest)
