# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which views of a drive become photos of a map.

Poses are T_map_camera (4, 4) of optical frames, whose z looks ahead; metres.
"""

import math
from typing import List, Optional, Sequence

import cv2
import numpy as np

import sextant

SLACK = 0.1  # of the distance and turn, that a sharper picture may lie behind the first that is due
MOST_CANDIDATES = 5  # pictures that are compared
LEVEL = 0.5  # horizontal part of a direction, below which a camera looks up or down: no yaw says where


def due_views(poses: Sequence[np.ndarray], distance: float, turn: float) -> List[List[int]]:
    """The views that are due after the camera has moved or turned; of each, those almost alike after it.

    :param distance: metres since the last one
    :param turn: radians since the last one
    :returns: for every photo the indices, growing, of the poses of which one is to be taken
    """
    picks: List[List[int]] = []
    for i, pose in enumerate(poses):
        if not picks or _share(poses[picks[-1][0]], pose, distance, turn) >= 1:
            picks.append([i])
        elif (
            picks[-1][-1] == i - 1
            and len(picks[-1]) < MOST_CANDIDATES
            and _share(poses[picks[-1][0]], pose, distance, turn) <= SLACK
        ):
            picks[-1].append(i)
    return picks


def _share(a: np.ndarray, b: np.ndarray, distance: float, turn: float) -> float:
    """How much of the distance, or of the turn, lies between two poses; the larger of both."""
    turned = np.linalg.norm(sextant.log_so3(a[:3, :3].T @ b[:3, :3]))
    return max(float(np.linalg.norm(b[:3, 3] - a[:3, 3])) / distance, float(turned) / turn)


def sharpness(picture: np.ndarray) -> float:
    """Of a picture, uint8; to be compared with that of others of the same scene: the Laplacian's variance."""
    grey = picture if picture.ndim == 2 else cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY)
    return float(cv2.Laplacian(grey, cv2.CV_32F).var())


def view_yaw(T_map_camera: np.ndarray) -> Optional[float]:
    """Radians counterclockwise from the map's x to where the camera looks; None: up or down."""
    x, y = T_map_camera[:2, 2]
    return math.atan2(y, x) if math.hypot(x, y) >= LEVEL else None
