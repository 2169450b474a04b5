# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of the ball task."""

from dataclasses import dataclass

from sextant.ball.kick_plan import KickParams
from sextant.ball.path_follower import FollowerParams
from sextant.base.strict_params import StrictParams, nested, param, within


@dataclass(frozen=True)
class BallTaskParams(StrictParams):
    """What the robot shall do, and when it gives up."""

    goal_width: float = param(0.7, within(1e-3, 10))  # metres between the goal's posts, at least
    pillar_radius: float = param(0.05, within(1e-3, 1))  # metres
    stop_distance: float = param(0.2, within(0, 5))  # metres from the goal's line to the robot, at the end
    clearance: float = param(0.06, within(0, 1))  # metres that the robot keeps from everything
    time_limit: float = param(240.0, within(1e-3, 1e6))  # seconds from the start
    most_kicks: int = param(8, within(1, 100))
    most_bumps: int = param(5, within(0, 100))
    most_searches: int = param(8, within(1, 100))  # places from where it looks around for what it lacks
    kick: KickParams = nested(KickParams)
    follower: FollowerParams = nested(FollowerParams)
