# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What was seen at a time waits until the robot's pose of that time is known."""

from collections import deque
from typing import Any, Deque, Iterator, Optional, Tuple

import numpy as np

from sextant.geometry.poses import LONGEST_GAP, interpolated_poses

KEPT = 500  # poses
SET_BACK = 10**9  # nanoseconds: stamps that fall back farther are of a clock that was set back


class PoseTrail:
    """The newest poses of a robot, and what waits for one. Not thread-safe."""

    def __init__(self, waiting: int):
        """:param waiting: of so many things the oldest is forgotten when one more has to wait"""
        self._poses: Deque[Tuple[int, np.ndarray]] = deque(maxlen=KEPT)  # stamp, T_frame_base
        self._waiting: Deque[Tuple[int, Any]] = deque(maxlen=waiting)
        self.forgotten = 0  # things that got no pose

    @property
    def newest(self) -> Optional[Tuple[int, np.ndarray]]:
        """Stamp in nanoseconds and T_frame_base (4, 4)."""
        return self._poses[-1] if self._poses else None

    def is_set_back(self, stamp: int) -> bool:
        """Whether a pose of this time tells that the clock was set back."""
        return bool(self._poses) and stamp < self._poses[-1][0] - SET_BACK

    def clear(self) -> None:
        """Forgets poses and what waits for them."""
        self._poses.clear()
        self._waiting.clear()

    def add(self, stamp: int, T_frame_base: np.ndarray) -> bool:
        """Whether it is newer than the others; else it is not kept."""
        is_newer = not self._poses or stamp > self._poses[-1][0]
        if is_newer:
            self._poses.append((stamp, T_frame_base))
        return is_newer

    def wait(self, stamp: int, thing: Any) -> None:
        """:param stamp: nanoseconds, of the time at which it was seen"""
        self.forgotten += len(self._waiting) == self._waiting.maxlen
        self._waiting.append((stamp, thing))

    def ready(self) -> Iterator[Tuple[int, Any, np.ndarray]]:
        """What waits no longer: stamp, thing and T_frame_base (4, 4) then, oldest first."""
        while self._waiting and self._poses and self._waiting[0][0] <= self._poses[-1][0]:
            stamp, thing = self._waiting.popleft()
            stamps, poses = (np.array(values) for values in zip(*self._poses))
            (T,) = interpolated_poses(stamps, poses, np.array([stamp]), LONGEST_GAP)
            if T is None:
                self.forgotten += 1
            else:
                yield stamp, thing, T
