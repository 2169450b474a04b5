# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Worlds of the ball task, drawn at random within its rules.

The robot shall bring the ball between the two blue pillars of the goal and stop before their line.
Task 2: the ball lies 0.5 to 1.5 m before the goal, at most 0.15 m off its axis; pillars stand only behind it.
Task 3: up to 2 m and 0.3 m, and up to two pillars before the goal, so that a way 0.6 m wide leads to it.
The robot starts 0.7 to 2.5 m from the ball, looking anywhere, and can drive round to the ball's other side.
"""

from dataclasses import dataclass
from typing import List, NamedTuple, Optional, Tuple

import numpy as np
from scipy.ndimage import label

from sextant.geometry.plane_poses import rotation
from sextant.objects.object_kinds import GOAL, KINDS
from sextant.simulation.ball_ground import Pillar

OTHERS = tuple(name for name, kind in KINDS.items() if kind.shape == "pillar" and name != GOAL)
CELL = 0.05  # metres, of the grids in which ways are sought


@dataclass(frozen=True)
class TaskRules:
    """What a task allows. Lengths in metres, between middles and axes; (least, most)."""

    ball: Tuple[float, float] = (0.5, 1.5)  # before the goal's line
    aside: float = 0.15  # of the ball from the goal's axis, at most
    goal: Tuple[float, float] = (0.7, 1.2)  # from one of its pillars to the other
    start: Tuple[float, float] = (0.7, 2.5)  # of the robot from the ball
    obstacles: int = 0  # pillars before the goal, at most
    before: Tuple[float, float] = (0.35, 2.0)  # of them, before the line
    behind: int = 4  # pillars behind the goal, at most
    after: Tuple[float, float] = (0.3, 2.0)  # of them, behind the line
    blue_after: float = 0.4  # of blue ones, at least: the goal is the nearer pair
    way: float = 0.6  # width of the ball's way between pillars and walls
    clearance: float = 0.25  # that the robot's middle keeps from pillars' axes, walls and the ball
    run_up: float = 0.5  # of the place behind the ball, seen from the goal, that the robot can come to
    around_ball: float = 0.4  # without pillars
    around_robot: float = 0.35  # without pillars, at the start
    apart: float = 0.2  # of two pillars, at least
    wall: float = 0.6  # from pillars, ball and start to the walls, at least
    size: Tuple[float, float] = (7.0, 6.0)  # of the room


TASKS = {2: TaskRules(), 3: TaskRules(ball=(0.5, 2.0), aside=0.3, obstacles=2)}


class BallWorld(NamedTuple):
    """Where everything is at the start, in the map."""

    size: Tuple[float, float]  # of the room, metres, its middle in the origin
    pillars: List[Pillar]  # the first two are the goal
    ball: np.ndarray  # (2,)
    robot: np.ndarray  # (3,) x, y, yaw


def drawn_world(task: int, seed: int, obstacles: Optional[int] = None) -> BallWorld:
    """The same world for the same seed.

    :param task: of TASKS
    :param obstacles: pillars before the goal; None: as many as come, within the task's rules
    :raises ValueError: there is no such task, or it has not so many obstacles
    """
    if task not in TASKS:
        raise ValueError(f"task is {task}, allowed is one of {sorted(TASKS)}")
    rules = TASKS[task]
    if obstacles is not None and not 0 <= obstacles <= rules.obstacles:
        raise ValueError(f"obstacles is {obstacles}, allowed is [0, {rules.obstacles}] in task {task}")
    random = np.random.default_rng([seed, task])
    while True:
        world = _Draft(rules, random, obstacles).world()
        if world is not None:
            return world


class _Draft:
    """A world that may be none. The goal's frame: its middle, x toward the ball along its axis."""

    def __init__(self, rules: TaskRules, random: np.random.Generator, obstacles: Optional[int]):
        self._rules, self._random = rules, random
        half = 0.5 * np.array(rules.size) - rules.wall
        self._goal = np.array([*random.uniform(-half, half), random.uniform(-np.pi, np.pi)])  # in the map
        width = random.uniform(*rules.goal)
        self._ball = np.array([random.uniform(*rules.ball), random.uniform(-rules.aside, rules.aside)])
        turn = random.uniform(-np.pi, np.pi)
        self._robot = self._ball + random.uniform(*rules.start) * np.array([np.cos(turn), np.sin(turn)])
        self._pillars = np.array([[0.0, 0.5 * width], [0.0, -0.5 * width]])
        self._classes = [GOAL, GOAL]
        drawn = random.integers(0, rules.obstacles + 1)
        for _ in range(drawn if obstacles is None else obstacles):
            self._add(random.choice(OTHERS), random.uniform(*rules.before), 0.8)
        for _ in range(random.integers(0, rules.behind + 1)):
            name, (least, most) = random.choice([GOAL, *OTHERS]), rules.after
            self._add(name, -random.uniform(rules.blue_after if name == GOAL else least, most), 1.5)

    def world(self) -> Optional[BallWorld]:
        """None: it is not within the rules."""
        if not (self._is_inside() and self._has_room() and self._ball_has_way() and self._robot_has_way()):
            return None
        pillars = [
            Pillar(*map(float, at), KINDS[name].radius, name)
            for at, name in zip(self._in_map(self._pillars), self._classes)
        ]
        ball, robot = self._in_map(np.array([self._ball, self._robot]))
        yaw = self._random.uniform(-np.pi, np.pi)
        return BallWorld(self._rules.size, pillars, ball, np.array([*robot, yaw]))

    def _add(self, class_name: str, x: float, aside: float) -> None:
        y = self._random.uniform(-aside, aside)
        self._pillars = np.vstack([self._pillars, [x, y]])
        self._classes.append(str(class_name))

    def _in_map(self, points: np.ndarray) -> np.ndarray:
        return points @ rotation(self._goal[2]).T + self._goal[:2]

    def _to_walls(self, points: np.ndarray) -> np.ndarray:
        """(...) metres to the nearest wall, of points (..., 2)."""
        return np.min(0.5 * np.array(self._rules.size) - abs(self._in_map(points)), axis=-1)

    def _is_inside(self) -> bool:
        return bool(
            self._to_walls(np.vstack([self._pillars, self._ball, self._robot])).min() >= self._rules.wall
        )

    def _has_room(self) -> bool:
        """Whether the robot touches nothing, the ball is by itself, and no two pillars touch."""
        rules, at = self._rules, self._pillars
        apart = np.linalg.norm(at[:, np.newaxis] - at, axis=2)[np.triu_indices(len(at), 1)]
        to_robot, to_ball = (np.linalg.norm(at - each, axis=1) for each in (self._robot, self._ball))
        return bool(
            apart.min() >= rules.apart
            and to_robot.min() >= rules.around_robot
            and to_ball.min() >= rules.around_ball
        )

    def _ball_has_way(self) -> bool:
        """To the goal's line."""
        half = 0.5 * self._rules.way
        return self._leads(self._ball, np.zeros(2), self._pillars, half + KINDS[GOAL].radius, half)

    def _robot_has_way(self) -> bool:
        """Round the ball, to a place from which it can be driven toward the goal."""
        keeps = self._rules.clearance
        behind = self._ball * (1.0 + self._rules.run_up / np.hypot(*self._ball))
        return self._leads(self._robot, behind, np.vstack([self._pillars, self._ball]), keeps, keeps)

    def _leads(
        self, start: np.ndarray, end: np.ndarray, discs: np.ndarray, keeps: float, to_wall: float
    ) -> bool:
        """Whether a way leads there that keeps so far from the middles of discs and from walls."""
        low, high = np.minimum(start, end) - 2.0, np.maximum(start, end) + 2.0
        first = np.floor(low / CELL)  # the axis of the goal is on the grid
        axes = [CELL * np.arange(first[axis], high[axis] / CELL) for axis in range(2)]
        grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
        if not self._is_free(np.array([start, end]), discs, keeps, to_wall).all():
            return False
        parts = label(self._is_free(grid, discs, keeps, to_wall))[0]
        here, there = (parts[tuple(np.rint(at / CELL - first).astype(int))] for at in (start, end))
        return bool(here and here == there)

    def _is_free(self, points: np.ndarray, discs: np.ndarray, keeps: float, to_wall: float) -> np.ndarray:
        """(...) whether points (..., 2) keep so far from the middles of discs and from walls."""
        free = self._to_walls(points) >= to_wall
        for disc in discs:
            free &= np.hypot(*np.moveaxis(points - disc, -1, 0)) >= keeps - 1e-9
        return free
