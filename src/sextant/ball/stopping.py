# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Drives before the goal, and stops there."""

import math
from typing import Optional

import numpy as np

from sextant.ball.ball_floor import TIGHT, BallFloor, way_to
from sextant.ball.ball_task_params import BallTaskParams
from sextant.ball.goal import Goal
from sextant.ball.path_follower import HALT, PathFollower, bearing_of
from sextant.ball.task_view import Step, TaskView

REPLAN = 0.5  # seconds
FINAL = 0.35  # metres from where the robot only goes straight, and from which it goes back straight, too
AT_STOP = 0.01  # metres
FACING = 0.25  # radians
GAIN = 2.0  # 1/s
SLOW, SLOWEST = 0.15, 0.03  # m/s
PLACES = 9  # on the line of places to stop at that are tried


class Stopping:
    """To a place with the robot's foremost point so far from the goal's line."""

    def __init__(self, params: BallTaskParams):
        self._params, self._follower = params, PathFollower(params.follower)
        self._place: Optional[np.ndarray] = None
        self._path, self._planned = None, -math.inf
        self._is_free, self._looked = False, -math.inf

    def step(self, view: TaskView, goal: Goal) -> Step:
        """Until it stands there."""
        rest = goal.before(view.pose[:2]) - self._params.kick.robot_radius - self._params.stop_distance
        is_between = abs(goal.aside(view.pose[:2])) < 0.5 * goal.width - self._params.pillar_radius
        if is_between and abs(rest) <= AT_STOP:
            return Step(HALT, "done", "the ball is through, the robot stands before the goal")
        if is_between and abs(rest) < FINAL and self._is_straight_free(view, goal, rest):
            return self._straight(view, goal, rest)
        return self._drive(view, goal)

    def _straight(self, view: TaskView, goal: Goal, rest: float) -> Step:
        turn = bearing_of(view.pose, view.pose[:2] - goal.out)
        if abs(turn) > FACING:
            return Step((0.0, self._follower.turn(turn)))
        speed = math.copysign(min(SLOW, max(SLOWEST, GAIN * abs(rest))), rest)
        return Step((speed, float(np.clip(turn, -0.5, 0.5))))

    def _is_straight_free(self, view: TaskView, goal: Goal, rest: float) -> bool:
        if view.stamp - self._looked > REPLAN:
            self._looked, here = view.stamp, view.pose[:2]
            floor = BallFloor(self._params, view, [goal.middle], TIGHT).with_ball
            self._is_free = floor.allows_line(here, here - rest * goal.out)
        return self._is_free

    def _drive(self, view: TaskView, goal: Goal) -> Step:
        if view.stamp - self._planned > REPLAN:
            self._planned = view.stamp
            self._place = self._stop_place(view, goal)
            self._path = None if self._place is None else way_to(self._params, view, self._place)
        if self._path is None:
            return Step(HALT, "blocked", "there is no way to before the goal")
        return Step(self._follower.follow(view.pose, self._path), path=self._path)

    def _stop_place(self, view: TaskView, goal: Goal) -> Optional[np.ndarray]:
        """Before the goal's middle, or aside where that is not free."""
        params = self._params
        floor = BallFloor(params, view, [goal.middle], TIGHT)
        far = params.kick.robot_radius + params.stop_distance
        along = (goal.posts[1] - goal.posts[0]) / goal.width
        half = 0.5 * goal.width - params.pillar_radius - 0.05
        places = [
            goal.middle + far * goal.out + off * along
            for off in sorted(np.linspace(-half, half, PLACES), key=abs)
        ]
        return next((place for place in places if floor.with_ball.allows(place)), None)
