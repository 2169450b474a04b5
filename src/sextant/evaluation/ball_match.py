# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the ball task in a simulated world, with images, detector and filter, and returns the result."""

import time
from collections import deque
from typing import Callable, Deque, NamedTuple, Optional, Tuple

import numpy as np

import sextant
from sextant.ball.ball_player import BallPlayer, BallPlayerParams, RgbdMount
from sextant.ball.goal import goal_between, goes_through
from sextant.ball.task_view import Action
from sextant.objects.detections import Detector
from sextant.simulation.ball_simulation import BallSimulation, BallSimulationParams
from sextant.simulation.ball_world import random_world
from sextant.simulation.rgbd_camera import RgbdImages

TICK = 0.05  # seconds between readings of odometry
PICTURE_TICKS = 2  # ticks between images
LATE_TICKS = 2  # ticks from an image to its processing
STOPPED = 0.01  # maximum speed of a standing robot, m/s
LIMIT = 400.0  # maximum duration, seconds


class MatchResult(NamedTuple):
    """Result in one world."""

    task: int  # 2 or 3
    seed: int  # of the world
    through: bool  # the ball went through the goal
    stop: float  # final distance from the robot's front to the goal line, metres
    pillars: int  # number of collisions with pillars
    walls: int  # number of collisions with walls
    seconds: float  # simulated time
    goal_seconds: float  # simulated time until the goal; NaN: no goal
    kicks: int  # number of kicks
    reason: str  # why the task ended
    wall_seconds: float  # computing time


Watch = Callable[[BallSimulation, BallPlayer, Action, Optional[RgbdImages]], None]


def mount_of(simulation: BallSimulation) -> RgbdMount:
    """Returns models and mounts of the simulated cameras."""
    camera = simulation.camera
    models = map(sextant.CameraModel, (camera.colour, camera.depth))
    return RgbdMount(*models, camera.T_base_colour, camera.T_base_depth)


def play(
    task: int,
    seed: int,
    detector: Detector,
    params: BallPlayerParams,
    obstacles: Optional[int] = None,
    watch: Optional[Watch] = None,
) -> MatchResult:
    """Runs one world from start to end.

    :param obstacles: number of obstacles, as in random_world()
    :param watch: called at every tick
    """
    begin = time.perf_counter()
    simulation = BallSimulation(random_world(task, seed, obstacles), BallSimulationParams(seed=seed))
    match = _Match(simulation, BallPlayer(params, mount_of(simulation), detector))
    action = match.advance()
    while not match.is_over(action):
        action = match.advance()
        if watch:
            watch(simulation, match.player, action, match.picture)
    ground, robot = simulation.ground, simulation.ground.robot
    touched = [touch.what for touch in ground.touches]
    stop = match.goal.distance_before(np.array([robot.x, robot.y])) - ground.drive.radius
    return MatchResult(
        task, seed, not np.isnan(match.through), stop, touched.count("pillar"), touched.count("wall"),
        ground.stamp, match.through, action.kicks, action.reason, time.perf_counter() - begin,
    )  # fmt: skip


class _Match:
    """A world and the player in it."""

    def __init__(self, simulation: BallSimulation, player: BallPlayer):
        world = simulation.world
        self._simulation, self.player = simulation, player
        self.goal = goal_between(np.array(world.pillars[0][:2]), np.array(world.pillars[1][:2]), world.ball)
        self.through, self.picture = np.nan, None  # time of the goal, seconds; the last processed image
        self._late: Deque[Tuple[int, float, RgbdImages]] = deque()
        self._tick = 0

    def advance(self) -> Action:
        """Runs one tick: odometry, an image if one is due, the robot's action, and the ball's motion."""
        ground, player = self._simulation.ground, self.player
        player.odometry(ground.stamp, np.array([ground.rolled.x, ground.rolled.y, ground.rolled.yaw]))
        self._look(ground.stamp)
        action = player.step(ground.stamp, ground.is_bumped)
        ground.command(*action.command)
        ball = ground.ball.copy()
        ground.advance(TICK)
        if np.isnan(self.through) and goes_through(self.goal, ball, ground.ball):
            self.through = ground.stamp
        self._tick += 1
        return action

    def is_over(self, action: Action) -> bool:
        """Returns whether the task has ended and the robot stands, or the time limit is reached."""
        ground = self._simulation.ground
        return (action.is_ended and abs(ground.robot.speed) < STOPPED) or ground.stamp > LIMIT

    def _look(self, stamp: float) -> None:
        """Takes images and processes them with a delay."""
        if self._tick % PICTURE_TICKS == 0:
            self._late.append((self._tick, stamp, self._simulation.take_images()))
        if self._late[0][0] + LATE_TICKS <= self._tick:
            _, taken, self.picture = self._late.popleft()
            self.player.add_images(taken, self.picture.colour, self.picture.depth)
