# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""How far a robot went between two pictures, by its odometry."""

from bisect import bisect_left
from collections import deque
from typing import Deque, Optional, Tuple

import numpy as np

KEPT = 2000  # positions
LATE = 500_000_000  # nanoseconds that odometry may be older than a picture


class OdometryTrack:
    """Positions by stamp. Not thread-safe."""

    def __init__(self) -> None:
        self._track: Deque[Tuple[int, float, float]] = deque(maxlen=KEPT)

    def add(self, stamp: int, x: float, y: float) -> None:
        """:param stamp: nanoseconds; one before the last begins anew

        :param x: y: metres, in a frame that does not jump
        """
        if self._track and stamp < self._track[-1][0]:
            self._track.clear()
        self._track.append((stamp, x, y))

    def distance(self, begin: int, end: int) -> Optional[float]:
        """Metres between where the robot was at two stamps; None: odometry does not tell it."""
        first, last = self._at(begin), self._at(end)
        if first is None or last is None:
            return None
        distance = float(np.hypot(*(last - first)))
        return distance if np.isfinite(distance) else None  # a driver may say nan

    def _at(self, stamp: int) -> Optional[np.ndarray]:
        after = bisect_left(self._track, (stamp + 1,))  # the first that is later
        if not after:
            return None
        begin, *position = self._track[after - 1]
        if after == len(self._track):
            return np.array(position) if stamp - begin <= LATE else None
        end, *goal = self._track[after]
        return np.array([np.interp(stamp - begin, (0, end - begin), pair) for pair in zip(position, goal)])
