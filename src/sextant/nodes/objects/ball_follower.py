# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Follows the ball in odometry's frame: what a camera saw of it waits until odometry tells where that was."""

from typing import Iterator, NamedTuple, Optional

from nav_msgs.msg import Odometry

from sextant.geometry.plane_poses import planar
from sextant.nodes.base.conversions import pose_from_message
from sextant.nodes.objects.pose_trail import PoseTrail
from sextant.objects.ball_look import BallLook
from sextant.objects.ball_tracker import BallEstimate, BallTracker

WAITING = 30  # looks


class Followed(NamedTuple):
    """After a look."""

    stamp: int  # nanoseconds
    frame: str  # odometry's
    ball: Optional[BallEstimate]  # None: nobody knows where it is


class BallFollower:
    """Not thread-safe."""

    def __init__(self, tracker: BallTracker):
        self._tracker, self._trail, self._frame = tracker, PoseTrail(WAITING), ""

    @property
    def without_odometry(self) -> int:
        """Looks that odometry told no pose for."""
        return self._trail.forgotten

    def move(self, odometry: Odometry) -> Iterator[Followed]:
        """One more pose of the robot; looks that waited for it.

        :raises ValueError: it is no pose
        """
        stamp, T = odometry.header.stamp.to_nsec(), pose_from_message(odometry.pose.pose)
        if self._trail.is_set_back(stamp) or odometry.header.frame_id != self._frame:
            self._trail.clear()
            self._tracker.clear()
            self._frame = odometry.header.frame_id
        self._trail.add(stamp, T)
        return self._follow()

    def see(self, stamp: int, look: BallLook) -> Iterator[Followed]:
        """One more look, at a time in nanoseconds."""
        self._trail.wait(stamp, look)
        return self._follow()

    def _follow(self) -> Iterator[Followed]:
        for stamp, look, T_odom_base in self._trail.ready():
            look.tell(self._tracker, 1e-9 * stamp, planar(T_odom_base))
            yield Followed(stamp, self._frame, self._tracker.at(1e-9 * stamp))
