# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What messages tell of robot, pillars, ball and floor, put together in the map at the newest pose."""

from collections import deque
from typing import Deque, List, Optional, Sequence, Tuple

import numpy as np
from nav_msgs.msg import Odometry

from sextant.ball.floor_grid import FloorGrid
from sextant.ball.task_view import SeenBall, SeenPillar, TaskView
from sextant.msg import LandmarkMapEntries, Objects
from sextant.nodes.conversions import pose_from_message
from sextant.nodes.floor_eye import FloorLook
from sextant.nodes.stamp_pairs import Pair, StampPairs
from sextant.objects.object_kinds import BALL
from sextant.poses import LONGEST_GAP, interpolated_poses

KEPT = 500  # poses
WAITING = 5  # depth images
SET_BACK = 10**9  # nanoseconds: stamps that fall back farther are of a clock that was set back


class BallSenses:
    """Not thread-safe."""

    def __init__(self, ball_timeout: float):
        """:param ball_timeout: seconds after which a ball that nobody tells of is not known any more"""
        self._ball_timeout = ball_timeout
        self._pairs = StampPairs(0.0)  # pose in the map and odometry, both at a stamp
        self._poses: Deque[Tuple[int, np.ndarray]] = deque(maxlen=KEPT)  # stamp, T_map_base
        self._looks: Deque[FloorLook] = deque(maxlen=WAITING)
        self._pillars: List[SeenPillar] = []
        self._ball: Optional[Odometry] = None
        self._ball_seen = np.inf  # seconds, in a picture; inf: nobody tells of pictures
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
        if any(each.class_name == BALL for each in objects.objects):
            self._ball_seen = objects.header.stamp.to_sec()

    def hear_bumper(self, is_pressed: bool) -> None:
        """A short touch is remembered until the next view."""
        self._is_pressed = is_pressed
        self._was_pressed |= is_pressed

    def forget_touches(self) -> None:
        """Of before."""
        self._was_pressed = self._is_pressed

    def hear_depth(self, look: FloorLook) -> None:
        """It waits until there is a pose."""
        self._looks.append(look)

    @property
    def stamp(self) -> float:
        """Seconds, of the newest pose; -inf: there is none."""
        return 1e-9 * self._poses[-1][0] if self._poses else -np.inf

    def view(self, grid: FloorGrid) -> TaskView:
        """As of the newest pose, which is there."""
        stamp, T_map_base = self._poses[-1]
        is_bumped, self._was_pressed = self._was_pressed, self._is_pressed
        ball = self._seen_ball(stamp)
        return TaskView(1e-9 * stamp, _planar(T_map_base), self._pillars, ball, is_bumped, grid)

    def looks(self) -> List[Tuple[np.ndarray, np.ndarray]]:
        """Points (n, 3) in the robot frame, and its pose (3,) then, of depth images that were not told."""
        placed = []
        while self._looks and self._poses and self._looks[0].stamp <= self._poses[-1][0]:
            look = self._looks.popleft()
            stamps, poses = (np.array(values) for values in zip(*self._poses))
            (T,) = interpolated_poses(stamps, poses, np.array([look.stamp]), LONGEST_GAP)
            if T is not None:
                placed.append((look.points, _planar(T)))
        return placed

    def _move(self, pairs: List[Pair]) -> None:
        for pose, odometry in pairs:
            stamp, T_map_base = pose.header.stamp.to_nsec(), pose_from_message(pose.pose.pose)
            if self._poses and stamp < self._poses[-1][0] - SET_BACK:
                self._poses.clear()
                self._looks.clear()
                self._ball, self._ball_seen = None, np.inf
            elif self._poses and stamp <= self._poses[-1][0]:
                continue
            self.map_frame = pose.header.frame_id
            self._T_map_odom = T_map_base @ np.linalg.inv(pose_from_message(odometry.pose.pose))
            self._poses.append((stamp, T_map_base))

    def _seen_ball(self, now: int) -> Optional[SeenBall]:
        if self._ball is None:
            return None
        stamp = self._ball.header.stamp.to_nsec()
        if now - stamp > 1e9 * self._ball_timeout:
            return None
        T, at, speed = self._T_map_odom, self._ball.pose.pose.position, self._ball.twist.twist.linear
        velocity = T[:2, :2] @ [speed.x, speed.y]
        position = T[:2, :3] @ [at.x, at.y, at.z] + T[:2, 3] + 1e-9 * (now - stamp) * velocity
        return SeenBall(position, velocity, min(1e-9 * stamp, self._ball_seen))


def _check_finite(values: Sequence) -> None:
    if not np.all(np.isfinite(values)):
        raise ValueError("a place or a speed is not finite")


def _planar(T: np.ndarray) -> np.ndarray:
    """(3,) x, y, heading."""
    return np.array([T[0, 3], T[1, 3], np.arctan2(T[1, 0], T[0, 0])])
