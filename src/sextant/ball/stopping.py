# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Drive in front of the goal and stop there."""

import math
from typing import Optional

import numpy as np

from sextant.ball.ball_task_params import BallTaskParams
from sextant.ball.goal import Goal
from sextant.ball.path_follower import HALT, bearing_of, follow, turn_on_the_spot
from sextant.ball.task_planner import MIN_CLEARANCE, TaskPlanner, path_to
from sextant.ball.task_view import Step, TaskView

REPLAN = 0.5  # seconds
FINAL_DISTANCE = 0.35  # metres to the stop within which the robot drives straight, forward or back
STOP_TOLERANCE = 0.01  # metres
FACING = 0.25  # radians
GAIN = 2.0  # 1/s
MAX_SPEED, MIN_SPEED = 0.15, 0.03  # m/s
CANDIDATES = 9  # candidate stop positions in front of the goal line


class Stopping:
    """Drives until the robot's front is stop_distance before the goal line."""

    def __init__(self, params: BallTaskParams):
        self._params = params
        self._place: Optional[np.ndarray] = None
        self._path, self._planned = None, -math.inf
        self._is_free, self._looked = False, -math.inf

    def step(self, view: TaskView, goal: Goal) -> Step:
        """One step, until the robot stands there."""
        rest = (
            goal.distance_before(view.pose[:2]) - self._params.kick.robot_radius - self._params.stop_distance
        )
        is_between = abs(goal.lateral_offset(view.pose[:2])) < 0.5 * goal.width - self._params.pillar_radius
        if is_between and abs(rest) <= STOP_TOLERANCE:
            return Step(HALT, "done", "the ball is through, the robot stands before the goal")
        if is_between and abs(rest) < FINAL_DISTANCE and self._is_straight_free(view, goal, rest):
            return self._straight(view, goal, rest)
        return self._drive(view, goal)

    def _straight(self, view: TaskView, goal: Goal, rest: float) -> Step:
        turn = bearing_of(view.pose, view.pose[:2] - goal.normal)
        if abs(turn) > FACING:
            return Step((0.0, turn_on_the_spot(self._params.follower, turn)))
        speed = math.copysign(min(MAX_SPEED, max(MIN_SPEED, GAIN * abs(rest))), rest)
        return Step((speed, float(np.clip(turn, -0.5, 0.5))))

    def _is_straight_free(self, view: TaskView, goal: Goal, rest: float) -> bool:
        if view.stamp - self._looked > REPLAN:
            self._looked, here = view.stamp, view.pose[:2]
            floor = TaskPlanner(self._params, view, [goal.middle], MIN_CLEARANCE).with_ball
            self._is_free = floor.is_line_free(here, here - rest * goal.normal)
        return self._is_free

    def _drive(self, view: TaskView, goal: Goal) -> Step:
        if view.stamp - self._planned > REPLAN:
            self._planned = view.stamp
            self._place = self._stop_place(view, goal)
            self._path = None if self._place is None else path_to(self._params, view, self._place)
        if self._path is None:
            return Step(HALT, "blocked", "no path to the front of the goal")
        return Step(follow(self._params.follower, view.pose, self._path), path=self._path)

    def _stop_place(self, view: TaskView, goal: Goal) -> Optional[np.ndarray]:
        """Stop position (2,) closest to the goal's axis that is free."""
        params = self._params
        floor = TaskPlanner(params, view, [goal.middle], MIN_CLEARANCE)
        far = params.kick.robot_radius + params.stop_distance
        along = (goal.posts[1] - goal.posts[0]) / goal.width
        half = 0.5 * goal.width - params.pillar_radius - 0.05
        places = [
            goal.middle + far * goal.normal + off * along
            for off in sorted(np.linspace(-half, half, CANDIDATES), key=abs)
        ]
        return next((place for place in places if floor.with_ball.is_free_at(place)), None)
