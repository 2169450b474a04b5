# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""From where, whereto and how fast a ball is kicked, to be through the goal in as few kicks as can be."""

import math
from dataclasses import dataclass
from typing import Iterator, List, NamedTuple, Optional, Tuple

import numpy as np

from sextant.ball.goal import Goal
from sextant.ball.path_planner import Disc, FreeFloor
from sextant.base.strict_params import ParamError, StrictParams, param, within

AIMS = 13  # places on the goal's line that are tried
DIRECTIONS, LENGTHS = 24, (0.4, 0.7, 1.0)  # of kicks that only bring the ball to where it can be kicked from
FINE = 0.10  # radians; a kick that may err by this is as good as one that may err by more
LEAST_BEFORE = 0.4  # metres before the goal's line from which a last kick can be made
SURELY_PAST = 0.1  # metres beyond the goal's line that a kick has to be able to reach, to be tried
BEYOND_CONTACT = 0.05  # metres that the robot drives on when it touched the ball
BRAKING = 1.0  # m/s^2 with which it slows down then
LEAST_AIM = 0.1  # metres; a ball that lies nearer to the goal's line is aimed so far, beyond it


@dataclass(frozen=True)
class KickParams(StrictParams):
    """Of robot and ball."""

    robot_radius: float = param(0.177, within(1e-3, 2))  # metres
    ball_radius: float = param(0.05, within(1e-3, 1))  # metres
    ball_deceleration: float = param(0.35, within(1e-3, 10))  # m/s^2 by which it slows down on this floor
    ball_bounce: float = param(0.6, within(0, 1))  # share of the closing speed with which it leaves
    run_up: float = param(0.62, within(1e-3, 5))  # metres from robot to ball (middles) where a kick begins
    least_speed: float = param(0.2, within(1e-3, 10))  # m/s of the robot
    most_speed: float = param(0.65, within(1e-3, 10))  # m/s
    past: float = param(0.4, within(0, 10))  # metres that the ball shall roll beyond the goal's line
    least_spread: float = param(0.03, within(0, 1))  # radians that a kick may err at least

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.run_up < self.robot_radius + self.ball_radius:
            raise ParamError("run_up", "must be more than robot_radius + ball_radius", self.run_up)
        if self.least_speed > self.most_speed:
            raise ParamError("least_speed", "must be at most", self.least_speed, "most_speed")

    def speed(self, way: float, gain: float) -> float:
        """m/s of the robot that make the ball roll so many metres: v^2 = 2 a s, and how it bounces off."""
        wanted = gain * math.sqrt(2.0 * self.ball_deceleration * way) / (1.0 + self.ball_bounce)
        return min(max(wanted, self.least_speed), self.most_speed)

    def roll(self, way: float) -> float:
        """Metres that a ball shall roll which is so far from the goal's line: past it; if that is too far for
        the robot, not so far that it lies on the line, where one hardly comes behind it."""
        reach = ((1.0 + self.ball_bounce) * self.most_speed) ** 2 / (2.0 * self.ball_deceleration)
        if reach > way + SURELY_PAST:
            return min(way + self.past, reach)
        return min(reach, max(0.0, way - LEAST_BEFORE))


class Kick(NamedTuple):
    """Of a ball that lies still."""

    ball: np.ndarray  # (2,) metres, map
    target: np.ndarray  # (2,) where it shall come by: on the goal's line if it is the last
    start: np.ndarray  # (2,) of the robot's middle
    way: float  # metres that the ball shall roll
    spread: float  # radians by which it may err
    is_last: bool  # through the goal

    @property
    def direction(self) -> np.ndarray:
        """(2,) unit vector from ball to target"""
        off = self.target - self.ball
        return off / np.linalg.norm(off)


class KickPlanner:
    """Plans for one moment: where everything is does not change."""

    def __init__(
        self, params: KickParams, goal: Goal, discs: List[Disc], floor: FreeFloor, costs: np.ndarray
    ):
        """:param discs: all pillars. :param floor: of the robot, as if there were no ball
        :param costs: of the robot's way to each cell of the floor, with the ball in it
        """
        self._params, self._goal, self._floor, self._costs = params, goal, floor, costs
        self._discs = np.array(discs).reshape(-1, 3)

    def plan(self, ball: np.ndarray, before: Optional[Kick] = None) -> Optional[Kick]:
        """The best kick; None: there is none.

        :param before: the kick that was planned last; as good as another, it stays
        """
        direct = list(self._through_goal(ball))
        best = _surest(direct, before)
        if best is not None and best.spread >= self._params.least_spread:
            return best
        return min(self._toward(ball), default=(math.inf, best), key=lambda each: each[0])[1]

    def _through_goal(self, ball: np.ndarray, is_reached: bool = True) -> Iterator[Kick]:
        """Kicks to the goal's line, those to its middle first."""
        goal, params = self._goal, self._params
        before = goal.before(ball)
        if before < -params.ball_radius:
            return
        middle = goal.middle + min(before - LEAST_AIM, 0.0) * goal.out
        along = (goal.posts[1] - goal.posts[0]) / goal.width
        half = max(0.0, 0.5 * goal.width - 3.0 * params.ball_radius)  # a ball's width of room beside posts
        for off in sorted(np.linspace(-half, half, AIMS), key=abs):
            target = middle + off * along
            kick = self._kick(ball, target, True)
            if self._is_possible(kick, is_reached):
                yield kick

    def _kick(self, ball: np.ndarray, target: np.ndarray, is_last: bool) -> Kick:
        off = target - ball
        way = float(np.linalg.norm(off))
        start = ball - off / max(way, 1e-9) * self._params.run_up
        return Kick(
            ball,
            target,
            start,
            self._params.roll(way) if is_last else way,
            spread(ball, target, self._discs, self._params.ball_radius),
            is_last,
        )

    def _is_possible(self, kick: Kick, is_reached: bool) -> bool:
        """Whether the robot can come to where it begins, run up and slow down."""
        if kick.spread < 0.0 or not self._floor.allows(kick.start):
            return False
        if is_reached and not np.isfinite(self._costs[self._floor.cell(kick.start)]):
            return False
        contact = self._params.robot_radius + self._params.ball_radius - BEYOND_CONTACT
        rest = max(0.0, contact - self._params.speed(kick.way, 1.0) ** 2 / (2.0 * BRAKING))
        return self._floor.allows_line(kick.start, kick.ball - rest * kick.direction)

    def _toward(self, ball: np.ndarray) -> Iterator[Tuple[float, Kick]]:
        """Kicks to where a last one can be made from, and what both cost, metres."""
        params = self._params
        for turn in np.linspace(-math.pi, math.pi, DIRECTIONS, endpoint=False):
            for length in LENGTHS:
                end = ball + length * np.array([math.cos(turn), math.sin(turn)])
                kick = self._kick(ball, end, False)
                if kick.spread < params.least_spread or not self._is_possible(kick, True):
                    continue
                if self._goal.before(end) < LEAST_BEFORE or not self._floor.knows(end):
                    continue  # there may be a wall
                last = _surest(list(self._through_goal(end, False)), None)
                if last is not None and last.spread >= params.least_spread:
                    cost = self._costs[self._floor.cell(kick.start)] + 2.0 * length + last.way
                    yield cost - 5.0 * min(kick.spread, last.spread, FINE), kick


def spread(ball: np.ndarray, target: np.ndarray, discs: np.ndarray, radius: float) -> float:
    """Radians by which the ball may go aside until it touches something on its way; less than 0: it does.

    :param discs: (n, 3) x, y, radius of what stands there. :param radius: of the ball
    """
    off = target - ball
    way = float(np.linalg.norm(off))
    along = off / max(way, 1e-9)
    rest = discs[:, :2] - ball
    forth = rest @ along
    aside = abs(rest[:, 0] * along[1] - rest[:, 1] * along[0])
    which = (forth > -0.05) & (forth < way + 0.1)
    room = aside - discs[:, 2] - radius
    return float(min(room[which] / np.maximum(forth[which], 0.2), default=1.0))


def straight_ahead(
    kick: Kick, pose: np.ndarray, goal: Goal, discs: np.ndarray, radius: float
) -> Optional[Kick]:
    """The kick of a robot that goes from where it is straight at the ball; None: past the goal, though that
    is what is planned. :param discs: and radius as spread()"""
    off = kick.ball - pose[:2]
    along = off / np.linalg.norm(off)
    way = float(np.linalg.norm(kick.target - kick.ball))
    if kick.is_last:
        toward = -float(along @ goal.out)
        if toward < 0.2:
            return None
        way = max(goal.before(kick.ball), LEAST_AIM) / toward
    target = kick.ball + way * along
    if kick.is_last and abs(goal.aside(target)) > 0.5 * goal.width - 2.0 * radius:
        return None
    found = spread(kick.ball, target, discs, radius)
    return kick._replace(target=target, start=pose[:2].copy(), spread=found)


def _surest(kicks: List[Kick], before: Optional[Kick]) -> Optional[Kick]:
    """That which may err most; of those that are fine the one that was planned before, or the first."""
    if not kicks:
        return None
    best = max(min(kick.spread, FINE) for kick in kicks)
    good = [kick for kick in kicks if kick.spread >= best - 0.01]
    if before is None:
        return good[0]
    return min(good, key=lambda kick: round(float(np.linalg.norm(kick.target - before.target)), 2))
