# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Base of the simulated robots: clock, cmd_vel, odometry and ground truth."""

import math
import threading
from dataclasses import dataclass
from typing import Dict, Optional, Tuple

import numpy as np
import rospy
import tf2_ros
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from std_msgs.msg import Header

from sextant.base.strict_params import StrictParams, not_empty, param, within
from sextant.messages.pose_messages import pose_to_transform
from sextant.nodes.simulation.simulated_clock import SimulatedClock
from sextant.nodes.simulation.simulator_messages import motion_to_message, reading_to_message
from sextant.simulation.motion import Motion
from sextant.simulation.odometry import OdometryReading


@dataclass(frozen=True)
class SimulatedRobotParams(StrictParams):
    """Simulated time, commands and frames."""

    cmd_vel_timeout: float = param(
        0.5, "simulated time after which a command expires and the robot stops", within(0.01, 1e6), "s"
    )
    real_time_factor: float = param(
        1.0,
        "maximum simulated seconds per second of real time; reduce it on a slow computer",
        within(0.01, 100.0),
    )
    wait_for_subscriber: float = param(
        0.0,
        "maximum time to wait for a subscriber of the images (or observations) before the simulation "
        "starts",
        within(0.0, 3600.0),
        "s",
    )
    publish_tf: bool = param(
        True, "publish `odom` → `base_link`; the transforms to cameras are always published"
    )
    odom_frame: str = param("odom", "odometry frame", not_empty)
    base_frame: str = param("base_link", "frame of the robot", not_empty)


class SimulatedRobot:
    """Subscribes to cmd_vel; publishes odometry, tf and ground truth."""

    def __init__(self, params: SimulatedRobotParams, start: int, queue_size: int):
        """:param start: first stamp, nanoseconds. :param queue_size: messages of odometry"""
        self._params = params
        self._lock, self._stop = threading.Lock(), threading.Event()
        rospy.on_shutdown(self._stop.set)
        if rospy.is_shutdown():  # the hook is not called anymore
            self._stop.set()
        self._clock = SimulatedClock(start, params.real_time_factor, self._stop)
        self._command: Optional[Twist] = None  # None: no command yet
        self._command_end = 0
        self._tf = tf2_ros.TransformBroadcaster()
        self._odometry = rospy.Publisher("odom", Odometry, queue_size=queue_size)
        self._truth = rospy.Publisher("ground_truth", Odometry, queue_size=queue_size)

    def _publish_mounts(self, mounts: Dict[str, np.ndarray]) -> None:
        """Publish static transforms. :param mounts: T_base_camera (4, 4) by the camera's frame"""
        base = Header(stamp=rospy.Time(nsecs=self._clock.now), frame_id=self._params.base_frame)
        self._static_tf = tf2_ros.StaticTransformBroadcaster()
        self._static_tf.sendTransform([pose_to_transform(T, base, frame) for frame, T in mounts.items()])

    def _on_command(self, command: Twist) -> None:
        if not math.isfinite(command.linear.x + command.angular.z):
            rospy.logwarn_throttle(60.0, "cmd_vel is not finite and is ignored")
            return
        with self._lock:
            self._command = command
            self._command_end = self._clock.now + int(1e9 * self._params.cmd_vel_timeout)

    def _commanded(self) -> Tuple[float, float]:
        """Speed (m/s) and turn rate (rad/s); zero without a command or after it expired."""
        is_valid = self._command is not None and self._clock.now <= self._command_end
        command = self._command if is_valid else Twist()
        return command.linear.x, command.angular.z

    def _publish_motion(
        self, stamp: rospy.Time, reading: OdometryReading, truth: Motion, map_frame: str
    ) -> None:
        odom, base = Header(stamp=stamp, frame_id=self._params.odom_frame), self._params.base_frame
        if self._params.publish_tf:
            self._tf.sendTransform(pose_to_transform(reading.motion.pose, odom, base))
        self._odometry.publish(reading_to_message(reading, odom, base))
        in_map = Header(stamp=stamp, frame_id=map_frame)
        self._truth.publish(motion_to_message(truth, in_map, base))
