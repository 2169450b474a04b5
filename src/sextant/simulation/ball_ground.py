# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A floor with walls, pillars, a ball that rolls and a robot that drives against it: all of them circles."""

import math
from dataclasses import astuple, dataclass
from typing import Iterator, List, NamedTuple, Optional, Sequence, Set, Tuple

import numpy as np

from sextant.base.strict_params import StrictParams, param, within
from sextant.simulation.motion import Motion
from sextant.simulation.odometry import OdometryNoise

STEP = 0.005  # seconds; at 1 m/s a tenth of a ball's radius
TRAVEL = 0.002  # metres that the robot has to go back before what it stood against is let go


@dataclass(frozen=True)
class BallParams(StrictParams):
    """A ball on a floor."""

    radius: float = param(0.05, within(1e-3, 1))  # metres
    rolling: float = param(0.35, within(0, 10))  # m/s^2 by which it slows down
    bounce: float = param(0.6, within(0, 1))  # share of the speed that it keeps where it hits something


def _shares(noise: OdometryNoise) -> str:
    return "" if all(0 <= each <= 1 for each in astuple(noise)) else "must each be within [0, 1]"


@dataclass(frozen=True)
class RobotParams(StrictParams):
    """A round robot on two wheels, far heavier than a ball. The figures are a Kobuki's."""

    radius: float = param(0.177, within(1e-3, 2))  # metres
    max_speed: float = param(0.7, within(1e-3, 10))  # m/s
    max_turn_rate: float = param(3.1, within(1e-3, 20))  # rad/s
    acceleration: float = param(1.0, within(1e-3, 100))  # m/s^2
    turn_acceleration: float = param(6.0, within(1e-3, 1000))  # rad/s^2
    slip: float = param(0.02, within(0, 1))  # share of way and turn that wheels lose all the time, at most
    noise: OdometryNoise = param(OdometryNoise(0.01, 0.01, 0.02), _shares)  # and what they lose by chance


class Pillar(NamedTuple):
    """It stands where it stands."""

    x: float  # metres, map
    y: float
    radius: float
    class_name: str


class Touch(NamedTuple):
    """The robot came up against something."""

    stamp: float  # seconds
    what: str  # "ball", "wall" or "pillar"
    bearing: float  # radians, from the robot's heading


class Contact(NamedTuple):
    """What the robot is near."""

    name: str  # that no other has
    what: str  # as Touch
    toward: np.ndarray  # (2,) unit, from the robot's middle
    gap: float  # metres between the two; less than 0: they overlap


class BallGround:
    """Robot and ball among pillars, in a rectangle whose middle is the map's origin."""

    def __init__(
        self,
        size: Tuple[float, float],
        pillars: Sequence[Pillar],
        ball: Optional[Tuple[float, float]],
        robot: Sequence[float],
        ball_params: Optional[BallParams] = None,
        drive: Optional[RobotParams] = None,
        seed: int = 0,
    ):
        """:param size: of the floor, metres. :param robot: (3,) x, y, yaw

        """
        self.ball_params, self.drive = ball_params or BallParams(), drive or RobotParams()
        self.half = 0.5 * np.asarray(size, float)
        self.pillars = list(pillars)
        self.stamp = 0.0
        self.ball = None if ball is None else np.array(ball, float)  # (2,) metres
        self.ball_velocity = np.zeros(2)  # m/s
        self.robot = Motion(float(robot[0]), float(robot[1]), 0.0, float(robot[2]))
        self.rolled = Motion(yaw=0.0)  # what the wheels did, from where the robot began
        self.touches: List[Touch] = []
        self._command = (0.0, 0.0)
        self._against: Set[str] = set()  # names of what the robot stands against
        self._random = np.random.default_rng([seed, 7])
        self._kept = 1.0 - self._random.uniform(0.0, self.drive.slip, 2)  # of way and turn

    def command(self, speed: float, turn_rate: float) -> None:
        """What the wheels shall do from now on: m/s and rad/s; more than they can is cut."""
        drive = self.drive
        self._command = (
            float(np.clip(speed, -drive.max_speed, drive.max_speed)),
            float(np.clip(turn_rate, -drive.max_turn_rate, drive.max_turn_rate)),
        )

    def advance(self, seconds: float) -> None:
        """Everything moves on, in steps of STEP."""
        for _ in range(round(seconds / STEP)):
            self._drive()
            self._roll()
            self._hit()
            self.stamp += STEP

    @property
    def ball_speed(self) -> float:
        """m/s"""
        return float(np.hypot(*self.ball_velocity))

    @property
    def is_bumped(self) -> bool:
        """Whether the robot stands against a wall or a pillar; it does until it goes back."""
        return bool(self._against)

    def _drive(self) -> None:
        drive, wheels = self.drive, self.rolled
        speed = _toward(wheels.speed, self._command[0], drive.acceleration * STEP)
        turn_rate = _toward(wheels.turn_rate, self._command[1], drive.turn_acceleration * STEP)
        self.rolled = Motion(wheels.x, wheels.y, 0.0, wheels.yaw, speed, turn_rate).after(STEP)
        moved = self._slipped(speed * STEP, turn_rate * STEP)
        at, freedom = np.array([moved.x, moved.y]), 1.0
        for contact in self._contacts(at):
            bearing = math.atan2(contact.toward[1], contact.toward[0]) - moved.yaw
            if self._stands_against(contact, bearing):
                at = at + min(contact.gap, 0.0) * contact.toward
                freedom -= math.cos(bearing) ** 2 if contact.gap < 0.0 else 0.0
        speed *= self._kept[0] * max(freedom, 0.0)
        self.robot = Motion(float(at[0]), float(at[1]), 0.0, moved.yaw, speed, turn_rate * self._kept[1])

    def _stands_against(self, contact: Contact, bearing: float) -> bool:
        """It does until it goes back; what it comes up against is noted."""
        is_known = contact.name in self._against
        stands = contact.gap < (TRAVEL if is_known else 0.0)
        if stands and not is_known:
            self._against.add(contact.name)
            self.touches.append(Touch(self.stamp, contact.what, math.remainder(bearing, 2.0 * math.pi)))
        elif is_known and not stands:
            self._against.remove(contact.name)
        return stands

    def _slipped(self, way: float, turn: float) -> Motion:
        """Where the robot comes to when its wheels go so far (metres, radians)."""
        robot = self.robot
        moved = self._kept * (way, turn)
        if way or turn:
            moved += self.drive.noise.deviations(way, turn) * self._random.standard_normal(2)
        return Motion(robot.x, robot.y, 0.0, robot.yaw, *moved).after(1.0)

    def _contacts(self, at: np.ndarray) -> Iterator[Contact]:
        """Walls and pillars, which do not yield, about a robot there."""
        radius = self.drive.radius
        for number, pillar in enumerate(self.pillars):
            off = (pillar.x, pillar.y) - at
            apart = max(math.hypot(*off), 1e-9)
            yield Contact(f"pillar {number}", "pillar", off / apart, apart - radius - pillar.radius)
        for axis in range(2):
            toward = np.zeros(2)
            toward[axis] = math.copysign(1.0, at[axis])
            gap = self.half[axis] - radius - abs(at[axis])
            yield Contact(f"wall {axis} {toward[axis]:+.0f}", "wall", toward, gap)

    def _roll(self) -> None:
        if self.ball is None:
            return
        speed = self.ball_speed
        if speed > 0.0:
            slowed = max(0.0, speed - self.ball_params.rolling * STEP)
            self.ball += 0.5 * (1.0 + slowed / speed) * self.ball_velocity * STEP
            self.ball_velocity *= slowed / speed

    def _hit(self) -> None:
        """What the ball comes up against throws it back."""
        if self.ball is None:
            return
        robot, radius = self.robot, self.ball_params.radius
        at = np.array([robot.x, robot.y])
        velocity = robot.speed * np.array([math.cos(robot.yaw), math.sin(robot.yaw)])
        if self._bounce(at, radius + self.drive.radius, velocity):
            off = self.ball - at
            bearing = math.remainder(math.atan2(off[1], off[0]) - robot.yaw, 2.0 * math.pi)
            self.touches.append(Touch(self.stamp, "ball", bearing))
        for pillar in self.pillars:
            self._bounce(np.array([pillar.x, pillar.y]), radius + pillar.radius, np.zeros(2))
        self._bounce_off_walls()

    def _bounce_off_walls(self) -> None:
        for axis in range(2):
            over = abs(self.ball[axis]) - (self.half[axis] - self.ball_params.radius)
            if over > 0.0:
                sign = math.copysign(1.0, self.ball[axis])
                self.ball[axis] -= sign * over
                if sign * self.ball_velocity[axis] > 0.0:
                    self.ball_velocity[axis] *= -self.ball_params.bounce

    def _bounce(self, center: np.ndarray, apart: float, velocity: np.ndarray) -> bool:
        """Off something heavy and round. Whether it was hit."""
        off = self.ball - center
        distance = math.hypot(*off)
        if distance >= apart:
            return False
        normal = off / max(distance, 1e-9)
        self.ball = center + apart * normal
        closing = float(normal @ (velocity - self.ball_velocity))
        if closing <= 0.0:
            return False
        self.ball_velocity = self.ball_velocity + (1.0 + self.ball_params.bounce) * closing * normal
        return True


def _toward(value: float, wanted: float, most: float) -> float:
    return value + min(max(wanted - value, -most), most)
