# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Follows the ball in odometry's frame: what a camera saw of it waits until odometry tells where that was."""

from collections import deque
from typing import Deque, Iterator, List, NamedTuple, Optional

import numpy as np
from nav_msgs.msg import Odometry

from sextant.nodes.conversions import pose_from_message
from sextant.objects.ball_tracker import BallEstimate, BallTracker
from sextant.objects.ball_view import BallView
from sextant.objects.object_locator import LocatedObject
from sextant.poses import LONGEST_GAP, interpolated_poses

KEPT = 500  # poses of odometry
WAITING = 30  # looks
SET_BACK = 10**9  # nanoseconds: stamps that fall back farther are of a clock that was set back


class BallLook(NamedTuple):
    """What one picture shows of the ball, in the robot frame."""

    stamp: int  # nanoseconds
    balls: List[LocatedObject]
    pillars: List[np.ndarray]  # (3,) x, y and radius
    T_base_camera: np.ndarray
    view: BallView


class Followed(NamedTuple):
    """After a look."""

    look: BallLook
    frame: str  # odometry's
    ball: Optional[BallEstimate]  # None: nobody knows where it is


class BallFollower:
    """Not thread-safe."""

    def __init__(self, tracker: BallTracker):
        self._tracker = tracker
        self._poses: Deque = deque(maxlen=KEPT)  # stamp, T_odom_base
        self._waiting: Deque[BallLook] = deque(maxlen=WAITING)
        self._frame = ""
        self.without_odometry = 0  # looks

    def move(self, odometry: Odometry) -> Iterator[Followed]:
        """One more pose of the robot; looks that waited for it.

        :raises ValueError: it is no pose
        """
        stamp, T = odometry.header.stamp.to_nsec(), pose_from_message(odometry.pose.pose)
        newest = self._poses[-1][0] if self._poses else stamp - 1
        if stamp < newest - SET_BACK or odometry.header.frame_id != self._frame:
            self._poses.clear()
            self._waiting.clear()
            self._tracker.clear()
            self._frame = odometry.header.frame_id
        elif stamp <= newest:
            return iter(())
        self._poses.append((stamp, T))
        return self._follow()

    def see(self, look: BallLook) -> Iterator[Followed]:
        """One more look."""
        self.without_odometry += len(self._waiting) == WAITING
        self._waiting.append(look)
        return self._follow()

    def _follow(self) -> Iterator[Followed]:
        while self._waiting and self._poses and self._waiting[0].stamp <= self._poses[-1][0]:
            look = self._waiting.popleft()
            stamps, poses = (np.array(values) for values in zip(*self._poses))
            (T,) = interpolated_poses(stamps, poses, np.array([look.stamp]), LONGEST_GAP)
            if T is None:
                self.without_odometry += 1
            else:
                yield self._followed(look, T)

    def _followed(self, look: BallLook, T: np.ndarray) -> Followed:
        R, t, stamp = T[:2, :2], T[:2, 3], 1e-9 * look.stamp
        sightings = [(R @ ball.position + t, R @ ball.covariance @ R.T) for ball in look.balls]
        self._tracker.look(
            stamp, sightings, lambda ball: look.view.has(R.T @ (ball - t), look.T_base_camera, look.pillars)
        )
        return Followed(look, self._frame, self._tracker.at(stamp))
