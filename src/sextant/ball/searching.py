# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Looks around, then drives to where nobody has looked, until ball and goal are seen."""

import math
from typing import Optional

import numpy as np

from sextant.ball.ball_floor import BallFloor, way_to
from sextant.ball.ball_task_params import BallTaskParams
from sextant.ball.path_follower import HALT, PathFollower
from sextant.ball.task_view import Step, TaskView

FULL_TURN = 2.0 * math.pi + 0.4  # radians
REPLAN = 1.0  # seconds
ARRIVED = 0.15  # metres


class FullTurn:
    """Once around and a little more, on the spot."""

    def __init__(self) -> None:
        self._turned, self._heading = 0.0, None  # radians

    def is_done(self, heading: float) -> bool:
        """To be told each heading."""
        if self._heading is not None:
            self._turned += math.remainder(heading - self._heading, 2.0 * math.pi)
        self._heading = heading
        return abs(self._turned) >= FULL_TURN


class Searching:
    """A search begins where the robot stands."""

    def __init__(self, params: BallTaskParams):
        self._params, self._follower = params, PathFollower(params.follower)
        self._turn = FullTurn()
        self._places = 0
        self._goal: Optional[np.ndarray] = None  # where it drives
        self._path, self._planned = None, -math.inf

    def step(self, view: TaskView, lacking: str) -> Step:
        """:param lacking: what is looked for"""
        if self._goal is not None:
            return self._drive(view)
        if not self._turn.is_done(view.pose[2]):
            return Step((0.0, self._params.follower.search_rate))
        return self._go_on(view, lacking)

    def _go_on(self, view: TaskView, lacking: str) -> Step:
        place = BallFloor(self._params, view, [], self._params.clearance).vantage()
        if place is None or self._places >= self._params.most_searches:
            return Step(HALT, "failed", f"no {lacking} was found from {self._places + 1} places")
        self._places += 1
        self._goal, self._planned = place, -math.inf
        return Step(HALT)

    def _drive(self, view: TaskView) -> Step:
        if view.stamp - self._planned > REPLAN:
            self._path, self._planned = way_to(self._params, view, self._goal), view.stamp
        if self._path is None or np.linalg.norm(view.pose[:2] - self._goal) < ARRIVED:
            self._goal, self._turn = None, FullTurn()
            return Step(HALT)
        return Step(self._follower.follow(view.pose, self._path), path=self._path)
