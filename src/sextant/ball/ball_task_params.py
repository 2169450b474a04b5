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

    goal_width: float = param(0.7, within(1e-3, 10))  # minimum distance between the posts' axes, metres
    pillar_radius: float = param(0.05, within(1e-3, 1))  # metres
    stop_distance: float = param(
        0.2, within(0, 5)
    )  # metres from the goal line to the robot's front at the end
    clearance: float = param(0.06, within(0, 1))  # metres from the robot's edge to obstacles
    time_limit: float = param(240.0, within(1e-3, 1e6))  # seconds since the start
    max_kicks: int = param(8, within(1, 100))  # then the task fails
    max_bumps: int = param(5, within(0, 100))  # with more the task fails
    max_searches: int = param(8, within(1, 100))  # vantage points of one search
    kick: KickParams = nested(KickParams)
    follower: FollowerParams = nested(FollowerParams)
