# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""States of the robot behind the ball: turn toward it, run up, kick and brake."""

import math
from typing import Optional, Tuple

import numpy as np

from sextant.ball.ball_task_params import BallTaskParams
from sextant.ball.goal import Goal
from sextant.ball.kick_plan import BEYOND_CONTACT, ENOUGH_TOLERANCE, Kick, straight_ahead
from sextant.ball.path_follower import HALT, bearing_of, follow, turn_on_the_spot
from sextant.ball.task_view import SeenBall, Step, TaskView

ENOUGH = 0.6  # fraction of the planned kick's tolerance that suffices after alignment
OFF_START = 0.2  # metres between actual and planned start
ALIGNED = 0.03  # radians
SETTLING_TIME = 0.4  # seconds that the robot stands before the kick
LOST_AFTER = 3.0  # seconds without an image of the ball, then it is searched again
MIN_VISIBLE = 0.5  # metres between updated and planned ball; farther is an outlier
LINE_AHEAD, LINE_BEHIND = 2.0, 2.0  # metres of the line beyond and before the ball
FIRST_SPEED = 0.1  # m/s


def along_line(kick: Kick, pose: np.ndarray) -> Tuple[float, float]:
    """Distance of the robot to the ball along the kick's line, and its offset to the left, metres."""
    off, (x, y) = pose[:2] - kick.ball, kick.direction
    return float(-(off[0] * x + off[1] * y)), float(x * off[1] - y * off[0])


class Aligning:
    """Turns on the spot until the robot faces the ball."""

    def __init__(self, params: BallTaskParams, kick: Kick, tries: int = 0):
        """:param kick: planned. :param tries: failed ones, each of which reduces the required tolerance"""
        self._params, self._planned, self.kick = params, kick, kick
        self._aligned = math.nan
        self._enough = ENOUGH ** (1 + tries) * min(kick.tolerance, ENOUGH_TOLERANCE)

    def step(self, view: TaskView, goal: Goal) -> Step:
        """Turn, and replace the planned kick by the one straight ahead if that is good enough."""
        params = self._params
        discs = np.array([[*each.position, params.pillar_radius] for each in view.pillars]).reshape(-1, 3)
        kick = self._planned._replace(ball=view.ball.position)
        kick = straight_ahead(kick, view.pose, goal, discs, params.kick.ball_radius)
        away = float(np.linalg.norm(view.ball.position - view.pose[:2]))
        if kick is None or kick.tolerance < self._enough:
            return Step(HALT, "approaching", "not behind the ball")
        if abs(away - params.kick.run_up) > OFF_START:
            return Step(HALT, "approaching", "too far from the ball, or too near")
        self.kick = kick
        angle = bearing_of(view.pose, view.ball.position)
        if abs(angle) > ALIGNED:
            self._aligned = math.nan
            return Step((0.0, turn_on_the_spot(params.follower, angle)))
        return self._settle(view)

    def _settle(self, view: TaskView) -> Step:
        """Stand until an image was taken at rest."""
        self._aligned = view.stamp if math.isnan(self._aligned) else self._aligned
        stood = view.stamp - self._aligned
        if view.ball.stamp < self._aligned + 0.5 * SETTLING_TIME:
            return (
                Step(HALT, "searching", "the ball is not where it was") if stood > LOST_AFTER else Step(HALT)
            )
        return Step(HALT, "kicking", "behind the ball") if stood > SETTLING_TIME else Step(HALT)


class Kicking:
    """Runs up until the ball must have been hit."""

    def __init__(self, params: BallTaskParams, kick: Kick, speed: float):
        """:param speed: of the robot at contact, m/s"""
        self._params, self.kick, self.speed = params, kick, speed

    def step(self, view: TaskView) -> Step:
        """Accelerate along the line."""
        self._correct(view.ball)
        before, _ = along_line(self.kick, view.pose)
        contact = self._params.kick.robot_radius + self._params.kick.ball_radius
        if before < contact - BEYOND_CONTACT:
            return Step(HALT, "watching", "the ball was kicked")
        end = self.kick.ball + LINE_AHEAD * self.kick.direction
        line = np.array([self.kick.ball - LINE_BEHIND * self.kick.direction, end])
        driven = max(0.0, self._params.kick.run_up - before)
        max_speed = math.sqrt(FIRST_SPEED**2 + 2.0 * self._params.follower.acceleration * driven)
        speed, turn_rate = follow(self._params.follower, view.pose, line)
        wanted = min(self.speed, max_speed)
        return Step((wanted, turn_rate * wanted / speed if speed > 0.0 else turn_rate), path=line)

    def _correct(self, ball: Optional[SeenBall]) -> None:
        """Update the ball's position while it is visible."""
        if (
            ball is not None
            and ball.is_still
            and np.linalg.norm(ball.position - self.kick.ball) < MIN_VISIBLE
        ):
            self.kick = self.kick._replace(ball=ball.position)
