# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Poses of messages."""

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

NORM_TOLERANCE = 0.01  # of a quaternion, as src/ros/conversions.cpp


def pose_from_fields(position: Any, orientation: Any) -> np.ndarray:
    """(4, 4) pose, metres, of a Point or Vector3 and a Quaternion.

    :raises ValueError: a number is not finite, or the quaternion is not of unit length
    """
    p = np.array([position.x, position.y, position.z])
    q = np.array([orientation.x, orientation.y, orientation.z, orientation.w])
    if not (np.all(np.isfinite(p)) and abs(np.linalg.norm(q) - 1.0) < NORM_TOLERANCE):
        raise ValueError("no pose: not finite, or its quaternion not of unit length")
    T = np.eye(4)
    T[:3, :3] = Rotation.from_quat(q).as_matrix()
    T[:3, 3] = p
    return T
