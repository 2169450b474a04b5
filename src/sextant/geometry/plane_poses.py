# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Poses in the plane: (3,) x, y (metres) and heading (radians)."""

import math

import numpy as np


def rotation(angle: float) -> np.ndarray:
    """(2, 2) counter-clockwise, radians."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def wrapped(angle: float) -> float:
    """In [-pi, pi) radians."""
    return np.remainder(angle + np.pi, 2 * np.pi) - np.pi


def planar(T: np.ndarray) -> np.ndarray:
    """(3,) x, y, heading of a pose (4, 4) seen from above."""
    return np.array([T[0, 3], T[1, 3], math.atan2(T[1, 0], T[0, 0])])


def composed(pose: np.ndarray, step: np.ndarray) -> np.ndarray:
    """(3,) x, y, heading after a step (3,) in the frame of the pose."""
    position = pose[:2] + rotation(pose[2]) @ step[:2]
    return np.array([*position, wrapped(pose[2] + step[2])])


def relative(pose: np.ndarray, other: np.ndarray) -> np.ndarray:
    """(3,) of another pose (3,) in the frame of a pose (3,): the step that composed() takes from it."""
    return np.array([*in_frame(pose, other[:2]), wrapped(other[2] - pose[2])])


def in_frame(pose: np.ndarray, points: np.ndarray) -> np.ndarray:
    """(n, 2) of points (n, 2) of the map, in the frame of a pose (3,)."""
    return (points - pose[:2]) @ rotation(pose[2])
