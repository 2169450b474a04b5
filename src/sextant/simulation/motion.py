# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Motion of a robot on the floor: along a figure of eight, or as commanded (unicycle model)."""

from dataclasses import dataclass
from typing import Callable, Tuple

import numpy as np

import sextant
from sextant.base.strict_params import StrictParams, param, within


@dataclass(frozen=True)
class Motion:
    """Pose (in map, or in odom for wheel odometry) and velocity of a differential drive."""

    x: float = 0.0  # metres
    y: float = 0.0  # metres
    z: float = 0.0  # height of the floor, metres
    yaw: float = 0.0  # radians
    speed: float = 0.0  # m/s, forward
    turn_rate: float = 0.0  # rad/s, counterclockwise

    @property
    def pose(self) -> np.ndarray:
        """T_frame_base (4, 4), metres, in the frame of x, y and yaw."""
        return sextant.pose_from_xyz_rpy([self.x, self.y, self.z], [0.0, 0.0, self.yaw])

    def after(self, seconds: float) -> "Motion":
        """Returns the motion after a time (seconds; negative: before) on the same circular arc."""
        distance, turn = self.speed * seconds, self.turn_rate * seconds
        # chord of the arc: numpy's sinc(x) is sin(pi x) / (pi x)
        chord = distance * np.sinc(0.5 * turn / np.pi)
        heading = self.yaw + 0.5 * turn
        x, y = self.x + chord * np.cos(heading), self.y + chord * np.sin(heading)
        return Motion(x, y, self.z, self.yaw + turn, self.speed, self.turn_rate)


@dataclass(frozen=True)
class FigureEight(StrictParams):
    """Lemniscate of Gerono: x = a sin(phi), y = b sin(2 phi) with phi = 2 pi t / period."""

    half_length: float = param(2.4, "half length of the path", within(0.1, 500.0), "m")
    half_width: float = param(1.4, "half width of the path", within(0.05, 500.0), "m")
    period: float = param(20.0, "time per lap", within(1.0, 1e5), "s")
    center: Tuple[float, float, float] = (0.0, 0.0, 0.0)  # metres, map

    def at(self, t: float) -> Motion:
        """Returns the motion at t seconds."""
        w = 2.0 * np.pi / self.period
        a, b, phi = self.half_length, self.half_width, w * t
        x, y = a * np.sin(phi), b * np.sin(2.0 * phi)
        vx, vy = w * a * np.cos(phi), 2.0 * w * b * np.cos(2.0 * phi)
        ax, ay = -w * w * x, -4.0 * w * w * y
        turn_rate = (vx * ay - vy * ax) / (vx * vx + vy * vy)
        x0, y0, z0 = self.center
        return Motion(x0 + x, y0 + y, z0, np.arctan2(vy, vx), np.hypot(vx, vy), turn_rate)


class Unicycle:
    """A robot that follows its commands; at walls and obstacles it stops and can only turn."""

    def __init__(self, start: Motion, is_free: Callable[[float, float], bool]):
        self._motion = start
        self._is_free = is_free

    def drive(self, speed: float, turn_rate: float, seconds: float) -> Motion:
        """Returns the motion after driving with a speed (m/s) and a turn rate (rad/s) for a time (s)."""
        commanded = Motion(self._motion.x, self._motion.y, self._motion.z, self._motion.yaw, speed, turn_rate)
        moved = commanded.after(seconds)
        if not self._is_free(moved.x, moved.y):
            moved = Motion(commanded.x, commanded.y, commanded.z, moved.yaw, 0.0, turn_rate)
        self._motion = moved
        return moved


def free_floor(room: "sextant.RoomSceneParams", radius: float) -> Callable[[float, float], bool]:
    """Returns a check whether a robot of this radius (metres) fits at (x, y) between walls and obstacles."""
    center, half = room.floor_center[:2], 0.5 * room.size[:2] - radius
    blocked = [(box.center[:2], 0.5 * box.size[:2] + radius) for box in room.obstacles]

    def is_free(x: float, y: float) -> bool:
        p = np.array([x, y])
        inside = bool(np.all(np.abs(p - center) <= half))
        return inside and not any(np.all(np.abs(p - middle) < reach) for middle, reach in blocked)

    return is_free
