# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plays the ball task on a BallGround: the robot receives noisy ground truth of what is in its view."""

from typing import Callable, List, NamedTuple, Optional

import numpy as np

from sextant.ball.ball_task import BallTask
from sextant.ball.ball_task_params import BallTaskParams
from sextant.ball.floor_grid import FloorGrid, FloorGridParams
from sextant.ball.task_view import Action, SeenBall, SeenPillar, TaskView
from sextant.simulation.ball_ground import BallGround, RobotParams
from sextant.simulation.ball_world import BallWorld
from sextant.simulation.odometry import OdometryNoise

TICK = 0.05  # seconds from one odometry to the next; every second one comes with an image
AHEAD = 0.1  # metres from the robot's middle to its camera
HALF_VIEW = 0.47  # radians
NEAREST, FARTHEST, DEEPEST = 0.36, 5.0, 3.0  # metres from the camera: objects, and depth
MISSED = 8  # images with the ball in view but not detected, after which it is deleted
STEADY = RobotParams(slip=0.0, noise=OdometryNoise(0.0, 0.0, 0.0))
HELD = RobotParams(max_speed=1e-3)  # wheels that turn the robot, and hardly move it


class Played(NamedTuple):
    """A task that came to its end, or did not."""

    world: BallWorld
    ground: BallGround
    action: Action  # the last
    states: List[str]  # each that another followed
    reasons: List[str]
    is_through: bool  # the ball's middle crossed the line between the first two pillars

    @property
    def front(self) -> float:
        """Metres from the goal's line to the robot's foremost point."""
        left, right = (np.array(pillar[:2]) for pillar in self.world.pillars[:2])
        robot = np.array([self.ground.robot.x, self.ground.robot.y])
        side = np.sign(cross(right - left, np.array(self.world.ball) - left))
        return side * cross(right - left, robot - left) / np.linalg.norm(right - left) - 0.177

    @property
    def pillar_touches(self) -> int:
        return sum(touch.what == "pillar" for touch in self.ground.touches)


def cross(a: np.ndarray, b: np.ndarray) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def crosses(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> bool:
    """Whether the line from a to b crosses that from c to d."""
    return (
        cross(b - a, c - a) * cross(b - a, d - a) < 0.0 and cross(d - c, a - c) * cross(d - c, b - c) <= 0.0
    )


def goes_in(world: BallWorld, before: Optional[np.ndarray], now: Optional[np.ndarray]) -> bool:
    """Whether the ball went between the posts."""
    posts = [np.array(pillar[:2]) for pillar in world.pillars[:2]]
    return before is not None and now is not None and len(posts) == 2 and crosses(before, now, *posts)


class Eyes:
    """Of the robot: map, tracker and depth camera. noise: 0 for the truth."""

    def __init__(self, ground: BallGround, noise: float, seed: int):
        self._ground, self._noise, self._random = ground, noise, np.random.default_rng([seed, 11])
        self._observations: List[List[np.ndarray]] = [[] for _ in ground.pillars]
        self._ball: Optional[SeenBall] = None
        self._missed = 0
        self.grid = FloorGrid(FloorGridParams())

    def look(self) -> None:
        """One image."""
        for pillar, observations in zip(self._ground.pillars, self._observations):
            away = self._distance_in_view(np.array(pillar[:2]))
            if away is not None:
                observations.append(np.array(pillar[:2]) + self._deviation(0.008 * away))
        self._look_for_ball()
        self.grid.update(self._points(), self._pose)

    def view(self) -> TaskView:
        """What is known by now."""
        pillars = [
            SeenPillar(pillar.class_name, np.mean(observations[-20:], axis=0))
            for pillar, observations in zip(self._ground.pillars, self._observations)
            if len(observations) >= 2
        ]
        return TaskView(
            self._ground.stamp, self._pose, pillars, self._ball, self._ground.is_bumped, self.grid
        )

    @property
    def _pose(self) -> np.ndarray:
        robot = self._ground.robot
        return np.array([robot.x, robot.y, robot.yaw])

    def _deviation(self, sigma: float) -> np.ndarray:
        return self._noise * self._random.normal(0.0, sigma, 2)

    def _local(self, points: np.ndarray) -> np.ndarray:
        """From the camera: ahead and to the left."""
        x, y, yaw = self._pose
        c, s = np.cos(yaw), np.sin(yaw)
        return (np.asarray(points) - [x, y]) @ np.array([[c, -s], [s, c]]) - [AHEAD, 0.0]

    def _distance_in_view(self, point: np.ndarray) -> Optional[float]:
        x, y = self._local(point)
        away = float(np.hypot(x, y))
        return away if x > NEAREST and abs(np.arctan2(y, x)) < HALF_VIEW and away < FARTHEST else None

    def _look_for_ball(self) -> None:
        ground = self._ground
        if ground.ball is not None and self._distance_in_view(ground.ball) is not None:
            velocity = ground.ball_velocity + self._deviation(0.02)
            self._ball = SeenBall(ground.ball + self._deviation(0.006), velocity, ground.stamp)
            self._missed = 0
        elif self._ball is not None:
            self._ball = self._ball._replace(velocity=np.zeros(2))
            self._missed += self._distance_in_view(self._ball.position) is not None
            if self._missed >= MISSED:
                self._ball = None

    def _points(self) -> np.ndarray:
        """(n, 3) of floor, walls and pillars, in the robot frame; too near to them there is nothing."""
        angles = np.linspace(-0.6, 0.6, 60)
        rays = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        hits = np.full(len(rays), DEEPEST)
        for pillar in self._ground.pillars:
            at = self._local(np.array(pillar[:2]))
            along, aside = rays @ at, rays[:, 0] * at[1] - rays[:, 1] * at[0]
            hit = along - np.sqrt(np.maximum(pillar.radius**2 - aside**2, 0.0))
            hits = np.where((abs(aside) < pillar.radius) & (along > 0.0), np.minimum(hits, hit), hits)
        turn = self._pose[2] + angles
        camera = self._pose[:2] + AHEAD * np.array([np.cos(self._pose[2]), np.sin(self._pose[2])])
        for axis, toward in enumerate((np.cos(turn), np.sin(turn))):
            safe = np.where(abs(toward) < 1e-6, 1e-6, toward)
            hits = np.minimum(hits, (np.sign(safe) * self._ground.half[axis] - camera[axis]) / safe)
        ranges = np.arange(NEAREST - 0.06, DEEPEST, 0.04)
        floor = (ranges < hits[:, np.newaxis]) & (hits[:, np.newaxis] > NEAREST)
        ray, at = np.nonzero(floor)
        ground = np.column_stack([rays[ray] * ranges[at, np.newaxis] + [AHEAD, 0.0], np.zeros(len(at))])
        stands = (hits > NEAREST) & (hits < DEEPEST)
        upright = np.column_stack([rays * hits[:, np.newaxis] + [AHEAD, 0.0], np.full(len(hits), 0.3)])[
            stands
        ]
        return np.concatenate([ground, upright, upright])


def play(
    world: BallWorld,
    params: Optional[BallTaskParams] = None,
    noise: float = 1.0,
    seed: int = 0,
    drive: Optional[RobotParams] = None,
    meddle: Optional[Callable[[BallGround, Action], None]] = None,
) -> Played:
    """Until the task ends. :param meddle: changes the world, called after each tick"""
    ground = BallGround(world.size, world.pillars, world.ball, world.robot, drive=drive, seed=seed)
    eyes, task = Eyes(ground, noise, seed), BallTask(params or BallTaskParams())
    states, reasons, is_through = [], [], False
    for tick in range(round((task.params.time_limit + 5.0) / TICK)):
        if tick % 2 == 0:
            eyes.look()
        action = task.step(eyes.view())
        if [action.state, action.reason] != [*states[-1:], *reasons[-1:]]:
            states.append(action.state)
            reasons.append(action.reason)
        before = None if ground.ball is None else ground.ball.copy()
        ground.command(*action.command)
        ground.advance(TICK)
        is_through |= goes_in(world, before, ground.ball)
        if action.is_ended and abs(ground.robot.speed) < 0.01:
            return Played(world, ground, action, states, reasons, is_through)
        if meddle is not None:
            meddle(ground, action)
    raise AssertionError("it does not end")
