# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Planning of start, target and speed of kicks, to bring the ball through the goal in few kicks."""

import math
from dataclasses import dataclass
from typing import Iterator, List, NamedTuple, Optional, Tuple

import numpy as np

from sextant.ball.goal import Goal
from sextant.ball.path_planner import Costmap, Disc
from sextant.base.strict_params import ParamError, StrictParams, also, param, within

TARGETS = 13  # candidate targets on the goal line
DIRECTIONS, LENGTHS = 24, (0.4, 0.7, 1.0)  # of intermediate kicks; metres
ENOUGH_TOLERANCE = 0.10  # radians; kicks with more are equally good
MIN_DISTANCE = 0.4  # metres from the goal line where a final kick may start
MIN_OVERSHOOT = 0.1  # metres behind the goal line that a final kick must be able to reach
BEYOND_CONTACT = 0.05  # metres that the robot drives on after contact
BRAKING = 1.0  # m/s^2, deceleration of the robot after contact
TOLERANCE_REWARD = 5.0  # metres of path that a radian of tolerance is worth
MIN_AIM = 0.1  # metres from ball to target; for a ball nearer to the goal line the target is behind the line


@dataclass(frozen=True)
class KickParams(StrictParams):
    """Geometry of robot and ball, and limits of kicks."""

    robot_radius: float = param(0.177, "radius of the robot", within(1e-3, 2), "m")
    ball_radius: float = param(0.05, "radius of the ball", within(1e-3, 1), "m")
    ball_deceleration: float = param(
        0.35, "deceleration of a rolling ball on this floor", within(1e-3, 10), "m/s²"
    )
    ball_restitution: float = param(0.6, "coefficient of restitution between robot and ball", within(0, 1))
    run_up: float = param(
        0.62,
        "distance between the centres of robot and ball at the start of a kick",
        also(within(1e-3, 5), "more than both radii"),
        "m",
    )
    min_kick_speed: float = param(
        0.2,
        "minimum speed of the robot at contact",
        also(within(1e-3, 10), "at most `max_kick_speed`"),
        "m/s",
    )
    max_kick_speed: float = param(0.65, "maximum speed of the robot at contact", within(1e-3, 10), "m/s")
    overshoot: float = param(
        0.4, "distance that the ball should roll behind the goal line", within(0, 10), "m"
    )
    min_tolerance: float = param(
        0.03,
        "minimum angular tolerance of a kick: the error of direction at which the ball touches an "
        "obstacle",
        within(0, 1),
        "rad",
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.run_up < self.robot_radius + self.ball_radius:
            raise ParamError("run_up", "must be more than robot_radius + ball_radius", self.run_up)
        if self.min_kick_speed > self.max_kick_speed:
            raise ParamError("min_kick_speed", "must be at most", self.min_kick_speed, "max_kick_speed")

    def speed(self, distance: float, gain: float) -> float:
        """Speed of the robot (m/s) that makes the ball roll a distance (metres): v^2 = 2 a s, restitution."""
        wanted = gain * math.sqrt(2.0 * self.ball_deceleration * distance) / (1.0 + self.ball_restitution)
        return min(max(wanted, self.min_kick_speed), self.max_kick_speed)

    def roll(self, distance: float) -> float:
        """Distance (metres) to roll for a ball at this distance from the goal line: beyond the line or, if
        that is out of reach, short of it, so that the robot can still drive behind the ball."""
        reach = ((1.0 + self.ball_restitution) * self.max_kick_speed) ** 2 / (2.0 * self.ball_deceleration)
        if reach > distance + MIN_OVERSHOOT:
            return min(distance + self.overshoot, reach)
        return min(reach, max(0.0, distance - MIN_DISTANCE))


class Kick(NamedTuple):
    """A kick of a resting ball."""

    ball: np.ndarray  # (2,) metres, map
    target: np.ndarray  # (2,) metres, map: on the goal line if final, else where the ball stops
    start: np.ndarray  # (2,) metres, map: position of the robot before the run-up
    distance: float  # metres that the ball is planned to roll
    tolerance: float  # radians, largest angular error with which the ball touches nothing
    is_final: bool  # whether it leads through the goal

    @property
    def direction(self) -> np.ndarray:
        """Unit vector (2,) from ball to target."""
        off = self.target - self.ball
        return off / np.linalg.norm(off)


class KickPlanner:
    """Plans kicks for one state of the world."""

    def __init__(
        self, params: KickParams, goal: Goal, discs: List[Disc], costmap: Costmap, costs: np.ndarray
    ):
        """:param discs: all pillars. :param costmap: of the robot, without the ball
        :param costs: of the robot's path to each cell of the costmap, with the ball as an obstacle
        """
        self._params, self._goal, self._costmap, self._costs = params, goal, costmap, costs
        self._discs = np.array(discs).reshape(-1, 3)

    def plan(self, ball: np.ndarray, before: Optional[Kick] = None) -> Optional[Kick]:
        """Plan the best kick; None: no kick is possible.

        :param before: the previous plan, kept among equally good kicks
        """
        direct = list(self._through_goal(ball))
        best = _most_tolerant(direct, before)
        if best is not None and best.tolerance >= self._params.min_tolerance:
            return best
        return min(self._toward(ball), default=(math.inf, best), key=lambda each: each[0])[1]

    def _through_goal(self, ball: np.ndarray, must_be_reachable: bool = True) -> Iterator[Kick]:
        """Kicks to the goal line, those to its middle first."""
        goal, params = self._goal, self._params
        before = goal.distance_before(ball)
        if before < -params.ball_radius:
            return
        middle = goal.middle + min(before - MIN_AIM, 0.0) * goal.normal
        along = (goal.posts[1] - goal.posts[0]) / goal.width
        # One ball diameter of clearance to the posts.
        half = max(0.0, 0.5 * goal.width - 3.0 * params.ball_radius)
        for off in sorted(np.linspace(-half, half, TARGETS), key=abs):
            target = middle + off * along
            kick = self._kick(ball, target, True)
            if self._is_possible(kick, must_be_reachable):
                yield kick

    def _kick(self, ball: np.ndarray, target: np.ndarray, is_final: bool) -> Kick:
        off = target - ball
        distance = float(np.linalg.norm(off))
        start = ball - off / max(distance, 1e-9) * self._params.run_up
        return Kick(
            ball,
            target,
            start,
            self._params.roll(distance) if is_final else distance,
            angular_tolerance(ball, target, self._discs, self._params.ball_radius),
            is_final,
        )

    def _is_possible(self, kick: Kick, must_be_reachable: bool) -> bool:
        """Whether the robot can reach the start, run up and brake."""
        if kick.tolerance < 0.0 or not self._costmap.is_free_at(kick.start):
            return False
        if must_be_reachable and not np.isfinite(self._costs[self._costmap.cell(kick.start)]):
            return False
        contact = self._params.robot_radius + self._params.ball_radius - BEYOND_CONTACT
        rest = max(0.0, contact - self._params.speed(kick.distance, 1.0) ** 2 / (2.0 * BRAKING))
        return self._costmap.is_line_free(kick.start, kick.ball - rest * kick.direction)

    def _toward(self, ball: np.ndarray) -> Iterator[Tuple[float, Kick]]:
        """Intermediate kicks to where a final one is possible, with the cost of both, metres."""
        params = self._params
        for turn in np.linspace(-math.pi, math.pi, DIRECTIONS, endpoint=False):
            for length in LENGTHS:
                end = ball + length * np.array([math.cos(turn), math.sin(turn)])
                kick = self._kick(ball, end, False)
                if kick.tolerance < params.min_tolerance or not self._is_possible(kick, True):
                    continue
                if self._goal.distance_before(end) < MIN_DISTANCE or not self._costmap.is_seen_free(end):
                    continue  # unknown floor: there may be a wall
                last = _most_tolerant(list(self._through_goal(end, False)), None)
                if last is not None and last.tolerance >= params.min_tolerance:
                    cost = self._costs[self._costmap.cell(kick.start)] + 2.0 * length + last.distance
                    yield (
                        cost - TOLERANCE_REWARD * min(kick.tolerance, last.tolerance, ENOUGH_TOLERANCE),
                        kick,
                    )


def angular_tolerance(ball: np.ndarray, target: np.ndarray, discs: np.ndarray, radius: float) -> float:
    """Largest angular error (radians) with which the ball touches no obstacle; negative: it always does.

    :param discs: (n, 3) x, y, radius of the obstacles. :param radius: of the ball, metres
    """
    off = target - ball
    distance = float(np.linalg.norm(off))
    along = off / max(distance, 1e-9)
    rest = discs[:, :2] - ball
    ahead = rest @ along
    aside = abs(rest[:, 0] * along[1] - rest[:, 1] * along[0])
    which = (ahead > -0.05) & (ahead < distance + 0.1)
    room = aside - discs[:, 2] - radius
    return float(min(room[which] / np.maximum(ahead[which], 0.2), default=1.0))


def straight_ahead(
    kick: Kick, pose: np.ndarray, goal: Goal, discs: np.ndarray, radius: float
) -> Optional[Kick]:
    """The kick of a robot that drives from its pose straight to the ball; None: it would miss the goal, but a
    final kick is planned. :param discs: and radius as angular_tolerance()"""
    off = kick.ball - pose[:2]
    along = off / np.linalg.norm(off)
    distance = float(np.linalg.norm(kick.target - kick.ball))
    if kick.is_final:
        toward = -float(along @ goal.normal)
        if toward < 0.2:
            return None
        distance = max(goal.distance_before(kick.ball), MIN_AIM) / toward
    target = kick.ball + distance * along
    if kick.is_final and abs(goal.lateral_offset(target)) > 0.5 * goal.width - 2.0 * radius:
        return None
    found = angular_tolerance(kick.ball, target, discs, radius)
    return kick._replace(target=target, start=pose[:2].copy(), tolerance=found)


def _most_tolerant(kicks: List[Kick], before: Optional[Kick]) -> Optional[Kick]:
    """The kick with the largest tolerance; of equally good ones the one closest to the previous plan."""
    if not kicks:
        return None
    best = max(min(kick.tolerance, ENOUGH_TOLERANCE) for kick in kicks)
    good = [kick for kick in kicks if kick.tolerance >= best - 0.01]
    if before is None:
        return good[0]
    return min(good, key=lambda kick: round(float(np.linalg.norm(kick.target - before.target)), 2))
