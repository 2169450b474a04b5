# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Planar physics of a room with walls, round pillars, a rolling ball and a round robot."""

import math
from dataclasses import dataclass
from typing import Iterator, List, NamedTuple, Optional, Sequence, Set, Tuple

import numpy as np

from sextant.base.strict_params import StrictParams, param, within
from sextant.simulation.motion import Motion
from sextant.simulation.odometry import OdometryNoise

STEP = 0.005  # time step, seconds; a ball at 1 m/s moves a tenth of its radius
RELEASE_DISTANCE = 0.002  # distance that the robot must back off to release the bumper, metres


@dataclass(frozen=True)
class BallParams(StrictParams):
    """A ball on a floor."""

    radius: float = param(0.05, "radius of the ball", within(1e-3, 1), "m")
    deceleration: float = param(0.35, "deceleration of a rolling ball", within(0, 10), "m/s²")
    restitution: float = param(0.6, "coefficient of restitution of the ball", within(0, 1))


@dataclass(frozen=True)
class RobotParams(StrictParams):
    """A round differential drive, much heavier than a ball. Defaults are those of a Kobuki."""

    radius: float = param(0.177, "radius of the robot", within(1e-3, 2), "m")
    max_speed: float = param(0.7, "maximum speed", within(1e-3, 10), "m/s")
    max_turn_rate: float = param(3.1, "maximum turn rate", within(1e-3, 20), "rad/s")
    acceleration: float = param(1.0, "acceleration", within(1e-3, 100), "m/s²")
    turn_acceleration: float = param(6.0, "angular acceleration", within(1e-3, 1000), "rad/s²")
    slip: float = param(0.02, "maximum slip of the wheels, as a fraction of distance and turn", within(0, 1))
    noise: OdometryNoise = OdometryNoise(0.01, 0.01, 0.02)  # of the random slip


class Pillar(NamedTuple):
    """A fixed pillar."""

    x: float  # in the map, metres
    y: float  # in the map, metres
    radius: float  # metres
    class_name: str  # contains its colour


class Touch(NamedTuple):
    """The start of a contact of the robot with the ball, a wall or a pillar."""

    stamp: float  # seconds
    what: str  # "ball", "wall" or "pillar"
    bearing: float  # radians, from the robot's heading


class Contact(NamedTuple):
    """An obstacle that the robot may touch."""

    name: str  # unique
    what: str  # as Touch.what
    toward: np.ndarray  # (2,) unit vector from the robot's centre to the obstacle
    gap: float  # metres; negative: overlap


class BallGround:
    """Robot and ball among pillars, in a rectangle centred on the map's origin."""

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
        """:param size: of the floor, metres

        :param ball: x and y, metres; None: no ball
        :param robot: (3,) x, y, yaw, metres and radians
        :param seed: of the slip
        """
        self.ball_params, self.drive = ball_params or BallParams(), drive or RobotParams()
        self.half = 0.5 * np.asarray(size, float)
        self.pillars = list(pillars)
        self.stamp = 0.0
        self.ball = None if ball is None else np.array(ball, float)  # (2,) metres
        self.ball_velocity = np.zeros(2)  # m/s
        self.robot = Motion(float(robot[0]), float(robot[1]), 0.0, float(robot[2]))
        self.rolled = Motion(yaw=0.0)  # motion of the wheels since the start, without slip
        self.touches: List[Touch] = []
        self._command = (0.0, 0.0)
        self._pressed: Set[str] = set()  # names of the obstacles in contact
        self._random = np.random.default_rng([seed, 7])
        self._kept = 1.0 - self._random.uniform(0.0, self.drive.slip, 2)  # of distance and turn

    def command(self, speed: float, turn_rate: float) -> None:
        """Sets the command (m/s and rad/s), clipped to the limits."""
        drive = self.drive
        self._command = (
            float(np.clip(speed, -drive.max_speed, drive.max_speed)),
            float(np.clip(turn_rate, -drive.max_turn_rate, drive.max_turn_rate)),
        )

    def advance(self, seconds: float) -> None:
        """Advances the simulation by a time (seconds) in steps of STEP."""
        for _ in range(round(seconds / STEP)):
            self._drive()
            self._roll()
            self._hit()
            self.stamp += STEP

    @property
    def ball_speed(self) -> float:
        """Speed of the ball, m/s."""
        return float(np.hypot(*self.ball_velocity))

    @property
    def is_bumped(self) -> bool:
        """Whether the robot is in contact with a wall or a pillar; contact ends when it backs off."""
        return bool(self._pressed)

    def _drive(self) -> None:
        """Moves wheels and robot by one step; obstacles push the robot back."""
        drive, wheels = self.drive, self.rolled
        speed = _limited_step(wheels.speed, self._command[0], drive.acceleration * STEP)
        turn_rate = _limited_step(wheels.turn_rate, self._command[1], drive.turn_acceleration * STEP)
        self.rolled = Motion(wheels.x, wheels.y, 0.0, wheels.yaw, speed, turn_rate).after(STEP)
        moved = self._moved_with_slip(speed * STEP, turn_rate * STEP)
        at, freedom = np.array([moved.x, moved.y]), 1.0
        for contact in self._contacts(at):
            bearing = math.atan2(contact.toward[1], contact.toward[0]) - moved.yaw
            if self._is_pressing(contact, bearing):
                at = at + min(contact.gap, 0.0) * contact.toward
                freedom -= math.cos(bearing) ** 2 if contact.gap < 0.0 else 0.0
        speed *= self._kept[0] * max(freedom, 0.0)
        self.robot = Motion(float(at[0]), float(at[1]), 0.0, moved.yaw, speed, turn_rate * self._kept[1])

    def _is_pressing(self, contact: Contact, bearing: float) -> bool:
        """Whether a contact persists (until the robot backs off); records new contacts as touches."""
        is_known = contact.name in self._pressed
        persists = contact.gap < (RELEASE_DISTANCE if is_known else 0.0)
        if persists and not is_known:
            self._pressed.add(contact.name)
            self.touches.append(Touch(self.stamp, contact.what, math.remainder(bearing, 2.0 * math.pi)))
        elif is_known and not persists:
            self._pressed.remove(contact.name)
        return persists

    def _moved_with_slip(self, distance: float, turn: float) -> Motion:
        """Motion of the robot after its wheels moved by a distance (metres) and a turn (radians)."""
        robot = self.robot
        moved = self._kept * (distance, turn)
        if distance or turn:
            moved += self.drive.noise.deviations(distance, turn) * self._random.standard_normal(2)
        return Motion(robot.x, robot.y, 0.0, robot.yaw, *moved).after(1.0)

    def _contacts(self, at: np.ndarray) -> Iterator[Contact]:
        """Contacts with walls and pillars of a robot at a point (2,)."""
        radius = self.drive.radius
        for number, pillar in enumerate(self.pillars):
            offset = (pillar.x, pillar.y) - at
            apart = max(math.hypot(*offset), 1e-9)
            yield Contact(f"pillar {number}", "pillar", offset / apart, apart - radius - pillar.radius)
        for axis in range(2):
            toward = np.zeros(2)
            toward[axis] = math.copysign(1.0, at[axis])
            gap = self.half[axis] - radius - abs(at[axis])
            yield Contact(f"wall {axis} {toward[axis]:+.0f}", "wall", toward, gap)

    def _roll(self) -> None:
        """Moves and slows the ball by one step."""
        if self.ball is None:
            return
        speed = self.ball_speed
        if speed > 0.0:
            slowed = max(0.0, speed - self.ball_params.deceleration * STEP)
            self.ball += 0.5 * (1.0 + slowed / speed) * self.ball_velocity * STEP
            self.ball_velocity *= slowed / speed

    def _hit(self) -> None:
        """Collides the ball with robot, pillars and walls."""
        if self.ball is None:
            return
        robot, radius = self.robot, self.ball_params.radius
        at = np.array([robot.x, robot.y])
        velocity = robot.speed * np.array([math.cos(robot.yaw), math.sin(robot.yaw)])
        if self._bounce(at, radius + self.drive.radius, velocity):
            offset = self.ball - at
            bearing = math.remainder(math.atan2(offset[1], offset[0]) - robot.yaw, 2.0 * math.pi)
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
                    self.ball_velocity[axis] *= -self.ball_params.restitution

    def _bounce(self, center: np.ndarray, apart: float, velocity: np.ndarray) -> bool:
        """Collides the ball with a heavy, round object; returns whether they were closing in.

        :param apart: sum of both radii, metres
        """
        offset = self.ball - center
        distance = math.hypot(*offset)
        if distance >= apart:
            return False
        normal = offset / max(distance, 1e-9)
        self.ball = center + apart * normal
        closing = float(normal @ (velocity - self.ball_velocity))
        if closing <= 0.0:
            return False
        self.ball_velocity = self.ball_velocity + (1.0 + self.ball_params.restitution) * closing * normal
        return True


def _limited_step(value: float, wanted: float, max_step: float) -> float:
    return value + min(max(wanted - value, -max_step), max_step)
