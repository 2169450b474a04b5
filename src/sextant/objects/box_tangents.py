# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the sides of a box about an object tell of where it is: planes through the camera that touch it.

The middle of an upright pillar or a ball is its radius away from each of them. A pillar leans in the picture
of a camera that looks down, so that its box is wider than it is; then one corner of each side lies on its
outline, the inner one.
"""

from typing import NamedTuple

import numpy as np

LEFT, TOP, RIGHT, BOTTOM = range(4)  # sides, as a box has them


class BoxTangents(NamedTuple):
    """Of m sides, in the robot frame without its height (k = 2) or with it (3)."""

    normals: np.ndarray  # (m, k) unit, into the box
    sides: np.ndarray  # (m,) which of the box's
    middle: np.ndarray  # (k,) unit, from the camera between left and right


def pillar_tangents(corners: np.ndarray) -> BoxTangents:
    """On the floor.

    :param corners: (4, 3) rays in the robot's axes: left and right top, left and right bottom
    """
    flat = corners[:, :2] / np.linalg.norm(corners[:, :2], axis=1, keepdims=True)
    middle = flat.sum(axis=0)
    aside = middle[0] * flat[:, 1] - middle[1] * flat[:, 0]  # to the left
    left, right = flat[0:4:2][np.argmin(aside[0:4:2])], flat[1:4:2][np.argmax(aside[1:4:2])]
    normals = np.array([[left[1], -left[0]], [-right[1], right[0]]])
    return BoxTangents(normals, np.array([LEFT, RIGHT]), (left + right) / np.linalg.norm(left + right))


def ball_tangents(corners: np.ndarray) -> BoxTangents:
    """In space. :param corners: as pillar_tangents()"""
    left_top, right_top, left_bottom, right_bottom = corners
    around = [
        (left_bottom, left_top),
        (left_top, right_top),
        (right_top, right_bottom),
        (right_bottom, left_bottom),
    ]
    normals = np.array([np.cross(second, first) for first, second in around])
    middle = corners.sum(axis=0)
    normals *= np.sign(normals @ middle)[:, np.newaxis] / np.linalg.norm(normals, axis=1, keepdims=True)
    return BoxTangents(normals, np.array([LEFT, TOP, RIGHT, BOTTOM]), middle / np.linalg.norm(middle))


TANGENTS = {"pillar": pillar_tangents, "ball": ball_tangents}  # by shape
