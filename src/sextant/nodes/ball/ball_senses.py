# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What messages tell of robot, pillars, ball and floor, put together in the map at the newest pose."""

from typing import List, Optional, Sequence, Tuple

import numpy as np
from nav_msgs.msg import Odometry

from sextant.ball.floor_grid import FloorGrid
from sextant.ball.task_view import SeenBall, SeenPillar, TaskView
from sextant.geometry.plane_poses import planar
from sextant.msg import LandmarkMapEntries, Objects
from sextant.nodes.base.conversions import pose_from_message
from sextant.nodes.base.stamp_pairs import Pair, StampPairs
from sextant.nodes.objects.pose_trail import PoseTrail
from sextant.objects.ball_motion import rolled
from sextant.objects.object_kinds import BALL

WAITING = 60  # depth images


class BallSenses:
    """Not thread-safe."""

    def __init__(self, ball_timeout: float, ball_deceleration: float):
        """:param ball_timeout: seconds after which a ball that nobody tells of is not known any more
        :param ball_deceleration: m/s^2 by which one that rolls slows down
        """
        self._ball_timeout, self._ball_deceleration = ball_timeout, ball_deceleration
        self._pairs = StampPairs(0.0)  # pose in the map and odometry, both at a stamp
        self._trail = PoseTrail(WAITING)  # in the map, and what depth images show
        self._pillars: List[SeenPillar] = []
        self._ball: Optional[Odometry] = None
        self._ball_seen = np.inf  # seconds, in a picture; inf: nobody tells of pictures
        self.pictures = np.nan  # seconds, stamp of the newest that was searched; NaN: nobody tells of them
        self.depth = -np.inf  # seconds, stamp of the newest depth image that was used
        self._T_map_odom = np.eye(4)
        self._is_pressed, self._was_pressed = False, False
        self.map_frame, self.odom_frame, self.base_frame = "", "", ""

    def hear_pose(self, pose: Odometry) -> None:
        """Of the robot in the map. :raises ValueError: it is no pose"""
        self._move(self._pairs.add_first(pose))

    def hear_odometry(self, odometry: Odometry) -> None:
        """:raises ValueError: it is no pose"""
        self.odom_frame, self.base_frame = odometry.header.frame_id, odometry.child_frame_id
        self._move(self._pairs.add_second(odometry))

    def hear_landmarks(self, entries: LandmarkMapEntries) -> None:
        """All that are known. :raises ValueError: a place is not finite"""
        _check_finite([(each.x, each.y) for each in entries.landmarks])
        self._pillars = [
            SeenPillar(each.class_name, np.array([each.x, each.y])) for each in entries.landmarks
        ]

    def hear_ball(self, ball: Odometry) -> None:
        """In odometry's frame. :raises ValueError: it is in another one, or not finite"""
        if self.odom_frame and ball.header.frame_id != self.odom_frame:
            raise ValueError(f"it is in '{ball.header.frame_id}', odometry in '{self.odom_frame}'")
        at, speed = ball.pose.pose.position, ball.twist.twist.linear
        _check_finite([at.x, at.y, at.z, speed.x, speed.y])
        self._ball = ball

    def hear_objects(self, objects: Objects) -> None:
        """In a picture. The ball is told of also while it is only believed to be somewhere."""
        self.pictures = objects.header.stamp.to_sec()
        if any(each.class_name == BALL for each in objects.objects):
            self._ball_seen = objects.header.stamp.to_sec()

    def hear_bumper(self, is_pressed: bool) -> None:
        """A short touch is remembered until the next view."""
        self._is_pressed = is_pressed
        self._was_pressed |= is_pressed

    def forget_touches(self) -> None:
        """Of before."""
        self._was_pressed = self._is_pressed

    def hear_depth(self, stamp: int, points: np.ndarray) -> None:
        """Of the floor (n, 3), in the robot frame; they wait until there is a pose of their time."""
        self._trail.wait(stamp, points)

    @property
    def stamp(self) -> float:
        """Seconds, of the newest pose; -inf: there is none."""
        return 1e-9 * self._trail.newest[0] if self._trail.newest else -np.inf

    def view(self, grid: FloorGrid) -> TaskView:
        """As of the newest pose, which is there."""
        stamp, T_map_base = self._trail.newest
        is_bumped, self._was_pressed = self._was_pressed, self._is_pressed
        ball = self._seen_ball(stamp)
        return TaskView(1e-9 * stamp, planar(T_map_base), self._pillars, ball, is_bumped, grid)

    def looks(self) -> List[Tuple[np.ndarray, np.ndarray]]:
        """Points (n, 3) in the robot frame, and its pose (3,) then, of depth images that were not told."""
        placed = []
        for stamp, points, T_map_base in self._trail.ready():
            self.depth = 1e-9 * stamp
            placed.append((points, planar(T_map_base)))
        return placed

    @property
    def without_pose(self) -> int:
        """Depth images that no pose was told for."""
        return self._trail.forgotten

    def _move(self, pairs: List[Pair]) -> None:
        for pose, odometry in pairs:
            stamp, T_map_base = pose.header.stamp.to_nsec(), pose_from_message(pose.pose.pose)
            if self._trail.is_set_back(stamp):
                self._trail.clear()
                self._ball, self._ball_seen, self._pillars = None, np.inf, []
                self.pictures, self.depth = np.nan, -np.inf
            if self._trail.add(stamp, T_map_base):
                self.map_frame = pose.header.frame_id
                self._T_map_odom = T_map_base @ np.linalg.inv(pose_from_message(odometry.pose.pose))

    def _seen_ball(self, now: int) -> Optional[SeenBall]:
        if self._ball is None:
            return None
        stamp = self._ball.header.stamp.to_nsec()
        if abs(now - stamp) > 1e9 * self._ball_timeout:  # ahead of time: of another clock
            return None
        T, at, speed = self._T_map_odom, self._ball.pose.pose.position, self._ball.twist.twist.linear
        velocity = T[:2, :2] @ [speed.x, speed.y]
        position = T[:2, :3] @ [at.x, at.y, at.z] + T[:2, 3]
        fast = float(np.hypot(*velocity))
        way, slowed = rolled(fast, 1e-9 * (now - stamp), self._ball_deceleration)
        ahead = velocity / max(fast, 1e-9)
        return SeenBall(position + way * ahead, slowed * ahead, min(1e-9 * stamp, self._ball_seen))


def _check_finite(values: Sequence) -> None:
    if not np.all(np.isfinite(values)):
        raise ValueError("a place or a speed is not finite")
