# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Collects messages about robot, pillars, ball and floor to a view in the map frame at the newest pose."""

from typing import List, Optional, Sequence, Tuple

import numpy as np
from nav_msgs.msg import Odometry

from sextant.ball.floor_grid import FloorGrid
from sextant.ball.task_view import SeenBall, SeenPillar, TaskView
from sextant.geometry.plane_poses import planar
from sextant.messages.pose_messages import pose_from_message
from sextant.msg import LandmarkMapEntries, Objects
from sextant.nodes.base.stamp_pairs import Pair, StampPairs
from sextant.nodes.objects.pose_buffer import PoseBuffer
from sextant.objects.ball_filter import roll
from sextant.objects.object_kinds import BALL

WAITING = 60  # depth images


class BallTaskInputs:
    """State of all subscriptions of the ball task. Not thread-safe."""

    def __init__(self, ball_timeout: float, ball_deceleration: float):
        """:param ball_timeout: seconds since the last message after which the ball is unknown
        :param ball_deceleration: of a rolling ball, m/s^2
        """
        self._ball_timeout, self._ball_deceleration = ball_timeout, ball_deceleration
        self._pairs = StampPairs(0.0)  # pose in the map and odometry of the same stamp
        self._poses = PoseBuffer(WAITING)  # in the map, and points that wait for a pose
        self._pillars: List[SeenPillar] = []
        self._ball: Optional[Odometry] = None
        self._ball_seen = np.inf  # seconds, stamp of the newest image with the ball; inf: no images
        self.newest_image = np.nan  # seconds, stamp of the newest processed image; NaN: none
        self.newest_depth = -np.inf  # seconds, stamp of the newest depth image used
        self._T_map_odom = np.eye(4)
        self._is_pressed, self._was_pressed = False, False
        self.map_frame, self.odom_frame, self.base_frame = "", "", ""

    def add_pose(self, pose: Odometry) -> None:
        """Add a pose of the robot in the map. :raises ValueError: the pose is not valid"""
        self._add_pairs(self._pairs.add_first(pose))

    def add_odometry(self, odometry: Odometry) -> None:
        """Add a pose of the robot in the odometry frame. :raises ValueError: the pose is not valid"""
        self.odom_frame, self.base_frame = odometry.header.frame_id, odometry.child_frame_id
        self._add_pairs(self._pairs.add_second(odometry))

    def set_landmarks(self, entries: LandmarkMapEntries) -> None:
        """Set all pillars. :raises ValueError: a position is not finite"""
        _check_finite([(each.x, each.y) for each in entries.landmarks])
        self._pillars = [
            SeenPillar(each.class_name, np.array([each.x, each.y])) for each in entries.landmarks
        ]

    def set_ball(self, ball: Odometry) -> None:
        """Set the ball in the odometry frame. :raises ValueError: another frame, or not finite"""
        if self.odom_frame and ball.header.frame_id != self.odom_frame:
            raise ValueError(f"its frame is '{ball.header.frame_id}', odometry's is '{self.odom_frame}'")
        at, speed = ball.pose.pose.position, ball.twist.twist.linear
        _check_finite([at.x, at.y, at.z, speed.x, speed.y])
        self._ball = ball

    def set_objects(self, objects: Objects) -> None:
        """Store when an image showed the ball: the ball is also published while it is only predicted."""
        self.newest_image = objects.header.stamp.to_sec()
        if any(each.class_name == BALL for each in objects.objects):
            self._ball_seen = objects.header.stamp.to_sec()

    def set_bumper(self, is_pressed: bool) -> None:
        """Set the bumper's state; a short touch is kept until the next view."""
        self._is_pressed = is_pressed
        self._was_pressed |= is_pressed

    def clear_touches(self) -> None:
        """Discard earlier touches."""
        self._was_pressed = self._is_pressed

    def add_depth_points(self, stamp: int, points: np.ndarray) -> None:
        """Add points (n, 3) of a depth image, metres, robot frame. :param stamp: nanoseconds"""
        self._poses.add_item(stamp, points)

    @property
    def stamp(self) -> float:
        """Stamp of the newest pose, seconds; -inf: none."""
        return 1e-9 * self._poses.newest[0] if self._poses.newest else -np.inf

    def task_view(self, grid: FloorGrid) -> TaskView:
        """The state at the newest pose, which must exist."""
        stamp, T_map_base = self._poses.newest
        is_bumped, self._was_pressed = self._was_pressed, self._is_pressed
        ball = self._seen_ball(stamp)
        return TaskView(1e-9 * stamp, planar(T_map_base), self._pillars, ball, is_bumped, grid)

    def ready_points(self) -> List[Tuple[np.ndarray, np.ndarray]]:
        """Points (n, 3) in the robot frame and its pose (3,) in the map, of depth images with a pose."""
        placed = []
        for stamp, points, T_map_base in self._poses.ready():
            self.newest_depth = 1e-9 * stamp
            placed.append((points, planar(T_map_base)))
        return placed

    @property
    def without_pose(self) -> int:
        """Number of depth images dropped because there was no pose at their stamp."""
        return self._poses.dropped

    def _add_pairs(self, pairs: List[Pair]) -> None:
        for pose, odometry in pairs:
            stamp, T_map_base = pose.header.stamp.to_nsec(), pose_from_message(pose.pose.pose)
            if self._poses.jumps_back(stamp):
                self._poses.clear()
                self._ball, self._ball_seen, self._pillars = None, np.inf, []
                self.newest_image, self.newest_depth = np.nan, -np.inf
            if self._poses.add(stamp, T_map_base):
                self.map_frame = pose.header.frame_id
                self._T_map_odom = T_map_base @ np.linalg.inv(pose_from_message(odometry.pose.pose))

    def _seen_ball(self, now: int) -> Optional[SeenBall]:
        if self._ball is None:
            return None
        stamp = self._ball.header.stamp.to_nsec()
        if abs(now - stamp) > 1e9 * self._ball_timeout:  # abs: a stamp in the future is of another clock
            return None
        T, at, speed = self._T_map_odom, self._ball.pose.pose.position, self._ball.twist.twist.linear
        velocity = T[:2, :2] @ [speed.x, speed.y]
        position = T[:2, :3] @ [at.x, at.y, at.z] + T[:2, 3]
        fast = float(np.hypot(*velocity))
        distance, slowed = roll(fast, 1e-9 * (now - stamp), self._ball_deceleration)
        ahead = velocity / max(fast, 1e-9)
        return SeenBall(position + distance * ahead, slowed * ahead, min(1e-9 * stamp, self._ball_seen))


def _check_finite(values: Sequence) -> None:
    if not np.all(np.isfinite(values)):
        raise ValueError("a position or a speed is not finite")
