# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Search for ball and goal: turn once, then drive to vantage points."""

import math
from typing import Optional

import numpy as np

from sextant.ball.ball_task_params import BallTaskParams
from sextant.ball.path_follower import HALT, follow
from sextant.ball.task_planner import TaskPlanner, path_to
from sextant.ball.task_view import Step, TaskView

FULL_TURN = 2.0 * math.pi + 0.4  # radians
REPLAN = 1.0  # seconds
ARRIVED = 0.15  # metres


class FullTurn:
    """One full turn on the spot with a small overlap."""

    def __init__(self) -> None:
        self._turned, self._heading = 0.0, None  # radians

    def is_done(self, heading: float) -> bool:
        """Add the present heading (radians); returns whether the turn is complete."""
        if self._heading is not None:
            self._turned += math.remainder(heading - self._heading, 2.0 * math.pi)
        self._heading = heading
        return abs(self._turned) >= FULL_TURN


class Searching:
    """A search that starts at the robot's pose."""

    def __init__(self, params: BallTaskParams):
        self._params, self._turn = params, FullTurn()
        self._places = 0
        self._goal: Optional[np.ndarray] = None  # vantage point (2,), metres, map
        self._path, self._planned = None, -math.inf

    def step(self, view: TaskView, missing: str) -> Step:
        """One step of the search. :param missing: what is searched for"""
        if self._goal is not None:
            return self._drive(view)
        if not self._turn.is_done(view.pose[2]):
            return Step((0.0, self._params.follower.search_turn_rate))
        return self._next_place(view, missing)

    def _next_place(self, view: TaskView, missing: str) -> Step:
        place = TaskPlanner(self._params, view, [], self._params.clearance).vantage()
        if place is None or self._places >= self._params.max_searches:
            return Step(HALT, "failed", f"no {missing} was found from {self._places + 1} places")
        self._places += 1
        self._goal, self._planned = place, -math.inf
        return Step(HALT)

    def _drive(self, view: TaskView) -> Step:
        if view.stamp - self._planned > REPLAN:
            self._path, self._planned = path_to(self._params, view, self._goal), view.stamp
        if self._path is None or np.linalg.norm(view.pose[:2] - self._goal) < ARRIVED:
            self._goal, self._turn = None, FullTurn()
            return Step(HALT)
        return Step(follow(self._params.follower, view.pose, self._path), path=self._path)
