# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of the ball task."""

from dataclasses import dataclass

from sextant.ball.kick_plan import KickParams
from sextant.ball.path_follower import FollowerParams
from sextant.base.strict_params import StrictParams, nested, param, within


@dataclass(frozen=True)
class BallTaskParams(StrictParams):
    """Geometry of the goal, and limits after which the task fails."""

    goal_width: float = param(
        0.7, "minimum distance between the axes of the goal's posts", within(1e-3, 10), "m"
    )
    pillar_radius: float = param(0.05, "radius of the pillars", within(1e-3, 1), "m")
    stop_distance: float = param(
        0.2, "distance from the goal line to the robot's front at the end", within(0, 5), "m"
    )
    clearance: float = param(
        0.06,
        "minimum distance from the robot's edge to obstacles; smaller where there is no such path",
        within(0, 1),
        "m",
    )
    time_limit: float = param(
        240.0, "time since the start after which the task fails", within(1e-3, 1e6), "s"
    )
    max_kicks: int = param(8, "number of kicks without success after which the task fails", within(1, 100))
    max_bumps: int = param(5, "number of collisions above which the task fails", within(0, 100))
    max_searches: int = param(8, "maximum number of vantage points of one search", within(1, 100))
    kick: KickParams = nested(KickParams)
    follower: FollowerParams = nested(FollowerParams)
