# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Selects the keyframes of a drive that become photos of a map.

Poses are T_map_camera (4, 4) of the optical frame (z forward), metres.
"""

import math
from typing import List, Optional, Sequence

import numpy as np

import sextant

SLACK = 0.1  # fraction of distance and turn; the sharpest image this close to the first one that is due wins
MAX_CANDIDATES = 5  # maximum number of images compared per keyframe
MIN_HORIZONTAL = 0.5  # minimum horizontal part of the unit viewing direction for a yaw


def keyframe_candidates(poses: Sequence[np.ndarray], distance: float, turn: float) -> List[List[int]]:
    """Candidates of each keyframe: the first pose due by distance or turn, and the next ones close to it.

    :param poses: T_map_camera in the order of the drive
    :param distance: from the last keyframe to the next one, metres
    :param turn: angle from the last keyframe to the next one, radians
    :returns: for each keyframe the indices of its candidates, ascending
    """
    candidates: List[List[int]] = []
    for i, pose in enumerate(poses):
        if not candidates or _motion(poses[candidates[-1][0]], pose, distance, turn) >= 1:
            candidates.append([i])
        elif (
            candidates[-1][-1] == i - 1
            and len(candidates[-1]) < MAX_CANDIDATES
            and _motion(poses[candidates[-1][0]], pose, distance, turn) <= SLACK
        ):
            candidates[-1].append(i)
    return candidates


def _motion(a: np.ndarray, b: np.ndarray, distance: float, turn: float) -> float:
    """Motion between two poses: the larger of its fractions of distance and of turn."""
    angle = np.linalg.norm(sextant.log_so3(a[:3, :3].T @ b[:3, :3]))
    return max(float(np.linalg.norm(b[:3, 3] - a[:3, 3])) / distance, float(angle) / turn)


def view_yaw(T_map_camera: np.ndarray) -> Optional[float]:
    """Yaw of the viewing direction, radians counterclockwise from the map's x; None if nearly vertical."""
    x, y = T_map_camera[:2, 2]
    return math.atan2(y, x) if math.hypot(x, y) >= MIN_HORIZONTAL else None
