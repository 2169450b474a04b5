# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of the ball task."""

from dataclasses import dataclass, field

from sextant.ball.kick_plan import KickParams
from sextant.ball.path_follower import FollowerParams
from sextant.base.ranges import check_ranges


@dataclass(frozen=True)
class BallTaskParams:
    """What the robot shall do, and when it gives up."""

    goal_width: float = 0.7  # (0, 10] metres between the goal's posts, at least
    pillar_radius: float = 0.05  # (0, 1] metres
    stop_distance: float = 0.2  # [0, 5] metres from the goal's line to the robot's foremost point, at the end
    clearance: float = 0.06  # [0, 1] metres that the robot keeps from everything
    time_limit: float = 240.0  # (0, 1e6] seconds from the start
    most_kicks: int = 8  # [1, 100]
    most_bumps: int = 5  # [0, 100]
    most_searches: int = 8  # [1, 100] places from where it looks around for what it lacks
    kick: KickParams = field(default_factory=KickParams)
    follower: FollowerParams = field(default_factory=FollowerParams)

    def validate(self) -> None:
        """:raises ValueError: names the first field out of range"""
        check_ranges(self, goal_width=(1e-3, 10), pillar_radius=(1e-3, 1), stop_distance=(0, 5))
        check_ranges(self, clearance=(0, 1), time_limit=(1e-3, 1e6), most_kicks=(1, 100), most_bumps=(0, 100))
        check_ranges(self, most_searches=(1, 100))
        self.kick.validate()
        self.follower.validate()
