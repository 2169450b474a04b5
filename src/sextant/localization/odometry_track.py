# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Distance that a robot drove between two images, by odometry."""

from bisect import bisect_left
from collections import deque
from typing import Deque, Optional, Tuple

import numpy as np

MAX_POSITIONS = 2000
MAX_AGE = 500_000_000  # of the last position when an image arrives after it, nanoseconds


class OdometryTrack:
    """Buffer of stamped positions. Not thread-safe."""

    def __init__(self) -> None:
        self._track: Deque[Tuple[int, float, float]] = deque(maxlen=MAX_POSITIONS)

    def add(self, stamp: int, x: float, y: float) -> None:
        """Appends a position.

        :param stamp: nanoseconds; if it is before the last one, the buffer is cleared
        :param x: y: metres, in an odometry frame without jumps (REP-105)
        """
        if self._track and stamp < self._track[-1][0]:
            self._track.clear()
        self._track.append((stamp, x, y))

    def distance(self, begin: int, end: int) -> Optional[float]:
        """Metres between the positions at two stamps; None if odometry does not cover them."""
        first, last = self._at(begin), self._at(end)
        if first is None or last is None:
            return None
        distance = float(np.hypot(*(last - first)))
        return distance if np.isfinite(distance) else None  # a driver may publish nan

    def _at(self, stamp: int) -> Optional[np.ndarray]:
        """Interpolated position (2,); up to MAX_AGE after the last position, that one."""
        after = bisect_left(self._track, (stamp + 1,))  # index of the first later position
        if not after:
            return None
        begin, *before = self._track[after - 1]
        if after == len(self._track):
            return np.array(before) if stamp - begin <= MAX_AGE else None
        end, *later = self._track[after]
        return np.array([np.interp(stamp - begin, (0, end - begin), pair) for pair in zip(before, later)])
