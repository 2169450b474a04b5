# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a robot knows of pillars and ball at a moment, and what it does then."""

from typing import List, NamedTuple, Optional

import numpy as np

from sextant.ball.floor_grid import FloorGrid
from sextant.ball.goal import Goal
from sextant.ball.kick_plan import Kick
from sextant.ball.path_follower import Command

STILL = 0.08  # m/s; a ball that is slower lies
NO_PATH = np.zeros((0, 2))


class SeenPillar(NamedTuple):
    """A landmark."""

    class_name: str
    position: np.ndarray  # (2,) metres, map


class SeenBall(NamedTuple):
    """As it is followed."""

    position: np.ndarray  # (2,) metres, map
    velocity: np.ndarray  # (2,) m/s
    stamp: float  # seconds, of the picture that showed it last

    @property
    def is_still(self) -> bool:
        """Whether it lies."""
        return float(np.hypot(*self.velocity)) < STILL


class TaskView(NamedTuple):
    """All that is known at a moment."""

    stamp: float  # seconds
    pose: np.ndarray  # (3,) x, y, heading of the robot, metres and radians, map
    pillars: List[SeenPillar]
    ball: Optional[SeenBall]
    is_bumped: bool
    grid: FloorGrid

    def validate(self) -> None:
        """:raises ValueError: names the first place that is not finite"""
        places = [("pose", self.pose)]
        if self.ball is not None:
            places += [("ball/position", self.ball.position), ("ball/velocity", self.ball.velocity)]
        places += [(f"pillars/{i}", pillar.position) for i, pillar in enumerate(self.pillars)]
        for name, values in places:
            if not np.isfinite(values).all():
                raise ValueError(f"{name} is {np.asarray(values).tolist()}, all of it must be finite")


class Step(NamedTuple):
    """What a state does at a moment."""

    command: Command
    next: str = ""  # state; empty: it stays
    reason: str = ""  # why another
    path: np.ndarray = NO_PATH  # (n, 2) metres, map


class Action(NamedTuple):
    """What is to be done, and why."""

    command: Command
    state: str
    reason: str
    path: np.ndarray  # (n, 2) metres, map; empty: none
    goal: Optional[Goal]
    kick: Optional[Kick]
    kicks: int
    is_ended: bool
