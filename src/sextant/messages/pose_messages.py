# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Converts poses (4x4 arrays, metres) to messages and back."""

import numpy as np
from geometry_msgs.msg import Point, Pose, Quaternion, Transform, TransformStamped, Vector3
from std_msgs.msg import Header

from sextant.geometry.poses import pose_of_fields, quaternion_of


def pose_to_message(T: np.ndarray) -> Pose:
    """Converts a 4x4 pose to geometry_msgs/Pose."""
    return Pose(Point(*T[:3, 3]), Quaternion(*quaternion_of(T[:3, :3])))


def transform_to_message(T: np.ndarray) -> Transform:
    """Converts a 4x4 pose to geometry_msgs/Transform."""
    return Transform(Vector3(*T[:3, 3]), Quaternion(*quaternion_of(T[:3, :3])))


def pose_from_message(pose: Pose) -> np.ndarray:
    """Converts a geometry_msgs/Pose to a 4x4 pose; raises as sextant.pose_from_quaternion()."""
    return pose_of_fields(pose.position, pose.orientation)


def pose_from_transform(transform: Transform) -> np.ndarray:
    """Converts a geometry_msgs/Transform to a 4x4 pose; raises as sextant.pose_from_quaternion()."""
    return pose_of_fields(transform.translation, transform.rotation)


def pose_to_transform(T: np.ndarray, header: Header, child_frame: str) -> TransformStamped:
    """Convert a pose (4, 4) for tf."""
    return TransformStamped(header, child_frame, transform_to_message(T))
