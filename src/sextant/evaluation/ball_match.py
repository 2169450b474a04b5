# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The ball task played in a simulated world, with pictures, network and filter, and what came of it."""

import time
from collections import deque
from typing import Callable, Deque, NamedTuple, Optional, Tuple

import numpy as np

import sextant
from sextant.ball.ball_player import BallPlayer, BallPlayerParams, RgbdMount
from sextant.ball.goal import goal_between, goes_through
from sextant.ball.task_view import Action
from sextant.objects.detection import Detector
from sextant.simulation.ball_simulation import BallSimulation, BallSimulationParams
from sextant.simulation.ball_world import drawn_world
from sextant.simulation.rgbd_camera import RgbdPicture

TICK = 0.05  # seconds between readings of odometry
PICTURE_TICKS = 2  # from one picture to the next
LATE_TICKS = 2  # from a picture to when it was worked on
STOPPED = 0.01  # m/s
LIMIT = 400.0  # seconds


class MatchResult(NamedTuple):
    """Of one world."""

    task: int
    seed: int
    through: bool  # the ball, between the posts
    stop: float  # metres from the goal's line to the robot's foremost point, at the end
    pillars: int  # times that the robot touched one
    walls: int
    seconds: float  # simulated
    goal_seconds: float  # until the ball was through; NaN: it was not
    kicks: int
    reason: str  # why it ended
    wall_seconds: float  # of computing


Watch = Callable[[BallSimulation, BallPlayer, Action, Optional[RgbdPicture]], None]


def mount_of(simulation: BallSimulation) -> RgbdMount:
    """Of the simulated cameras."""
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
    """One world from start to end.

    :param obstacles: as drawn_world() has it
    :param watch: is shown every moment
    """
    begin = time.perf_counter()
    simulation = BallSimulation(drawn_world(task, seed, obstacles), BallSimulationParams(seed=seed))
    match = _Match(simulation, BallPlayer(params, mount_of(simulation), detector))
    action = match.advance()
    while not match.is_over(action):
        action = match.advance()
        if watch:
            watch(simulation, match.player, action, match.picture)
    ground, robot = simulation.ground, simulation.ground.robot
    touched = [touch.what for touch in ground.touches]
    stop = match.goal.before(np.array([robot.x, robot.y])) - ground.drive.radius
    return MatchResult(
        task, seed, not np.isnan(match.through), stop, touched.count("pillar"), touched.count("wall"),
        ground.stamp, match.through, action.kicks, action.reason, time.perf_counter() - begin,
    )  # fmt: skip


class _Match:
    """A world and who plays in it."""

    def __init__(self, simulation: BallSimulation, player: BallPlayer):
        world = simulation.world
        self._simulation, self.player = simulation, player
        self.goal = goal_between(np.array(world.pillars[0][:2]), np.array(world.pillars[1][:2]), world.ball)
        self.through, self.picture = np.nan, None  # seconds; the picture that was worked on last
        self._late: Deque[Tuple[int, float, RgbdPicture]] = deque()
        self._tick = 0

    def advance(self) -> Action:
        """One tick: odometry, a picture if there is one, what the robot does, what becomes of the ball."""
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
        """Whether the robot is done and stands, or takes too long."""
        ground = self._simulation.ground
        return (action.is_ended and abs(ground.robot.speed) < STOPPED) or ground.stamp > LIMIT

    def _look(self, stamp: float) -> None:
        """A picture is worked on some time after it was taken."""
        if self._tick % PICTURE_TICKS == 0:
            self._late.append((self._tick, stamp, self._simulation.take_picture()))
        if self._late[0][0] + LATE_TICKS <= self._tick:
            _, taken, self.picture = self._late.popleft()
            self.player.picture(taken, self.picture.colour, self.picture.depth)
