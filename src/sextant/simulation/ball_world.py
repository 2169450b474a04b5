# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Random worlds of the ball task within its rules.

The robot kicks the ball between the two blue pillars of the goal and stops in front of the goal line.
Task 2: the ball lies 0.5 to 1.5 m in front of the goal, up to 0.15 m off the goal's axis; all other pillars
are behind the goal. Task 3: the ball lies up to 2 m in front and 0.3 m off; up to two pillars in front of the
goal leave a path 0.6 m wide.
The robot starts 0.7 to 2.5 m from the ball with any heading, and can drive around the ball.
"""

from dataclasses import dataclass
from typing import List, NamedTuple, Optional, Tuple

import numpy as np
from scipy.ndimage import label

from sextant.geometry.plane_poses import rotation
from sextant.objects.object_kinds import GOAL, KINDS
from sextant.simulation.ball_ground import Pillar

OTHERS = tuple(name for name, kind in KINDS.items() if kind.shape == "pillar" and name != GOAL)
# Of obstacles without a class: offset from the goal's axis, distance in front of the goal line, metres
STRAY_ASIDE, STRAY_AHEAD = (0.6, 2.0), (-1.0, 2.5)
STRAYS = 4  # their number in a hard world
CELL = 0.05  # cell size of the grids for path checks, metres


@dataclass(frozen=True)
class TaskRules:
    """Rules of a task. Lengths in metres between centres and axes; ranges are (minimum, maximum)."""

    ball: Tuple[float, float] = (0.5, 1.5)  # distance of the ball in front of the goal line
    aside: float = 0.15  # maximum offset of the ball from the goal's axis
    goal: Tuple[float, float] = (0.7, 1.2)  # width of the goal
    start: Tuple[float, float] = (0.7, 2.5)  # distance from the robot to the ball
    obstacles: int = 0  # maximum number of pillars in front of the goal
    before: Tuple[float, float] = (0.35, 2.0)  # distance of pillars in front of the goal line to it
    behind: int = 4  # maximum number of pillars behind the goal
    after: Tuple[float, float] = (0.3, 2.0)  # distance of pillars behind the goal line to it
    blue_after: float = 0.4  # minimum distance of blue pillars behind the line: the goal is the nearer pair
    path_width: float = 0.6  # width of the ball's path between pillars and walls
    clearance: float = 0.25  # minimum distance of the robot's centre to pillars' axes, walls and the ball
    run_up: float = 0.5  # distance behind the ball, seen from the goal, that the robot can reach
    around_ball: float = 0.4  # radius around the ball without pillars
    around_robot: float = 0.35  # radius around the robot's start without pillars
    apart: float = 0.2  # minimum distance of two pillars
    wall: float = 0.6  # minimum distance of pillars, ball and start to the walls
    size: Tuple[float, float] = (7.0, 6.0)  # of the room


TASKS = {2: TaskRules(), 3: TaskRules(ball=(0.5, 2.0), aside=0.3, obstacles=2)}


class BallWorld(NamedTuple):
    """Initial positions in the map."""

    size: Tuple[float, float]  # of the room, metres; centred on the origin
    pillars: List[Pillar]  # the first two are the goal
    ball: np.ndarray  # (2,) metres
    robot: np.ndarray  # (3,) x, y, yaw, metres and radians
    strays: np.ndarray = np.zeros((0, 2))  # positions of small obstacles without a class, metres


def random_world(task: int, seed: int, obstacles: Optional[int] = None, strays: int = 0) -> BallWorld:
    """Draws a world; the same arguments give the same world.

    :param task: a key of TASKS
    :param obstacles: number of pillars in front of the goal; None: random within the rules
    :param strays: number of small obstacles without a class beside the ball's path
    :raises ValueError: unknown task, or too many obstacles for it
    """
    if task not in TASKS:
        raise ValueError(f"task is {task}, allowed is one of {sorted(TASKS)}")
    rules = TASKS[task]
    if obstacles is not None and not 0 <= obstacles <= rules.obstacles:
        raise ValueError(f"obstacles is {obstacles}, allowed is [0, {rules.obstacles}] in task {task}")
    random = np.random.default_rng([seed, task])
    while True:
        world = _Draft(rules, random, obstacles, strays).world()
        if world is not None:
            return world


class _Draft:
    """A random draft, which may violate the rules. Goal frame: x from the goal's middle toward the ball."""

    def __init__(self, rules: TaskRules, random: np.random.Generator, obstacles: Optional[int], strays: int):
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
            name, (nearest, farthest) = random.choice([GOAL, *OTHERS]), rules.after
            self._add(name, -random.uniform(rules.blue_after if name == GOAL else nearest, farthest), 1.5)
        for _ in range(strays):
            aside = random.choice([-1.0, 1.0]) * random.uniform(*STRAY_ASIDE)
            self._pillars = np.vstack([self._pillars, [random.uniform(*STRAY_AHEAD), aside]])

    def world(self) -> Optional[BallWorld]:
        """The world in the map; None: the draft violates the rules."""
        if not (self._is_inside() and self._has_room() and self._ball_has_path() and self._robot_has_path()):
            return None
        places = self._in_map(self._pillars)
        pillars = [
            Pillar(*map(float, at), KINDS[name].radius, name) for at, name in zip(places, self._classes)
        ]
        ball, robot = self._in_map(np.array([self._ball, self._robot]))
        yaw = self._random.uniform(-np.pi, np.pi)
        return BallWorld(self._rules.size, pillars, ball, np.array([*robot, yaw]), places[len(pillars) :])

    def _add(self, class_name: str, x: float, aside: float) -> None:
        """Adds a pillar at x with a random offset of at most aside from the goal's axis."""
        y = self._random.uniform(-aside, aside)
        self._pillars = np.vstack([self._pillars, [x, y]])
        self._classes.append(str(class_name))

    def _in_map(self, points: np.ndarray) -> np.ndarray:
        return points @ rotation(self._goal[2]).T + self._goal[:2]

    def _to_walls(self, points: np.ndarray) -> np.ndarray:
        """Distances (...) of points (..., 2) to the nearest wall, metres."""
        return np.min(0.5 * np.array(self._rules.size) - abs(self._in_map(points)), axis=-1)

    def _is_inside(self) -> bool:
        """Whether robot, ball and pillars keep their distance to the walls."""
        return bool(
            self._to_walls(np.vstack([self._pillars, self._ball, self._robot])).min() >= self._rules.wall
        )

    def _has_room(self) -> bool:
        """Whether robot, ball and pillars keep their distances to each other."""
        rules, at = self._rules, self._pillars
        apart = np.linalg.norm(at[:, np.newaxis] - at, axis=2)[np.triu_indices(len(at), 1)]
        to_robot, to_ball = (np.linalg.norm(at - each, axis=1) for each in (self._robot, self._ball))
        return bool(
            apart.min() >= rules.apart
            and to_robot.min() >= rules.around_robot
            and to_ball.min() >= rules.around_ball
        )

    def _ball_has_path(self) -> bool:
        """Whether a path for the ball leads to the goal line."""
        half = 0.5 * self._rules.path_width
        return self._is_connected(self._ball, np.zeros(2), self._pillars, half + KINDS[GOAL].radius, half)

    def _robot_has_path(self) -> bool:
        """Whether a path for the robot leads behind the ball."""
        to_disc = self._rules.clearance
        behind = self._ball * (1.0 + self._rules.run_up / np.hypot(*self._ball))
        discs = np.vstack([self._pillars, self._ball])
        return self._is_connected(self._robot, behind, discs, to_disc, to_disc)

    def _is_connected(
        self, start: np.ndarray, end: np.ndarray, discs: np.ndarray, to_disc: float, to_wall: float
    ) -> bool:
        """Whether a path leads from start to end that to_disc these distances from disc centres and walls."""
        low, high = np.minimum(start, end) - 2.0, np.maximum(start, end) + 2.0
        first = np.floor(low / CELL)  # the goal's axis is on the grid
        axes = [CELL * np.arange(first[axis], high[axis] / CELL) for axis in range(2)]
        grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
        if not self._is_free(np.array([start, end]), discs, to_disc, to_wall).all():
            return False
        parts = label(self._is_free(grid, discs, to_disc, to_wall))[0]
        here, there = (parts[tuple(np.rint(at / CELL - first).astype(int))] for at in (start, end))
        return bool(here and here == there)

    def _is_free(self, points: np.ndarray, discs: np.ndarray, to_disc: float, to_wall: float) -> np.ndarray:
        """Whether points (..., 2) keep these distances from the centres of discs and from walls."""
        free = self._to_walls(points) >= to_wall
        for disc in discs:
            free &= np.hypot(*np.moveaxis(points - disc, -1, 0)) >= to_disc - 1e-9
        return free
