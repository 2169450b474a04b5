# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Planes through the camera and the sides of a bounding box, tangent to the object in it.

The axis of an upright pillar, or the centre of a ball, is one radius away from each plane. In the image of a
camera pitched down, a pillar is inclined and its box is wider than the pillar; then only the inner corner of
each side lies on the outline.
"""

from typing import NamedTuple

import numpy as np

LEFT, TOP, RIGHT, BOTTOM = range(4)  # sides of a box, in the order of its columns


class BoxTangents(NamedTuple):
    """Tangent planes of m sides, along the robot's axes: in x, y (k = 2) or x, y, z (k = 3)."""

    normals: np.ndarray  # (m, k) unit, pointing into the box
    sides: np.ndarray  # (m,) LEFT, TOP, RIGHT or BOTTOM
    middle: np.ndarray  # (k,) unit, from the camera through the middle of the box


def pillar_tangents(corners: np.ndarray) -> BoxTangents:
    """Left and right tangents on the floor (k = 2).

    :param corners: (4, 3) rays in the robot's axes: left and right top, left and right bottom
    """
    flat = corners[:, :2] / np.linalg.norm(corners[:, :2], axis=1, keepdims=True)
    middle = flat.sum(axis=0)
    aside = middle[0] * flat[:, 1] - middle[1] * flat[:, 0]  # to the left
    left, right = flat[0:4:2][np.argmin(aside[0:4:2])], flat[1:4:2][np.argmax(aside[1:4:2])]
    normals = np.array([[left[1], -left[0]], [-right[1], right[0]]])
    return BoxTangents(normals, np.array([LEFT, RIGHT]), (left + right) / np.linalg.norm(left + right))


def ball_tangents(corners: np.ndarray) -> BoxTangents:
    """Tangents of all four sides (k = 3). :param corners: as pillar_tangents()"""
    around = corners[[2, 0, 1, 3]]  # clockwise, so that consecutive corners span a side
    normals = np.cross(np.roll(around, -1, axis=0), around)
    middle = corners.sum(axis=0)
    normals *= np.sign(normals @ middle)[:, np.newaxis] / np.linalg.norm(normals, axis=1, keepdims=True)
    return BoxTangents(normals, np.array([LEFT, TOP, RIGHT, BOTTOM]), middle / np.linalg.norm(middle))


TANGENTS = {"pillar": pillar_tangents, "ball": ball_tangents}  # by shape
