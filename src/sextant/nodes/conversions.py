# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Poses (4x4 arrays, metres) to messages and back."""

import numpy as np
from geometry_msgs.msg import Point, Pose, Quaternion, Transform, Vector3

import sextant


def quaternion_from_rotation(R: np.ndarray) -> Quaternion:
    """Quaternion of a 3x3 rotation: axis sin(angle / 2), cos(angle / 2)."""
    delta = sextant.log_so3(R)
    half = 0.5 * np.linalg.norm(delta)
    vector = 0.5 * delta * np.sinc(half / np.pi)  # numpy's sinc(x) is sin(pi x) / (pi x)
    return Quaternion(*vector, np.cos(half))


def pose_to_message(T: np.ndarray) -> Pose:
    """geometry_msgs/Pose of a 4x4 pose."""
    return Pose(Point(*T[:3, 3]), quaternion_from_rotation(T[:3, :3]))


def transform_to_message(T: np.ndarray) -> Transform:
    """geometry_msgs/Transform of a 4x4 pose."""
    return Transform(Vector3(*T[:3, 3]), quaternion_from_rotation(T[:3, :3]))


def pose_from_message(pose: Pose) -> np.ndarray:
    """4x4 pose of a geometry_msgs/Pose.

    :raises ValueError: the quaternion is not of unit length (within 1e-3), or a number is not finite
    """
    q = np.array([pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w])
    position = np.array([pose.position.x, pose.position.y, pose.position.z])
    if not (np.all(np.isfinite(position)) and abs(np.linalg.norm(q) - 1.0) < 1e-3):
        raise ValueError("a pose needs a finite position and a quaternion of unit length")
    T = np.eye(4)
    T[:3, :3] = _rotation(q / np.linalg.norm(q))
    T[:3, 3] = position
    return T


def _rotation(q: np.ndarray) -> np.ndarray:
    """Rotation of a unit quaternion x y z w: R = I + 2 w [v]x + 2 [v]x [v]x."""
    cross = np.array([[0.0, -q[2], q[1]], [q[2], 0.0, -q[0]], [-q[1], q[0], 0.0]])
    return np.eye(3) + 2.0 * q[3] * cross + 2.0 * cross @ cross
