# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Node teleop: drives the robot by the keyboard or a joystick, for instance to record a drive."""

import threading
import time
from dataclasses import dataclass

import rospy
from geometry_msgs.msg import Twist

from sextant.base.strict_params import Check, StrictParams, param, within
from sextant.nodes.base.exits import fatal
from sextant.nodes.base.init_node import init_node
from sextant.nodes.base.params import read_params
from sextant.nodes.driving.teleop_controls import Command, Joystick, Keyboard

SEND_TIME = 0.1  # seconds that the final command has to leave the node


@dataclass(frozen=True)
class TeleopParams(StrictParams):
    """Parameters of the node."""

    joystick: str = param(
        "", "device of a joystick, e.g. /dev/input/js0; empty: the keyboard", Check("a path")
    )
    speed: float = param(0.3, "maximum speed", within(0.01, 5.0), "m/s")
    turn_rate: float = param(0.8, "maximum rate of rotation", within(0.01, 10.0), "rad/s")
    rate: float = param(10.0, "rate of commands", within(1.0, 100.0), "Hz")


class Teleop:
    """Publishes `cmd_vel` while the person drives, and a stop after that."""

    def __init__(self, params: TeleopParams):
        """:raises OSError: there is no terminal, or the joystick cannot be opened"""
        self._params = params
        self._controls = Joystick(params.joystick) if params.joystick else Keyboard()
        self._publisher = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self._stopped = True
        self._lock, self._end = threading.Lock(), threading.Event()  # no command after the final stop
        rospy.on_shutdown(self._stop)  # before rospy closes the topic
        rospy.loginfo(self._controls.help)

    def run(self) -> None:
        """Until the node is shut down; then the robot is stopped.

        :raises OSError: the joystick was unplugged
        """
        try:
            while not self._end.wait(1.0 / self._params.rate):
                command = self._controls.read(time.monotonic())
                with self._lock:
                    if not self._end.is_set():
                        self._publish(command)
        finally:
            self._stop()
            self._controls.close()

    def _stop(self) -> None:
        with self._lock:
            if self._end.is_set():
                return
            self._end.set()
            self._publish(Command())
        time.sleep(SEND_TIME)

    def _publish(self, command: Command) -> None:
        is_stop = command == Command()
        if is_stop and self._stopped:
            return  # another node may drive
        self._stopped = is_stop
        twist = Twist()
        twist.linear.x = self._params.speed * command.forward
        twist.angular.z = self._params.turn_rate * command.left
        self._publisher.publish(twist)


def main() -> None:
    """Runs the node."""
    init_node("teleop")
    with fatal(OSError):
        Teleop(read_params(TeleopParams)).run()
