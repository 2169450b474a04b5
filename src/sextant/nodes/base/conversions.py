# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Poses (4x4 arrays, metres) to messages and back, and pictures to messages."""

import numpy as np
from geometry_msgs.msg import Point, Pose, Quaternion, Transform, Vector3
from sensor_msgs.msg import Image
from std_msgs.msg import Header

from sextant.geometry.poses import pose_of_fields, quaternion_of


def pose_to_message(T: np.ndarray) -> Pose:
    """geometry_msgs/Pose of a 4x4 pose."""
    return Pose(Point(*T[:3, 3]), Quaternion(*quaternion_of(T[:3, :3])))


def transform_to_message(T: np.ndarray) -> Transform:
    """geometry_msgs/Transform of a 4x4 pose."""
    return Transform(Vector3(*T[:3, 3]), Quaternion(*quaternion_of(T[:3, :3])))


def pose_from_message(pose: Pose) -> np.ndarray:
    """4x4 pose of a geometry_msgs/Pose; raises as sextant.pose_from_quaternion()."""
    return pose_of_fields(pose.position, pose.orientation)


def pose_from_transform(transform: Transform) -> np.ndarray:
    """4x4 pose of a geometry_msgs/Transform; raises as sextant.pose_from_quaternion()."""
    return pose_of_fields(transform.translation, transform.rotation)


def image_to_message(image: np.ndarray, header: Header) -> Image:
    """sensor_msgs/Image of a uint8 array: mono8 of (height, width), rgb8 of (height, width, 3)."""
    height, width = image.shape[:2]
    encoding, channels = ("mono8", 1) if image.ndim == 2 else ("rgb8", 3)
    return Image(header, height, width, encoding, 0, channels * width, image.tobytes())
