# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""How a robot moves on the floor: along a figure of eight, or as it is told (unicycle)."""

from dataclasses import dataclass
from typing import Callable, Tuple

import numpy as np

import sextant


@dataclass(frozen=True)
class Motion:
    """Place (in map, or in odom as the wheels see it) and speed of a robot that moves forward and turns."""

    x: float = 0.0  # metres
    y: float = 0.0
    z: float = 0.0  # of the floor
    yaw: float = 0.0  # radians
    speed: float = 0.0  # m/s, forward
    turn_rate: float = 0.0  # rad/s, counterclockwise

    @property
    def pose(self) -> np.ndarray:
        """T_frame_base (4, 4), metres, in the frame that x, y and yaw are in."""
        return sextant.pose_from_xyz_rpy([self.x, self.y, self.z], [0.0, 0.0, self.yaw])

    def after(self, seconds: float) -> "Motion":
        """The motion later (or, negative, earlier) on the same circular arc."""
        distance, turn = self.speed * seconds, self.turn_rate * seconds
        # chord of the arc: numpy's sinc(x) is sin(pi x) / (pi x)
        chord = distance * np.sinc(0.5 * turn / np.pi)
        heading = self.yaw + 0.5 * turn
        return Motion(
            self.x + chord * np.cos(heading),
            self.y + chord * np.sin(heading),
            self.z,
            self.yaw + turn,
            self.speed,
            self.turn_rate,
        )


@dataclass(frozen=True)
class FigureEight:
    """Lemniscate of Gerono: x = a sin(phi), y = b sin(2 phi) with phi = 2 pi t / period; looks ahead."""

    half_length: float = 2.4  # a, metres
    half_width: float = 1.4  # b, metres
    period: float = 20.0  # seconds for one eight
    center: Tuple[float, float, float] = (0.0, 0.0, 0.0)  # metres, map

    def at(self, t: float) -> Motion:
        """Motion at t seconds, in closed form."""
        w = 2.0 * np.pi / self.period
        a, b, phi = self.half_length, self.half_width, w * t
        x, y = a * np.sin(phi), b * np.sin(2.0 * phi)
        vx, vy = w * a * np.cos(phi), 2.0 * w * b * np.cos(2.0 * phi)
        ax, ay = -w * w * x, -4.0 * w * w * y
        turn_rate = (vx * ay - vy * ax) / (vx * vx + vy * vy)
        return Motion(
            self.center[0] + x,
            self.center[1] + y,
            self.center[2],
            np.arctan2(vy, vx),
            np.hypot(vx, vy),
            turn_rate,
        )

    @property
    def top_speed(self) -> float:
        """m/s, reached in the crossing."""
        return 2.0 * np.pi / self.period * np.hypot(self.half_length, 2.0 * self.half_width)


class Unicycle:
    """A robot that does as it is told, but for walls and obstacles: there it stops and may only turn."""

    def __init__(self, start: Motion, is_free: Callable[[float, float], bool]):
        self._motion = start
        self._is_free = is_free

    def drive(self, speed: float, turn_rate: float, seconds: float) -> Motion:
        """Motion after driving with speed (m/s) and turn_rate (rad/s) for so many seconds."""
        told = Motion(self._motion.x, self._motion.y, self._motion.z, self._motion.yaw, speed, turn_rate)
        moved = told.after(seconds)
        if not self._is_free(moved.x, moved.y):
            moved = Motion(told.x, told.y, told.z, moved.yaw, 0.0, turn_rate)
        self._motion = moved
        return moved


def free_floor(room: "sextant.RoomSceneParams", radius: float) -> Callable[[float, float], bool]:
    """Whether a robot of this radius (metres) fits at a place (x, y) between walls and obstacles."""
    center, half = room.floor_center[:2], 0.5 * room.size[:2] - radius
    blocked = [(box.center[:2], 0.5 * box.size[:2] + radius) for box in room.obstacles]

    def is_free(x: float, y: float) -> bool:
        p = np.array([x, y])
        inside = bool(np.all(np.abs(p - center) <= half))
        return inside and not any(np.all(np.abs(p - middle) < reach) for middle, reach in blocked)

    return is_free
