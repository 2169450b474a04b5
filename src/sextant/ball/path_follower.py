# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Follows a way of straight lines: pure pursuit (Coulter 1992, "Implementation of the pure pursuit path
tracking algorithm")."""

import math
from dataclasses import dataclass
from typing import Tuple

import numpy as np

from sextant.base.strict_params import StrictParams, param, within


@dataclass(frozen=True)
class FollowerParams(StrictParams):
    """How a robot with two wheels drives."""

    speed: float = param(0.4, within(1e-3, 10))  # m/s
    turn_rate: float = param(1.2, within(1e-3, 20))  # rad/s
    acceleration: float = param(0.6, within(1e-3, 100))  # m/s^2 with which it slows down
    turn_acceleration: float = param(2.5, within(1e-3, 1000))  # rad/s^2
    lookahead: float = param(0.25, within(1e-3, 10))  # metres to the point of the way that it drives at
    turn_first: float = param(0.5, within(1e-3, 3.15))  # radians; what lies farther aside is turned to first
    slowest: float = param(0.04, within(1e-3, 1))  # m/s
    search_rate: float = param(0.7, within(1e-3, 20))  # rad/s while it looks around


Command = Tuple[float, float]  # m/s, rad/s
HALT: Command = (0.0, 0.0)


class PathFollower:
    """Speed and turn rate of the moment."""

    def __init__(self, params: FollowerParams):
        """:raises ValueError: a parameter out of range"""
        self.params = params

    def follow(self, pose: np.ndarray, path: np.ndarray) -> Command:
        """Of the way's parts it follows the nearest: one that doubles back on itself leads nowhere.

        :param pose: (3,) x, y, heading. :param path: (n, 2) corners, in the same frame
        """
        target, rest = ahead_on(path, pose[:2], self.params.lookahead)
        bearing = bearing_of(pose, target)
        if abs(bearing) > self.params.turn_first:
            return 0.0, self.turn(bearing)
        distance = max(float(np.linalg.norm(target - pose[:2])), 0.05)
        curvature = 2.0 * math.sin(bearing) / distance
        speed = min(self.stopping_speed(rest), self.params.turn_rate / max(abs(curvature), 1e-6))
        return speed, speed * curvature

    def turn(self, angle: float) -> float:
        """rad/s on the spot, of the angle that is left."""
        params = self.params
        rate = min(
            params.turn_rate, math.sqrt(2.0 * params.turn_acceleration * abs(angle)) * 0.7, 3.0 * abs(angle)
        )
        return math.copysign(rate, angle)

    def stopping_speed(self, rest: float) -> float:
        """m/s with which the robot can still stop after so many metres."""
        params = self.params
        speed = min(
            params.speed, math.sqrt(2.0 * params.acceleration * max(0.0, rest)) * 0.8, 2.5 * max(0.0, rest)
        )
        return max(params.slowest, speed)


def bearing_of(pose: np.ndarray, point: np.ndarray) -> float:
    """Radians from a robot's heading to a point, within pi."""
    x, y, heading = pose
    return math.remainder(math.atan2(point[1] - y, point[0] - x) - heading, 2.0 * math.pi)


def ahead_on(path: np.ndarray, point: np.ndarray, lookahead: float) -> Tuple[np.ndarray, float]:
    """The point of a way so far ahead of that nearest to a point, and the metres from there on."""
    legs = np.diff(path, axis=0)
    lengths = np.maximum(np.linalg.norm(legs, axis=1), 1e-9)
    share = np.clip(((point - path[:-1]) * legs).sum(axis=1) / lengths**2, 0.0, 1.0)
    off = np.linalg.norm(path[:-1] + share[:, np.newaxis] * legs - point, axis=1)
    nearest = int(np.argmin(off))
    gone = float(lengths[:nearest].sum() + share[nearest] * lengths[nearest])
    ends = np.concatenate([[0.0], np.cumsum(lengths)])
    at = min(gone + lookahead, ends[-1])
    target = np.array([np.interp(at, ends, path[:, axis]) for axis in range(2)])
    return target, float(ends[-1] - gone)
