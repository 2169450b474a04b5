# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Unit quaternions, in the order x y z w."""

from typing import Sequence

import numpy as np

import sextant

SMALLEST_NORM = 1e-6  # below it the direction is what rounding left over


def rotation_from_quaternion(xyzw: Sequence[float]) -> np.ndarray:
    """(3, 3) rotation; the quaternion need not be of unit length, q and -q are the same.

    :raises ValueError: a quaternion of length zero
    """
    norm = np.linalg.norm(xyzw)
    if norm < SMALLEST_NORM:
        raise ValueError("the quaternion is zero, which is no rotation; none is qw: 1, qx: 0, qy: 0, qz: 0")
    x, y, z, w = np.asarray(xyzw) / norm
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def quaternion_from_rotation(R: np.ndarray) -> np.ndarray:
    """(4,) x y z w with w >= 0, of a rotation (3, 3): cos and sin of half its angle."""
    rotvec = sextant.log_so3(R)
    angle = np.linalg.norm(rotvec)
    axis = rotvec / angle if angle > 0 else np.zeros(3)
    return np.append(np.sin(angle / 2) * axis, np.cos(angle / 2))
