# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The robot behind the ball: turns toward it, runs up along the kick's line, kicks and slows down."""

import math
from typing import Optional, Tuple

import numpy as np

from sextant.ball.ball_task_params import BallTaskParams
from sextant.ball.goal import Goal
from sextant.ball.kick_plan import BEYOND_CONTACT, FINE, Kick, straight_ahead
from sextant.ball.path_follower import HALT, PathFollower, bearing_of
from sextant.ball.task_view import SeenBall, Step, TaskView

WORSE = 0.6  # share of the room for error of the planned kick that is enough
OFF_START = 0.2  # metres from where it was to begin
ALIGNED = 0.03  # radians
SETTLED = 0.4  # seconds that the robot stands before it kicks
UNSEEN = 3.0  # seconds after which a ball that is looked at is not where it was
FROZEN = 0.5  # metres to the ball from where on it is out of view
FAR_AHEAD, FAR_BEHIND = 2.0, 2.0  # metres that the line goes on beyond the ball, and before it
FIRST_SPEED = 0.1  # m/s


def along_line(kick: Kick, pose: np.ndarray) -> Tuple[float, float]:
    """Metres that the robot is before the ball, and to the left of the line."""
    off, (x, y) = pose[:2] - kick.ball, kick.direction
    return float(-(off[0] * x + off[1] * y)), float(x * off[1] - y * off[0])


class Aligning:
    """The robot turns on the spot until it looks at the ball."""

    def __init__(self, params: BallTaskParams, kick: Kick, tries: int = 0):
        """:param kick: that is planned. :param tries: that came to nothing: then less is enough"""
        self._params, self._follower, self._planned = params, PathFollower(params.follower), kick
        self._aligned = math.nan
        self._enough = WORSE ** (1 + tries) * min(kick.spread, FINE)
        self.kick = kick

    def step(self, view: TaskView, goal: Goal) -> Step:
        """The kick becomes that which goes straight from where the robot stands, if it is as good."""
        params = self._params
        discs = np.array([[*each.position, params.pillar_radius] for each in view.pillars]).reshape(-1, 3)
        kick = self._planned._replace(ball=view.ball.position)
        kick = straight_ahead(kick, view.pose, goal, discs, params.kick.ball_radius)
        away = float(np.linalg.norm(view.ball.position - view.pose[:2]))
        if kick is None or kick.spread < self._enough:
            return Step(HALT, "approaching", "not behind the ball")
        if abs(away - params.kick.run_up) > OFF_START:
            return Step(HALT, "approaching", "too far from the ball, or too near")
        self.kick = kick
        angle = bearing_of(view.pose, view.ball.position)
        if abs(angle) > ALIGNED:
            self._aligned = math.nan
            return Step((0.0, self._follower.turn(angle)))
        return self._settle(view)

    def _settle(self, view: TaskView) -> Step:
        """Stands until a picture was taken that does not shake."""
        self._aligned = view.stamp if math.isnan(self._aligned) else self._aligned
        stood = view.stamp - self._aligned
        if view.ball.stamp < self._aligned + 0.5 * SETTLED:
            return Step(HALT, "searching", "the ball is not where it was") if stood > UNSEEN else Step(HALT)
        return Step(HALT, "kicking", "behind the ball") if stood > SETTLED else Step(HALT)


class Kicking:
    """From the run-up until the ball must have been hit."""

    def __init__(self, params: BallTaskParams, kick: Kick, speed: float):
        """:param speed: m/s at which the ball is to be hit"""
        self._params, self._follower = params, PathFollower(params.follower)
        self.kick, self.speed = kick, speed

    def step(self, view: TaskView) -> Step:
        """Along the line, ever faster."""
        self._correct(view.ball)
        before, _ = along_line(self.kick, view.pose)
        contact = self._params.kick.robot_radius + self._params.kick.ball_radius
        if before < contact - BEYOND_CONTACT:
            return Step(HALT, "watching", "the ball was kicked")
        end = self.kick.ball + FAR_AHEAD * self.kick.direction
        line = np.array([self.kick.ball - FAR_BEHIND * self.kick.direction, end])
        gone = max(0.0, self._params.kick.run_up - before)
        most = math.sqrt(FIRST_SPEED**2 + 2.0 * self._params.follower.acceleration * gone)
        speed, turn_rate = self._follower.follow(view.pose, line)
        wanted = min(self.speed, most)
        return Step((wanted, turn_rate * wanted / speed if speed > 0.0 else turn_rate), path=line)

    def _correct(self, ball: Optional[SeenBall]) -> None:
        """As long as it is in view the ball's place becomes better known."""
        if ball is not None and ball.is_still and np.linalg.norm(ball.position - self.kick.ball) < FROZEN:
            self.kick = self.kick._replace(ball=ball.position)
