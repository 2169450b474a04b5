# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Path following by pure pursuit (Coulter 1992, "Implementation of the pure pursuit path tracking
algorithm")."""

import math
from dataclasses import dataclass
from typing import Tuple

import numpy as np

from sextant.base.strict_params import StrictParams, param, within


@dataclass(frozen=True)
class FollowerParams(StrictParams):
    """Limits of a differential drive, and parameters of pure pursuit."""

    speed: float = param(0.4, "maximum speed on a path", within(1e-3, 10), "m/s")
    turn_rate: float = param(1.2, "maximum turn rate", within(1e-3, 20), "rad/s")
    acceleration: float = param(
        0.6,
        "acceleration in the run-up, and deceleration before the end of a path",
        within(1e-3, 100),
        "m/s²",
    )
    turn_acceleration: float = param(2.5, "angular acceleration", within(1e-3, 1000), "rad/s²")
    lookahead: float = param(0.25, "lookahead distance of pure pursuit", within(1e-3, 10), "m")
    rotate_in_place_angle: float = param(
        0.5, "angle to the lookahead point above which the robot turns in place", within(1e-3, 3.15), "rad"
    )
    min_speed: float = param(0.04, "minimum speed that moves the base", within(1e-3, 1), "m/s")
    search_turn_rate: float = param(0.7, "turn rate while searching", within(1e-3, 20), "rad/s")


Command = Tuple[float, float]  # m/s, rad/s
HALT: Command = (0.0, 0.0)


def follow(params: FollowerParams, pose: np.ndarray, path: np.ndarray) -> Command:
    """Command toward the point of the path at the lookahead distance; paths must not double back.

    :param pose: (3,) x, y, heading. :param path: (n, 2) corners, in the same frame
    """
    target, remaining = lookahead_point(path, pose[:2], params.lookahead)
    bearing = bearing_of(pose, target)
    if abs(bearing) > params.rotate_in_place_angle:
        return 0.0, turn_on_the_spot(params, bearing)
    distance = max(float(np.linalg.norm(target - pose[:2])), 0.05)
    curvature = 2.0 * math.sin(bearing) / distance
    speed = min(stopping_speed(params, remaining), params.turn_rate / max(abs(curvature), 1e-6))
    return speed, speed * curvature


def turn_on_the_spot(params: FollowerParams, angle: float) -> float:
    """Turn rate (rad/s) for a remaining angle (radians)."""
    braking = math.sqrt(2.0 * params.turn_acceleration * abs(angle)) * 0.7
    return math.copysign(min(params.turn_rate, braking, 3.0 * abs(angle)), angle)


def stopping_speed(params: FollowerParams, remaining: float) -> float:
    """Speed (m/s) from which the robot can stop in the remaining distance (metres), at least min_speed."""
    remaining = max(0.0, remaining)
    braking = math.sqrt(2.0 * params.acceleration * remaining) * 0.8
    return max(params.min_speed, min(params.speed, braking, 2.5 * remaining))


def bearing_of(pose: np.ndarray, point: np.ndarray) -> float:
    """Angle from the robot's heading to a point, radians in [-pi, pi]."""
    x, y, heading = pose
    return math.remainder(math.atan2(point[1] - y, point[0] - x) - heading, 2.0 * math.pi)


def lookahead_point(path: np.ndarray, point: np.ndarray, lookahead: float) -> Tuple[np.ndarray, float]:
    """The point (2,) of the path that is lookahead metres, along the path, after the path's point nearest to
    a given one; and the length of the path after that nearest point."""
    segments = np.diff(path, axis=0)
    lengths = np.maximum(np.linalg.norm(segments, axis=1), 1e-9)
    share = np.clip(((point - path[:-1]) * segments).sum(axis=1) / lengths**2, 0.0, 1.0)
    distances = np.linalg.norm(path[:-1] + share[:, np.newaxis] * segments - point, axis=1)
    nearest = int(np.argmin(distances))
    travelled = float(lengths[:nearest].sum() + share[nearest] * lengths[nearest])
    ends = np.concatenate([[0.0], np.cumsum(lengths)])
    at = min(travelled + lookahead, ends[-1])
    target = np.array([np.interp(at, ends, path[:, axis]) for axis in range(2)])
    return target, float(ends[-1] - travelled)
