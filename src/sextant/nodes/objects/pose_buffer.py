# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A buffer of poses; data wait in it until the pose at their stamp is known."""

from collections import deque
from typing import Any, Deque, Iterator, Optional, Tuple

import numpy as np

from sextant.base.stamp_jump import jumps_back
from sextant.geometry.poses import MAX_GAP, interpolated_poses

MAX_POSES = 500  # poses


class PoseBuffer:
    """The newest poses of a robot, and data waiting for a pose. Not thread-safe."""

    def __init__(self, waiting: int):
        """:param waiting: maximum number of waiting items; beyond, the oldest is dropped"""
        self._poses: Deque[Tuple[int, np.ndarray]] = deque(maxlen=MAX_POSES)  # stamp, T_frame_base
        self._waiting: Deque[Tuple[int, Any]] = deque(maxlen=waiting)
        self.dropped = 0  # number of items without a pose

    @property
    def newest(self) -> Optional[Tuple[int, np.ndarray]]:
        """Newest stamp in nanoseconds and T_frame_base (4, 4); None: empty."""
        return self._poses[-1] if self._poses else None

    def jumps_back(self, stamp: int) -> bool:
        """Whether a pose with this stamp (nanoseconds) shows that the clock was set back."""
        return bool(self._poses) and jumps_back(stamp, self._poses[-1][0])

    def clear(self) -> None:
        """Remove all poses and waiting items."""
        self._poses.clear()
        self._waiting.clear()

    def add(self, stamp: int, T_frame_base: np.ndarray) -> bool:
        """Add a pose if it is the newest; returns whether it is. :param stamp: nanoseconds"""
        is_newer = not self._poses or stamp > self._poses[-1][0]
        if is_newer:
            self._poses.append((stamp, T_frame_base))
        return is_newer

    def add_item(self, stamp: int, item: Any) -> None:
        """Add an item that waits for a pose. :param stamp: nanoseconds"""
        self.dropped += len(self._waiting) == self._waiting.maxlen
        self._waiting.append((stamp, item))

    def ready(self) -> Iterator[Tuple[int, Any, np.ndarray]]:
        """Remove the items with a pose; yields stamp, item and T_frame_base (4, 4), oldest first."""
        while self._waiting and self._poses and self._waiting[0][0] <= self._poses[-1][0]:
            stamp, item = self._waiting.popleft()
            stamps, poses = (np.array(values) for values in zip(*self._poses))
            (T,) = interpolated_poses(stamps, poses, np.array([stamp]), MAX_GAP)
            if T is None:
                self.dropped += 1
            else:
                yield stamp, item, T
