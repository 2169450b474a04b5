# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tracking of the ball in the odometry frame; observations wait for the odometry at their stamp."""

from typing import Iterator, NamedTuple, Optional

from nav_msgs.msg import Odometry

from sextant.geometry.plane_poses import planar
from sextant.messages.pose_messages import pose_from_message
from sextant.nodes.objects.pose_buffer import PoseBuffer
from sextant.objects.ball_observations import BallObservations
from sextant.objects.ball_tracker import BallEstimate, BallTracker

WAITING = 30  # images


class TrackedBall(NamedTuple):
    """The ball after an image."""

    stamp: int  # nanoseconds
    frame: str  # of the odometry
    ball: Optional[BallEstimate]  # None: no confirmed ball


class BallFollower:
    """Pairs observations with odometry and updates the tracker. Not thread-safe."""

    def __init__(self, tracker: BallTracker):
        self._tracker, self._poses, self._frame = tracker, PoseBuffer(WAITING), ""

    @property
    def without_odometry(self) -> int:
        """Number of images dropped because there was no odometry at their stamp."""
        return self._poses.dropped

    def add_odometry(self, odometry: Odometry) -> Iterator[TrackedBall]:
        """Add a pose of the robot; yields the ball after each image that waited for it.

        :raises ValueError: the pose is not valid
        """
        stamp, T = odometry.header.stamp.to_nsec(), pose_from_message(odometry.pose.pose)
        if self._poses.jumps_back(stamp) or odometry.header.frame_id != self._frame:
            self._poses.clear()
            self._tracker.clear()
            self._frame = odometry.header.frame_id
        self._poses.add(stamp, T)
        return self._follow()

    def add_observations(self, stamp: int, observations: BallObservations) -> Iterator[TrackedBall]:
        """Add the observations of an image. :param stamp: nanoseconds"""
        self._poses.add_item(stamp, observations)
        return self._follow()

    def _follow(self) -> Iterator[TrackedBall]:
        for stamp, observations, T_odom_base in self._poses.ready():
            observations.update(self._tracker, 1e-9 * stamp, planar(T_odom_base))
            yield TrackedBall(stamp, self._frame, self._tracker.at(1e-9 * stamp))
