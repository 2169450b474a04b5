# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Poses as 4x4 arrays in metres: conversion from positions and quaternions (x y z w), interpolation."""

from typing import Any, List, Optional

import numpy as np
from scipy.spatial.transform import Rotation

import sextant

# Takes the optical frame (z forward, x right, y down) to the axes of a robot or a mount (x forward,
# y left, z up); REP-103.
R_BODY_OPTICAL = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
MAX_GAP = 0.5  # seconds between two poses, up to which a robot's motion is interpolated


def pose_of_fields(position: Any, orientation: Any) -> np.ndarray:
    """Returns the (4, 4) pose of a message's Point or Vector3 and Quaternion.

    :raises ValueError: as sextant.pose_from_quaternion()
    """
    q = orientation
    return sextant.pose_from_quaternion([position.x, position.y, position.z], [q.x, q.y, q.z, q.w])


def quaternion_of(R: np.ndarray) -> np.ndarray:
    """Returns the quaternion (4,) x y z w, with w >= 0, of a rotation matrix (3, 3)."""
    q = Rotation.from_matrix(R).as_quat()
    return q if q[3] >= 0.0 else -q


def interpolated_poses(
    stamps: np.ndarray, poses: np.ndarray, at: np.ndarray, max_gap: float
) -> List[Optional[np.ndarray]]:
    """Interpolates between recorded poses: positions linearly, rotations at constant speed (slerp).

    :param stamps: (N,) int64 nanoseconds, increasing
    :param poses: (N, 4, 4)
    :param at: (M,) int64 nanoseconds
    :param max_gap: longest interval between two stamps that is interpolated, seconds
    :returns: M poses (4, 4); None outside of the stamps and in longer intervals; at a stamp exactly its pose
    """
    if len(stamps) == 0:
        return [None] * len(at)
    after = np.searchsorted(stamps, at)  # first stamp that is not earlier
    inside = np.minimum(after, len(stamps) - 1)
    exact = stamps[inside] == at
    before = np.where(exact, inside, np.maximum(inside - 1, 0))
    span = stamps[inside] - stamps[before]
    known = exact | ((after > 0) & (after < len(stamps)) & (span <= round(max_gap * 1e9)))
    share = (at - stamps[before]) / np.maximum(span, 1)
    between = _between(poses[before], poses[inside], np.where(known, share, 0.0))
    between[exact] = poses[inside[exact]]
    return [T if good else None for T, good in zip(between, known)]


def _between(first: np.ndarray, second: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Returns (M, 4, 4) poses at the fractions share (M,) between first and second (M, 4, 4)."""
    if len(share) == 0:
        return np.zeros((0, 4, 4))
    R = Rotation.from_matrix(first[:, :3, :3])
    turn = (R.inv() * Rotation.from_matrix(second[:, :3, :3])).as_rotvec()
    T = np.tile(np.eye(4), (len(share), 1, 1))
    T[:, :3, :3] = (R * Rotation.from_rotvec(share[:, None] * turn)).as_matrix()
    T[:, :3, 3] = first[:, :3, 3] + share[:, None] * (second[:, :3, 3] - first[:, :3, 3])
    return T
