#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import os
import pty
import signal
import struct
import subprocess
import tempfile
import unittest

import rospy
import rostest
from geometry_msgs.msg import Twist
from ros_probe import WAIT, until

STOP = (0.0, 0.0)


class TeleopTest(unittest.TestCase):
    def setUp(self):
        self.commands = []
        self.subscriber = rospy.Subscriber("cmd_vel", Twist, self.on_command)
        self.addCleanup(self.subscriber.unregister)

    def on_command(self, msg):
        self.commands.append((msg.linear.x, msg.angular.z))

    def start(self, *args, stdin):
        command = ["rosrun", "sextant", "teleop", "_speed:=0.5", "_turn_rate:=1.5", *args]
        node = subprocess.Popen(
            command, stdin=stdin, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True
        )
        self.addCleanup(rospy.delete_param, "/teleop")
        self.addCleanup(node.communicate)
        self.addCleanup(node.kill)
        return node

    def connected(self):
        return until(lambda: self.subscriber.get_num_connections() > 0, WAIT)

    def commands_until(self, command):
        """The commands up to this one, at most WAIT seconds."""
        self.assertTrue(until(lambda: command in self.commands, WAIT), (command, self.commands))
        return self.commands[: self.commands.index(command)]

    def test_a_pressed_key_drives_until_it_is_released(self):
        person, terminal = pty.openpty()
        self.addCleanup(os.close, person)
        node = self.start(stdin=terminal)
        os.close(terminal)
        self.assertTrue(self.connected())
        self.assertEqual(self.commands, [])  # another node may drive
        os.write(person, b"e")
        self.assertEqual(set(self.commands_until(STOP)), {(0.5, -1.5)})
        self.assert_stops_at_its_end(node, person, lambda: node.send_signal(signal.SIGHUP))

    def test_the_robot_stops_when_the_terminal_is_closed(self):
        person, terminal = pty.openpty()
        node = self.start(stdin=terminal)
        os.close(terminal)
        self.assertTrue(self.connected())
        self.assert_stops_at_its_end(node, person, lambda: os.close(person))

    def assert_stops_at_its_end(self, node, person, end):
        os.write(person, b"s")
        self.commands_until((-0.5, 0.0))
        self.commands.clear()
        end()  # while the key is held
        node.communicate(timeout=WAIT)
        self.commands_until(STOP)

    def test_a_joystick_drives_while_a_button_is_held_and_the_robot_stops_when_it_is_unplugged(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        device = os.path.join(folder.name, "js0")
        os.mkfifo(device)
        node = self.start("_joystick:=" + device, stdin=subprocess.DEVNULL)
        self.assertTrue(self.connected())  # it has opened the device before
        driver = os.open(device, os.O_WRONLY | os.O_NONBLOCK)
        for kind, number, value in ((2, 1, -32767), (1, 4, 1)):  # stick forward, button
            os.write(driver, struct.pack("=IhBB", 1234, value, kind, number))
        self.commands_until((0.5, 0.0))
        os.close(driver)
        output, _ = node.communicate(timeout=WAIT)
        self.assertNotEqual(node.returncode, 0)
        self.assertIn("js0 was unplugged", output.decode())
        self.commands_until(STOP)


if __name__ == "__main__":
    rospy.init_node("teleop_test")
    rostest.rosrun("sextant", "teleop", TeleopTest)
