# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Input of the ball task, what is known at one time, and its output."""

from typing import List, NamedTuple, Optional

import numpy as np

from sextant.ball.floor_grid import FloorGrid
from sextant.ball.goal import Goal
from sextant.ball.kick_plan import Kick
from sextant.ball.path_follower import Command

STILL = 0.08  # m/s; a slower ball is at rest
NO_PATH = np.zeros((0, 2))


class SeenPillar(NamedTuple):
    """A pillar in the landmark map."""

    class_name: str  # of the detector
    position: np.ndarray  # (2,) metres, map


class SeenBall(NamedTuple):
    """The tracked ball."""

    position: np.ndarray  # (2,) metres, map
    velocity: np.ndarray  # (2,) m/s
    stamp: float  # seconds, of the last image with the ball

    @property
    def is_still(self) -> bool:
        """Whether the ball is at rest."""
        return float(np.hypot(*self.velocity)) < STILL


class TaskView(NamedTuple):
    """What is known at one time."""

    stamp: float  # seconds
    pose: np.ndarray  # (3,) x, y, heading of the robot, metres and radians, map
    pillars: List[SeenPillar]  # of the landmark map
    ball: Optional[SeenBall]  # None: unknown
    is_bumped: bool  # since the last view
    grid: FloorGrid  # the known floor

    def validate(self) -> None:
        """:raises ValueError: names the first position that is not finite"""
        places = [("pose", self.pose)]
        if self.ball is not None:
            places += [("ball/position", self.ball.position), ("ball/velocity", self.ball.velocity)]
        places += [(f"pillars/{i}", pillar.position) for i, pillar in enumerate(self.pillars)]
        for name, values in places:
            if not np.isfinite(values).all():
                raise ValueError(f"{name} is {np.asarray(values).tolist()}, all of it must be finite")


class Step(NamedTuple):
    """Result of one step of a state."""

    command: Command  # for the robot
    next: str = ""  # next state; empty: no change
    reason: str = ""  # for the change of state
    path: np.ndarray = NO_PATH  # (n, 2) metres, map


class Action(NamedTuple):
    """Result of one step of the task."""

    command: Command  # for the robot
    state: str  # name
    reason: str  # of the last change of state
    path: np.ndarray  # (n, 2) metres, map; empty: none
    goal: Optional[Goal]  # None: not found yet
    kick: Optional[Kick]  # the planned one; None: none
    kicks: int  # number of kicks so far
    is_ended: bool  # the task is done or has failed
