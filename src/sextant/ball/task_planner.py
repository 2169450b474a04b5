# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Paths, kicks and vantage points for the present state of the world."""

from typing import List, Optional

import numpy as np
from scipy.ndimage import binary_dilation, uniform_filter

from sextant.ball.ball_task_params import BallTaskParams
from sextant.ball.goal import Goal
from sextant.ball.kick_plan import Kick, KickPlanner
from sextant.ball.path_planner import MARGIN, Costmap, Disc
from sextant.ball.task_view import TaskView

MIN_CLEARANCE = 0.02  # metres, where no path has more
FRONTIER_RADIUS = 0.6  # metres around a vantage point in which frontier cells count
MIN_FRONTIER_DISTANCE = 0.5  # metres; closer frontiers were observed from here
BUMPER_ANGLE = 1.0  # radians to both sides that the bumper covers
OBSTACLE_DEPTH = 0.05  # metres beyond the bumper marked as occupied; also the map's error


class TaskPlanner:
    """Plans for one view of the world."""

    def __init__(self, params: BallTaskParams, view: TaskView, about: List[np.ndarray], clearance: float):
        """:param about: points (2,) that the costmap contains, metres, map

        :param clearance: between the robot's edge and obstacles, metres
        """
        self._params, self._view = params, view
        self.discs = [Disc(*each.position, params.pillar_radius) for each in view.pillars]
        self._about = np.array([view.pose[:2], *about])
        self._clearance = params.kick.robot_radius + clearance
        discs = list(self.discs)
        if view.ball is not None:
            discs.append(Disc(*view.ball.position, params.kick.ball_radius))
        self.with_ball = self._costmap(discs)

    def _costmap(self, discs: List[Disc]) -> Costmap:
        margin = max(MARGIN, self._params.kick.run_up + self._clearance)
        costmap = Costmap(self._view.grid, discs, self._clearance, self._about, margin)
        return costmap.with_escape(self._view.pose[:2])

    def path(self, end: np.ndarray) -> Optional[np.ndarray]:
        """Corners (n, 2) of the robot's path to a point, also around the ball; None: no path."""
        return self.with_ball.path(self._view.pose[:2], end)

    def kick(self, goal: Goal, previous: Optional[Kick]) -> Optional[Kick]:
        """The best kick of the ball, which must be known; None: no kick.

        :param previous: the previous plan; None: none
        """
        costs, _ = self.with_ball.costs(self._view.pose[:2])
        without_ball = self._costmap(self.discs)
        planner = KickPlanner(self._params.kick, goal, self.discs, without_ball, costs)
        return planner.plan(self._view.ball.position, previous)

    def vantage(self) -> Optional[np.ndarray]:
        """A point (2,) close to many frontier cells (Yamauchi 1997, "A frontier-based approach for autonomous
        exploration"); None: no frontier can be reached."""
        costmap = self.with_ball
        costs, _ = costmap.costs(self._view.pose[:2])
        frontier = costmap.is_seen & binary_dilation(~costmap.is_seen) & (costmap.distance > 0.0)
        cells = max(1, round(FRONTIER_RADIUS / self._view.grid.params.resolution))
        size = uniform_filter(frontier.astype(float), 2 * cells + 1, mode="constant")
        is_far = np.hypot(*np.moveaxis(costmap.at - self._view.pose[:2], -1, 0)) > MIN_FRONTIER_DISTANCE
        value = np.where(np.isfinite(costs) & is_far & costmap.is_seen, size / (1.0 + costs), 0.0)
        best = np.unravel_index(int(np.argmax(value)), value.shape)
        return costmap.at[best] if value[best] > 0.0 else None


def mark_bump(params: BallTaskParams, view: TaskView, sense: float) -> None:
    """Mark the obstacle that the robot bumped into in the grid, unless it is a known pillar.

    :param sense: 1: the robot drove forward, -1: backward
    """
    place, reach = view.pose[:2], params.kick.robot_radius + OBSTACLE_DEPTH
    turns = view.pose[2] + np.linspace(-BUMPER_ANGLE, BUMPER_ANGLE, 11)
    edge = place + sense * reach * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    to_pillars = [np.linalg.norm(edge - each.position, axis=1).min() for each in view.pillars]
    if min(to_pillars, default=np.inf) > params.pillar_radius + OBSTACLE_DEPTH:
        view.grid.mark(edge)


def path_to(params: BallTaskParams, view: TaskView, end: np.ndarray) -> Optional[np.ndarray]:
    """The robot's path to a point with full clearance, else with the minimum; None: no path."""
    for clearance in (params.clearance, MIN_CLEARANCE):
        path = TaskPlanner(params, view, [end], clearance).path(end)
        if path is not None:
            return path
    return None
