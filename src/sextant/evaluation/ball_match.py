# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the ball task in a simulated world, with images, detector and filter, and returns the result."""

import time
from collections import deque
from dataclasses import dataclass
from typing import Callable, Deque, NamedTuple, Optional, Tuple

import cv2
import numpy as np

import sextant
from sextant.ball.ball_player import BallPlayer, BallPlayerParams, RgbdMount
from sextant.ball.goal import goal_between, goes_through
from sextant.ball.task_view import Action
from sextant.base.strict_params import StrictParams, param, within
from sextant.objects.detections import Detector
from sextant.simulation.ball_ground import RobotParams
from sextant.simulation.ball_simulation import BallSimulation, BallSimulationParams
from sextant.simulation.ball_world import STRAYS, random_world
from sextant.simulation.rgbd_camera import RgbdImages, RgbdParams

TICK = 0.05  # seconds between readings of odometry
PICTURE_TICKS = 2  # ticks between images
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


@dataclass(frozen=True)
class Difficulty(StrictParams):
    """Differences of a world from what the robot's software assumes. Defaults: the usual worlds."""

    hard: bool = param(False, "small obstacles without a class, and images of a hard room")
    slip: float = param(RobotParams.slip, "as in RobotParams", within(0, 1))
    depth_noise: float = param(RgbdParams.depth_noise, "as in RgbdParams", within(0, 1), "m")
    late_ticks: int = param(2, "ticks of 0.05 s from an image to its processing", within(1, 100))
    mount_error: float = param(
        0.0, "rotation of both cameras that the software does not know", within(0, 1), "rad"
    )


USUAL = Difficulty()
HARD = Difficulty(
    hard=True, slip=0.1, depth_noise=3.0 * RgbdParams.depth_noise, late_ticks=5, mount_error=np.deg2rad(2.0)
)

Watch = Callable[[BallSimulation, BallPlayer, Action, Optional[RgbdImages]], None]


def mount_of(simulation: BallSimulation, turn: Optional[np.ndarray] = None) -> RgbdMount:
    """Returns models and mounts of the simulated cameras.

    :param turn: rotation vector of an error of both mounts (3,), radians, in the robot's frame
    """
    camera = simulation.camera
    models = map(sextant.CameraModel, (camera.colour, camera.depth))
    mounts = [camera.T_base_colour, camera.T_base_depth]
    if turn is not None:
        turned = cv2.Rodrigues(turn)[0]
        mounts = [np.block([[turned @ each[:3, :3], each[:3, 3:]], [each[3:]]]) for each in mounts]
    return RgbdMount(*models, *mounts)


def play(
    task: int,
    seed: int,
    detector: Detector,
    params: BallPlayerParams,
    obstacles: Optional[int] = None,
    watch: Optional[Watch] = None,
    difficulty: Difficulty = USUAL,
) -> MatchResult:
    """Runs one world from start to end.

    :param obstacles: number of pillars in front of the goal, as in random_world()
    :param watch: called at every tick
    """
    begin = time.perf_counter()
    simulation = simulation_of(task, seed, obstacles, difficulty)
    axis = np.random.default_rng([seed, 12]).normal(size=3)
    mount = mount_of(simulation, difficulty.mount_error * axis / np.linalg.norm(axis))
    match = _Match(simulation, BallPlayer(params, mount, detector), difficulty.late_ticks)
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


def simulation_of(task: int, seed: int, obstacles: Optional[int], difficulty: Difficulty) -> BallSimulation:
    """A world of the ball task. :param obstacles: as in random_world()"""
    world = random_world(task, seed, obstacles, STRAYS if difficulty.hard else 0)
    params = BallSimulationParams(
        seed=seed, hard=difficulty.hard, drive=RobotParams(slip=difficulty.slip),
        camera=RgbdParams(depth_noise=difficulty.depth_noise),
    )  # fmt: skip
    return BallSimulation(world, params)


class _Match:
    """A world and the player in it."""

    def __init__(self, simulation: BallSimulation, player: BallPlayer, late_ticks: int):
        """:param late_ticks: ticks from an image to its processing"""
        world = simulation.world
        self._simulation, self.player = simulation, player
        self.goal = goal_between(np.array(world.pillars[0][:2]), np.array(world.pillars[1][:2]), world.ball)
        self.through, self.picture = np.nan, None  # time of the goal, seconds; the last processed image
        self._late: Deque[Tuple[int, float, RgbdImages]] = deque()
        self._tick, self._late_ticks = 0, late_ticks

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
        if self._late[0][0] + self._late_ticks <= self._tick:
            _, taken, self.picture = self._late.popleft()
            self.player.add_images(taken, self.picture.colour, self.picture.depth)
