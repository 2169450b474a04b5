# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Poses (4x4 arrays, metres) of positions and quaternions in the order x y z w, and back."""

from typing import Any, Sequence

import numpy as np
from scipy.spatial.transform import Rotation

NORM_TOLERANCE = 0.01  # of a unit quaternion, as src/ros/conversions.cpp
SMALLEST_NORM = 1e-6  # below it the direction is what rounding left over


def pose_of(
    position: Sequence[float], xyzw: Sequence[float], tolerance: float = NORM_TOLERANCE
) -> np.ndarray:
    """(4, 4) of a position (3,) and a quaternion (4,); q and -q are the same.

    :param tolerance: by how much the quaternion's length may differ from 1
    :raises ValueError: a number is not finite, or the quaternion has another length
    """
    if not (np.all(np.isfinite(position)) and np.all(np.isfinite(xyzw))):
        raise ValueError("position and quaternion must be finite")
    norm = np.linalg.norm(xyzw)
    if norm < SMALLEST_NORM or abs(norm - 1.0) > tolerance:
        raise ValueError(f"the quaternion is no rotation: its length is {norm:.6g}, not 1")
    T = np.eye(4)
    T[:3, :3] = Rotation.from_quat(xyzw).as_matrix()
    T[:3, 3] = position
    return T


def pose_of_fields(position: Any, orientation: Any) -> np.ndarray:
    """(4, 4) of a message's Point or Vector3 and its Quaternion; raises as pose_of()."""
    q = orientation
    return pose_of([position.x, position.y, position.z], [q.x, q.y, q.z, q.w])


def quaternion_of(R: np.ndarray) -> np.ndarray:
    """(4,) x y z w with w >= 0, of a rotation (3, 3)."""
    q = Rotation.from_matrix(R).as_quat()
    return q if q[3] >= 0.0 else -q
