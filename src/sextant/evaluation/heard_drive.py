# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A drive as a running system tells it, message after message: poses, and their truth sooner or later."""

from collections import deque
from typing import Deque, Dict, List, Tuple

import numpy as np

KEPT = 3600 * 10**9  # nanoseconds of poses and truths that are remembered
JUMP = 10**9  # nanoseconds: a stamp that is older than the input's newest by more is of a clock set back

TimedPose = Tuple[int, np.ndarray, np.ndarray]  # stamp (nanoseconds), T (4, 4), covariance (6, 6)


class ClockSetBack(Exception):
    """What was heard is of another time: begin a new HeardDrive."""


class HeardDrive:
    """The last hour. Guarded by its owner."""

    def __init__(self) -> None:
        self.frame = ""  # that all of it is in: the first pose's
        self.poses: Deque[TimedPose] = deque()
        self.truth: Dict[int, np.ndarray] = {}  # T (4, 4) by stamp
        self.awaited: Deque[int] = deque()  # stamps of poses, for an owner who asks for their truth
        self._newest: Dict[str, int] = {}  # stamp by input: one may lag behind the other

    def add_pose(self, frame: str, stamp: int, T: np.ndarray, covariance: np.ndarray) -> None:
        """:raises ClockSetBack, ValueError: it has no stamp, or another frame than the first one."""
        self._check("pose", self.frame if self.poses else frame, frame, stamp)
        self.frame = frame
        self.poses.append((stamp, T, covariance))
        while self.poses[0][0] < stamp - KEPT:
            self.poses.popleft()

    def add_truth(self, frame: str, stamp: int, T: np.ndarray) -> None:
        """Before the first pose it is forgotten: there is nothing it is the truth of.

        :raises ClockSetBack, ValueError: it has no stamp, or another frame than the poses
        """
        self._check("truth", self.frame if self.poses else frame, frame, stamp)
        if self.poses:
            self.add_truth_of_pose(stamp, T)

    def add_truth_of_pose(self, stamp: int, T: np.ndarray) -> None:
        """In the frame of the poses, at the stamp of one."""
        self.truth[stamp] = T
        while next(iter(self.truth)) < stamp - KEPT:
            del self.truth[next(iter(self.truth))]

    def since(self, stamp: int) -> List[TimedPose]:
        """Poses that were stamped then or later."""
        return [pose for pose in self.poses if pose[0] >= stamp]

    def _check(self, what: str, expected: str, frame: str, stamp: int) -> None:
        if stamp == 0:
            raise ValueError("its stamp is zero")
        if stamp < self._newest.get(what, 0) - JUMP:
            raise ClockSetBack(what)
        if frame != expected:
            raise ValueError(f"its frame is '{frame}', that of the poses '{expected}'")
        self._newest[what] = max(stamp, self._newest.get(what, 0))
