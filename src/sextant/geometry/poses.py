# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Poses (4x4 arrays, metres): of positions and quaternions in the order x y z w, and between others."""

import math
from typing import Any, List, Optional, Sequence

import numpy as np
from scipy.spatial.transform import Rotation

NORM_TOLERANCE = 0.01  # of a unit quaternion, as src/ros/geometry/pose_conversions.cpp
LONGEST_GAP = 0.5  # seconds between two poses, over which it is still known how a robot moved
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
    T[:3, :3] = _rotation(*map(float, xyzw))
    T[:3, 3] = position
    return T


def _rotation(x: float, y: float, z: float, w: float) -> np.ndarray:
    """As Eigen has it, with the same roundings: what is read of a bag is what a nodelet was told."""
    norm = math.sqrt((x * x + z * z) + (y * y + w * w))
    x, y, z, w = x / norm, y / norm, z / norm, w / norm
    xx, yy, zz = 2 * x * x, 2 * y * y, 2 * z * z
    xy, xz, yz = 2 * y * x, 2 * z * x, 2 * z * y
    wx, wy, wz = 2 * x * w, 2 * y * w, 2 * z * w
    return np.array(
        [
            [1 - (yy + zz), xy - wz, xz + wy],
            [xy + wz, 1 - (xx + zz), yz - wx],
            [xz - wy, yz + wx, 1 - (xx + yy)],
        ]
    )


def pose_of_fields(position: Any, orientation: Any) -> np.ndarray:
    """(4, 4) of a message's Point or Vector3 and its Quaternion; raises as pose_of()."""
    q = orientation
    return pose_of([position.x, position.y, position.z], [q.x, q.y, q.z, q.w])


def quaternion_of(R: np.ndarray) -> np.ndarray:
    """(4,) x y z w with w >= 0, of a rotation (3, 3)."""
    q = Rotation.from_matrix(R).as_quat()
    return q if q[3] >= 0.0 else -q


def interpolated_poses(
    stamps: np.ndarray, poses: np.ndarray, at: np.ndarray, longest_gap: float
) -> List[Optional[np.ndarray]]:
    """Poses between recorded ones: positions along the line, rotations at constant speed (slerp).

    :param stamps: (N,) int64 nanoseconds, growing; poses: (N, 4, 4)
    :param at: (M,) int64 nanoseconds
    :param longest_gap: seconds
    :returns: M poses (4, 4); None outside of the stamps and in gaps; at a stamp, exactly its pose
    """
    if len(stamps) == 0:
        return [None] * len(at)
    after = np.searchsorted(stamps, at)  # the first that is not before
    inside = np.minimum(after, len(stamps) - 1)
    exact = stamps[inside] == at
    before = np.where(exact, inside, np.maximum(inside - 1, 0))
    span = stamps[inside] - stamps[before]
    known = exact | ((after > 0) & (after < len(stamps)) & (span <= round(longest_gap * 1e9)))
    share = (at - stamps[before]) / np.maximum(span, 1)
    between = _between(poses[before], poses[inside], np.where(known, share, 0.0))
    between[exact] = poses[inside[exact]]
    return [T if good else None for T, good in zip(between, known)]


def _between(first: np.ndarray, second: np.ndarray, share: np.ndarray) -> np.ndarray:
    """(M, 4, 4) poses that share (M,) of the way from the first to the second."""
    if len(share) == 0:
        return np.zeros((0, 4, 4))
    R = Rotation.from_matrix(first[:, :3, :3])
    turn = (R.inv() * Rotation.from_matrix(second[:, :3, :3])).as_rotvec()
    T = np.tile(np.eye(4), (len(share), 1, 1))
    T[:, :3, :3] = (R * Rotation.from_rotvec(share[:, None] * turn)).as_matrix()
    T[:, :3, 3] = first[:, :3, 3] + share[:, None] * (second[:, :3, 3] - first[:, :3, 3])
    return T
