# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Conversion of a simulated drive to messages."""

import numpy as np
from geometry_msgs.msg import Twist, Vector3
from nav_msgs.msg import Odometry
from std_msgs.msg import Header

from sextant.messages.pose_messages import pose_to_message
from sextant.simulation.motion import Motion
from sextant.simulation.odometry import OdometryReading

# m^2 or rad^2, added to all variances, since filters reject zero: wheels do not measure z, roll and pitch
ADDED_VARIANCE = 1e-6
PLANAR = [0, 1, 5]  # x, y and yaw among x y z roll pitch yaw


def motion_to_message(motion: Motion, header: Header, child_frame: str) -> Odometry:
    """Convert a motion; the covariances are left at zero."""
    message = Odometry(header=header, child_frame_id=child_frame)
    message.pose.pose = pose_to_message(motion.pose)
    message.twist.twist = Twist(Vector3(motion.speed, 0.0, 0.0), Vector3(0.0, 0.0, motion.turn_rate))
    return message


def reading_to_message(reading: OdometryReading, header: Header, child_frame: str) -> Odometry:
    """Convert wheel odometry with covariances."""
    message = motion_to_message(reading.motion, header, child_frame)
    pose, twist = np.zeros((6, 6)), np.zeros((6, 6))
    pose[np.ix_(PLANAR, PLANAR)] = reading.covariance
    twist[PLANAR, PLANAR] = reading.speed_variance, 0.0, reading.turn_rate_variance
    message.pose.covariance = list(np.ravel(pose + ADDED_VARIANCE * np.eye(6)))
    message.twist.covariance = list(np.ravel(twist + ADDED_VARIANCE * np.eye(6)))
    return message
