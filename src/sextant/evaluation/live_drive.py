# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Poses and ground truth received from a running system."""

from collections import deque
from typing import Deque, Dict, List, Tuple

import numpy as np

from sextant.base.stamp_jump import jumps_back

KEPT = 3600 * 10**9  # nanoseconds for which poses and ground truth are kept

TimedPose = Tuple[int, np.ndarray, np.ndarray]  # stamp (nanoseconds), T (4, 4), covariance (6, 6)


class JumpBack(Exception):
    """Stamps jump back, as the clock was set back: earlier poses are obsolete, start a new LiveDrive."""


class LiveDrive:
    """Poses and ground truth of the last hour. Not thread-safe."""

    def __init__(self) -> None:
        self.frame = ""  # frame of all poses: that of the first one
        self.poses: Deque[TimedPose] = deque()
        self.truth: Dict[int, np.ndarray] = {}  # T (4, 4) by stamp
        self.awaited: Deque[int] = deque()  # stamps of poses whose ground truth is pending
        self._newest: Dict[str, int] = {}  # newest stamp by input: one may lag behind the other

    def add_pose(self, frame: str, stamp: int, T: np.ndarray, covariance: np.ndarray) -> None:
        """Adds a pose T (4, 4) with its covariance (6, 6).

        :param stamp: nanoseconds
        :raises JumpBack: the stamp is much older than the previous one
        :raises ValueError: the stamp is zero, or the frame differs from the first one
        """
        self._check("pose", self.frame if self.poses else frame, frame, stamp)
        self.frame = frame
        self.poses.append((stamp, T, covariance))
        while self.poses[0][0] < stamp - KEPT:
            self.poses.popleft()

    def add_truth(self, frame: str, stamp: int, T: np.ndarray) -> None:
        """Adds the true pose T (4, 4) at a stamp in nanoseconds; ignored before the first pose.

        :raises JumpBack: the stamp is much older than the previous one
        :raises ValueError: the stamp is zero, or the frame differs from that of the poses
        """
        self._check("truth", self.frame if self.poses else frame, frame, stamp)
        if self.poses:
            self.add_truth_of_pose(stamp, T)

    def add_truth_of_pose(self, stamp: int, T: np.ndarray) -> None:
        """Adds the true pose at the stamp of a pose, in the frame of the poses."""
        self.truth[stamp] = T
        while next(iter(self.truth)) < stamp - KEPT:
            del self.truth[next(iter(self.truth))]

    def since(self, stamp: int) -> List[TimedPose]:
        """Returns the poses at a stamp or later."""
        return [pose for pose in self.poses if pose[0] >= stamp]

    def _check(self, what: str, expected: str, frame: str, stamp: int) -> None:
        if stamp == 0:
            raise ValueError("its stamp is zero")
        if jumps_back(stamp, self._newest.get(what, 0)):
            raise JumpBack(what)
        if frame != expected:
            raise ValueError(f"its frame is '{frame}', the frame of the poses is '{expected}'")
        self._newest[what] = max(stamp, self._newest.get(what, 0))
