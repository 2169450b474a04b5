# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The floor of a moment as the ball task needs it: ways around pillars and ball, kicks, vantage points."""

from typing import List, Optional

import numpy as np
from scipy.ndimage import binary_dilation, uniform_filter

from sextant.ball.ball_task_params import BallTaskParams
from sextant.ball.goal import Goal
from sextant.ball.kick_plan import Kick, KickPlanner
from sextant.ball.path_planner import MARGIN, Disc, FreeFloor
from sextant.ball.task_view import TaskView

TIGHT = 0.02  # metres of clearance, where there is no way with more
FRONTIER_REACH = 0.6  # metres about a place in which frontiers count
FRONTIER_NEAR = 0.5  # metres; what is nearer was looked at from here
BUMPER = 1.0  # radians to both sides, in which the robot may have come up against something
BEFORE_BUMPER = 0.05  # metres that what it came up against is thick, and that a map may err


class BallFloor:
    """Built for one view."""

    def __init__(self, params: BallTaskParams, view: TaskView, about: List[np.ndarray], clearance: float):
        """:param about: places (2,) that have to be on it, metres, map"""
        self._params, self._view = params, view
        self.discs = [Disc(*each.position, params.pillar_radius) for each in view.pillars]
        self._about = np.array([view.pose[:2], *about])
        self._clearance = params.kick.robot_radius + clearance
        discs = list(self.discs)
        if view.ball is not None:
            discs.append(Disc(*view.ball.position, params.kick.ball_radius))
        self.with_ball = self._floor(discs)

    def _floor(self, discs: List[Disc]) -> FreeFloor:
        margin = max(MARGIN, self._params.kick.run_up + self._clearance)
        floor = FreeFloor(self._view.grid, discs, self._clearance, self._about, margin)
        return floor.with_escape(self._view.pose[:2])

    def path(self, end: np.ndarray) -> Optional[np.ndarray]:
        """(n, 2) corners of the robot's way to a place, around the ball, too; None: there is none."""
        return self.with_ball.path(self._view.pose[:2], end)

    def kick(self, goal: Goal, before: Optional[Kick]) -> Optional[Kick]:
        """The best kick of the ball, which is seen; None: there is none."""
        costs, _ = self.with_ball.costs(self._view.pose[:2])
        without_ball = self._floor(self.discs)
        planner = KickPlanner(self._params.kick, goal, self.discs, without_ball, costs)
        return planner.plan(self._view.ball.position, before)

    def vantage(self) -> Optional[np.ndarray]:
        """(2,) a place beside what was not seen yet, near, with much of it (Yamauchi 1997, "A frontier-based
        approach for autonomous exploration"); None: there is none that can be reached."""
        floor = self.with_ball
        costs, _ = floor.costs(self._view.pose[:2])
        frontier = floor.is_seen & binary_dilation(~floor.is_seen) & (floor.distance > 0.0)
        cells = max(1, round(FRONTIER_REACH / self._view.grid.params.cell))
        much = uniform_filter(frontier.astype(float), 2 * cells + 1, mode="constant")
        is_far = np.hypot(*np.moveaxis(floor.at - self._view.pose[:2], -1, 0)) > FRONTIER_NEAR
        value = np.where(np.isfinite(costs) & is_far & floor.is_seen, much / (1.0 + costs), 0.0)
        best = np.unravel_index(int(np.argmax(value)), value.shape)
        return floor.at[best] if value[best] > 0.0 else None


def mark_bump(params: BallTaskParams, view: TaskView, sense: float) -> None:
    """The robot came up against something, which is put into the grid unless it is a pillar that is known.

    :param sense: 1: it drove forward, -1: back
    """
    place, reach = view.pose[:2], params.kick.robot_radius + BEFORE_BUMPER
    turns = view.pose[2] + np.linspace(-BUMPER, BUMPER, 11)
    edge = place + sense * reach * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    to_pillars = [np.linalg.norm(edge - each.position, axis=1).min() for each in view.pillars]
    if min(to_pillars, default=np.inf) > params.pillar_radius + BEFORE_BUMPER:
        view.grid.mark(edge)


def way_to(params: BallTaskParams, view: TaskView, end: np.ndarray) -> Optional[np.ndarray]:
    """The robot's way to a place with as much clearance as it should have, else with less; None: none."""
    for clearance in (params.clearance, TIGHT):
        path = BallFloor(params, view, [end], clearance).path(end)
        if path is not None:
            return path
    return None
