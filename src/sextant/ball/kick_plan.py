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
MIN_AIM = 0.1  # metres; minimum distance from the ball to the line it is aimed at
MIN_TOWARD_GOAL = 0.2  # cosine of the angle between a shot at the goal and the goal's normal
# Obstacles from this far behind the ball to this far beyond its target limit a kick's tolerance, metres.
BEHIND_BALL, BEYOND_TARGET = 0.05, 0.1
MIN_RANGE = 0.2  # metres; a nearer obstacle counts as one at this distance
NO_OBSTACLE = 1.0  # radians; tolerance of a kick with no obstacle ahead


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
        also(within(1e-3, 5), "at least `robot_radius` + `ball_radius`"),
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
            raise ParamError("run_up", "must be at least robot_radius + ball_radius", self.run_up)
        if self.min_kick_speed > self.max_kick_speed:
            raise ParamError("min_kick_speed", "must be at most", self.min_kick_speed, "max_kick_speed")

    def speed(self, distance: float, gain: float) -> float:
        """Speed of the robot (m/s) at contact that makes the ball roll a distance (metres): v^2 = 2 a s,
        restitution; limited to min_kick_speed and max_kick_speed.

        :param gain: correction learned from earlier kicks on this floor, 1: none
        """
        wanted = gain * math.sqrt(2.0 * self.ball_deceleration * distance) / (1.0 + self.ball_restitution)
        return min(max(wanted, self.min_kick_speed), self.max_kick_speed)

    def roll(self, distance: float) -> float:
        """Distance (metres) that a final kick should make the ball roll.

        It passes the line by `overshoot`, or by less if max_kick_speed does not suffice. If it cannot pass it
        by MIN_OVERSHOOT, it stops MIN_DISTANCE or more before the target, from where another final kick can
        start.

        :param distance: from the ball to its target on the goal line
        """
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
    tolerance: float  # radians, as angular_tolerance()
    is_final: bool  # aimed through the goal (the ball may be too far away to reach it)

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

    def plan(self, ball: np.ndarray, previous: Optional[Kick] = None) -> Optional[Kick]:
        """Plan the best kick; None: no kick is possible.

        :param previous: the previous plan, kept among equally good kicks
        """
        direct = list(self._through_goal(ball))
        best = _most_tolerant(direct, previous)
        if best is not None and best.tolerance >= self._params.min_tolerance:
            return best
        return min(self._toward(ball), default=(math.inf, best), key=lambda each: each[0])[1]

    def _through_goal(self, ball: np.ndarray, must_be_reachable: bool = True) -> Iterator[Kick]:
        """Kicks to the goal line, those to its middle first."""
        goal, params = self._goal, self._params
        ahead_of_line = goal.distance_before(ball)
        if ahead_of_line < -params.ball_radius:
            return
        # The normal points toward the ball: a ball closer than MIN_AIM is aimed at a line shifted behind the
        # goal line.
        middle = goal.middle + min(ahead_of_line - MIN_AIM, 0.0) * goal.normal
        along = (goal.posts[1] - goal.posts[0]) / goal.width
        # The ball's centre passes 3 radii from a post's axis: its surface, 2 radii (one diameter).
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
        # Distances from the robot's centre to where the ball lay: where it begins to brake, where it stands.
        reach = self._params.robot_radius + self._params.ball_radius - BEYOND_CONTACT
        stop = max(0.0, reach - self._params.speed(kick.distance, 1.0) ** 2 / (2.0 * BRAKING))
        return self._costmap.is_line_free(kick.start, kick.ball - stop * kick.direction)

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
                    # The length of this kick counts twice: an empirical weight.
                    cost = self._costs[self._costmap.cell(kick.start)] + 2.0 * length + last.distance
                    yield (
                        cost - TOLERANCE_REWARD * min(kick.tolerance, last.tolerance, ENOUGH_TOLERANCE),
                        kick,
                    )


def angular_tolerance(ball: np.ndarray, target: np.ndarray, discs: np.ndarray, radius: float) -> float:
    """Angular error (radians) up to which the ball touches no obstacle; negative: it touches one even without
    an error; NO_OBSTACLE: no obstacle ahead.

    :param discs: (n, 3) x, y, radius of the obstacles. :param radius: of the ball, metres
    """
    off = target - ball
    distance = float(np.linalg.norm(off))
    along = off / max(distance, 1e-9)
    to_discs = discs[:, :2] - ball
    ahead = to_discs @ along
    aside = abs(to_discs[:, 0] * along[1] - to_discs[:, 1] * along[0])
    which = (ahead > -BEHIND_BALL) & (ahead < distance + BEYOND_TARGET)
    room = aside - discs[:, 2] - radius
    # Small angles: lateral room / range.
    return float(min(room[which] / np.maximum(ahead[which], MIN_RANGE), default=NO_OBSTACLE))


def straight_ahead(
    kick: Kick, pose: np.ndarray, goal: Goal, discs: np.ndarray, radius: float
) -> Optional[Kick]:
    """The planned kick, redirected to the line from the robot through the ball. None: the plan is to shoot at
    the goal, and this line misses it (or is nearly parallel to the goal line).

    :param kick: planned. :param pose: (3,) of the robot. :param discs: and radius as angular_tolerance()
    """
    off = kick.ball - pose[:2]
    along = off / np.linalg.norm(off)
    distance = float(np.linalg.norm(kick.target - kick.ball))
    if kick.is_final:
        toward = -float(along @ goal.normal)
        if toward < MIN_TOWARD_GOAL:
            return None
        distance = max(goal.distance_before(kick.ball), MIN_AIM) / toward
    target = kick.ball + distance * along
    if kick.is_final and abs(goal.lateral_offset(target)) > 0.5 * goal.width - 2.0 * radius:
        return None
    found = angular_tolerance(kick.ball, target, discs, radius)
    return kick._replace(target=target, start=pose[:2].copy(), tolerance=found)


def _most_tolerant(kicks: List[Kick], previous: Optional[Kick]) -> Optional[Kick]:
    """The kick with the largest tolerance; of equally good ones the one closest to the previous plan."""
    if not kicks:
        return None
    best = max(min(kick.tolerance, ENOUGH_TOLERANCE) for kick in kicks)
    good = [kick for kick in kicks if kick.tolerance >= best - 0.01]
    if previous is None:
        return good[0]
    return min(good, key=lambda kick: round(float(np.linalg.norm(kick.target - previous.target)), 2))
