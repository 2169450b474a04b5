# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Planar poses: (3,) arrays of x, y (metres) and heading (radians)."""

import math

import numpy as np


def rotation(angle: float) -> np.ndarray:
    """Returns the (2, 2) rotation matrix of an angle in radians, counter-clockwise."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def wrapped(angle: float) -> float:
    """Wraps an angle to [-pi, pi) radians."""
    return np.remainder(angle + np.pi, 2 * np.pi) - np.pi


def planar(T: np.ndarray) -> np.ndarray:
    """Projects a (4, 4) pose to the plane: (3,) x, y, heading."""
    return np.array([T[0, 3], T[1, 3], math.atan2(T[1, 0], T[0, 0])])


def composed(pose: np.ndarray, step: np.ndarray) -> np.ndarray:
    """Composes a pose (3,) with a step (3,) in the frame of the pose; returns (3,) x, y, heading."""
    position = pose[:2] + rotation(pose[2]) @ step[:2]
    return np.array([*position, wrapped(pose[2] + step[2])])


def relative(pose: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Transforms another pose (3,) to the frame of a pose (3,); the inverse of composed()."""
    return np.array([*in_frame(pose, other[:2]), wrapped(other[2] - pose[2])])


def in_frame(pose: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Transforms points (n, 2) of the map to the frame of a pose (3,); returns (n, 2)."""
    return (points - pose[:2]) @ rotation(pose[2])
