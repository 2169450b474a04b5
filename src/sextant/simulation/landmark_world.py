# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A simulated plane with landmarks of several classes, a robot that wanders among them, and what it measures.

Everything is drawn from the seed. The noise that is drawn is the noise that is told.
"""

from collections import deque
from dataclasses import dataclass
from typing import Deque, Iterator, List, NamedTuple, Optional, Tuple

import numpy as np

import sextant
from sextant.base.strict_params import StrictParams, param, within
from sextant.geometry.plane_poses import composed, in_frame, rotation

COLOURS = ("blue", "red", "yellow", "green", "orange", "purple", "white", "black")
TINY = 1e-9  # seconds: stamps that are one may differ by it


@dataclass(frozen=True)
class LandmarkWorldParams(StrictParams):
    """Of world, robot and sensor."""

    seed: int = param(0, within(0, 2**31 - 1))
    landmarks: int = param(15, within(0, 10000))
    classes: int = param(3, within(1, 1000))
    half_side: float = param(8.0, within(1, 1e5))  # metres; landmarks stand in the square of twice this
    separation: float = param(1.0, within(0, 100))  # metres; no two are nearer
    duration: float = param(300.0, within(1e-9, 1e6))  # seconds
    odometry_rate: float = param(20.0, within(1e-9, 1000))  # Hz
    sensor_rate: float = param(5.0, within(1e-9, 1000))  # Hz
    speed: float = param(0.5, within(0, 100))  # m/s
    turn_rate: float = param(0.8, within(0, 10))  # rad/s, at most
    max_range: float = param(5.0, within(1e-9, 1e5))  # metres, that are seen
    field_of_view: float = param(1.6, within(1e-9, 6.2832))  # radians
    range_noise: Tuple[float, float] = (0.02, 0.005)  # metres: always, and more with every squared metre
    bearing_noise: float = param(0.02, within(0, 1))  # radians
    missed: float = param(0.0, within(0, 1 - 1e-9))  # of what could be seen
    phantoms: float = param(0.0, within(0, 1 - 1e-9))  # probability of a false one with each sighting
    delay: float = param(0.0, within(0, 10))  # seconds from a look to its arrival
    clock_offset: float = param(0.0, within(-10, 10))  # seconds to add to the stamps of sightings
    turn_by_turn: float = param(0.03, within(0, 1))  # as sextant.OdometryNoiseParams, so are the next four
    turn_by_way: float = param(0.02, within(0, 1))
    way_by_way: float = param(0.03, within(0, 1))
    way_by_turn: float = param(0.01, within(0, 1))
    aside_by_way: float = param(0.01, within(0, 1))
    scale: float = param(1.0, within(0.1, 10))  # what odometry measures of a metre

    def odometry_noise(self) -> "sextant.OdometryNoiseParams":
        """Of the steps that odometry measures."""
        noise = sextant.OdometryNoiseParams()
        for name in ("turn_by_turn", "turn_by_way", "way_by_way", "way_by_turn", "aside_by_way"):
            setattr(noise, name, getattr(self, name))
        return noise


class SeenLandmark(NamedTuple):
    """What a sensor says, in the robot frame."""

    position: np.ndarray  # (2,) metres
    covariance: np.ndarray  # (2, 2) of the sensor
    class_name: str
    truth: Optional[int]  # which landmark; None: a phantom


class Look(NamedTuple):
    """What the sensor saw at one moment; nothing, where nothing was in view."""

    stamp: float  # seconds, by the sensor's clock
    sightings: List[SeenLandmark]


class WorldMoment(NamedTuple):
    """An instant of odometry, and what arrives of the sensor then."""

    stamp: float  # seconds
    pose: np.ndarray  # (3,) x, y, heading in the map
    step: np.ndarray  # (3,) by odometry since the last moment, in the robot frame then
    noise: np.ndarray  # (3, 3) covariance of the step, felt where it begins
    look: Optional[Look]  # None: nothing arrives
    speed: float  # m/s, forward, that brought it here
    turn_rate: float  # rad/s


class LandmarkWorld:
    """The landmarks stay; every call of moments() drives anew, with the same noise."""

    def __init__(self, params: LandmarkWorldParams):
        """:raises ValueError: a parameter out of range, or landmarks that find no room"""
        self.params = params
        rng = np.random.default_rng([params.seed, 0])
        self.positions = _scattered(rng, params)  # (n, 2) metres
        self.classes = [class_name(number % params.classes) for number in range(params.landmarks)]
        self.start = self.place(rng)

    def moments(self) -> Iterator[WorldMoment]:
        """From the start to the end."""
        drive = LandmarkDrive(self)
        for _ in range(round(self.params.duration * self.params.odometry_rate)):
            yield drive.advance()

    def place(self, rng: np.random.Generator) -> np.ndarray:
        """A pose (3,) anywhere in the middle of the world."""
        return np.array([*rng.uniform(-0.4, 0.4, 2) * self.params.half_side, rng.uniform(-np.pi, np.pi)])

    def seen(self, rng: np.random.Generator, pose: np.ndarray) -> List[SeenLandmark]:
        """What the sensor says at a pose (3,)."""
        positions = in_frame(pose, self.positions)
        bearings, params = np.arctan2(positions[:, 1], positions[:, 0]), self.params
        is_near = np.hypot(*positions.T) <= params.max_range
        found = []
        for number in np.flatnonzero(is_near & (abs(bearings) <= params.field_of_view / 2)):
            if rng.random() >= params.missed:
                found.append(self._measured(rng, positions[number], self.classes[number], int(number)))
        for _ in range(len(found)):
            if rng.random() < params.phantoms:
                found.append(self._phantom(rng))
        return found

    def _measured(
        self, rng: np.random.Generator, position: np.ndarray, class_name: str, truth: Optional[int]
    ) -> SeenLandmark:
        distance, bearing = np.hypot(*position), np.arctan2(position[1], position[0])
        near, more = self.params.range_noise
        deviations = np.array([near + more * distance**2, self.params.bearing_noise * distance])
        axes = rotation(bearing)
        covariance = axes @ np.diag(deviations**2) @ axes.T
        measured = position + axes @ (deviations * rng.standard_normal(2))
        return SeenLandmark(measured, covariance, class_name, truth)

    def _phantom(self, rng: np.random.Generator) -> SeenLandmark:
        bearing = rng.uniform(-0.5, 0.5) * self.params.field_of_view
        distance = self.params.max_range * np.sqrt(rng.uniform(0.01, 1))
        position = distance * np.array([np.cos(bearing), np.sin(bearing)])
        return self._measured(rng, position, class_name(rng.integers(self.params.classes)), None)


class LandmarkDrive:
    """A robot in a landmark world, moment by moment."""

    def __init__(self, world: LandmarkWorld):
        self._world, self._pose, self._noise = world, world.start, world.params.odometry_noise()
        self._rng = np.random.default_rng([world.params.seed, 1])
        self._number, self._turn_rate = 0, 0.0
        self._on_their_way: Deque[Look] = deque()

    def advance(self, command: Optional[Tuple[float, float]] = None) -> WorldMoment:
        """The next moment of odometry.

        :param command: speed (m/s) and turn rate (rad/s) until then; None: it wanders
        """
        params = self._world.params
        self._number += 1
        stamp = self._number / params.odometry_rate
        speed, turn_rate = self._wandering() if command is None else command
        step = np.array([speed, 0.0, turn_rate]) / params.odometry_rate
        self._pose = composed(self._pose, step)
        noise = sextant.odometry_step_noise(step, self._noise)
        felt = np.sqrt(np.diag(noise)) * self._rng.standard_normal(3)
        measured = composed(felt, step * (params.scale, params.scale, 1))
        if self._number % max(1, round(params.odometry_rate / params.sensor_rate)) == 0:
            look = Look(stamp - params.clock_offset, self._world.seen(self._rng, self._pose))
            self._on_their_way.append(look)
        return WorldMoment(stamp, self._pose, measured, noise, self._arrived(stamp), speed, turn_rate)

    def carry(self) -> float:
        """Somebody puts the robot elsewhere; its wheels do not turn.

        :returns: how far, metres
        """
        before, self._pose = self._pose, self._world.place(self._rng)
        return float(np.hypot(*(self._pose - before)[:2]))

    def _arrived(self, stamp: float) -> Optional[Look]:
        """Looks are no more frequent than moments are: never two at one."""
        waiting, params = self._on_their_way, self._world.params
        late = params.clock_offset + params.delay - TINY
        return waiting.popleft() if waiting and waiting[0].stamp + late <= stamp else None

    def _wandering(self) -> Tuple[float, float]:
        """Turns back to the middle before it leaves the world."""
        params, most = self._world.params, self._world.params.turn_rate
        if np.hypot(*self._pose[:2]) > 0.75 * params.half_side:
            inwards = np.arctan2(-self._pose[1], -self._pose[0]) - self._pose[2]
            self._turn_rate = most if np.sin(inwards) > 0 else -most
        elif (self._number - 1) % max(1, round(2 * params.odometry_rate)) == 0:
            self._turn_rate = self._rng.uniform(-most, most)
        return params.speed, self._turn_rate


def class_name(number: int) -> str:
    """Pillars of one colour, as long as there are colours."""
    colour = COLOURS[number % len(COLOURS)]
    return f"{colour}_pillar" if number < len(COLOURS) else f"{colour}_pillar_{number // len(COLOURS) + 1}"


def _scattered(rng: np.random.Generator, params: LandmarkWorldParams) -> np.ndarray:
    """(n, 2) no two nearer than the separation."""
    points = np.empty((0, 2))
    for _ in range(1000 * (params.landmarks + 1)):
        if len(points) == params.landmarks:
            return points
        point = rng.uniform(-params.half_side, params.half_side, 2)
        if not len(points) or np.hypot(*(points - point).T).min() >= params.separation:
            points = np.vstack([points, point])
    raise ValueError(
        f"{params.landmarks} landmarks {params.separation:g} m apart find no room in a square of "
        f"{2 * params.half_side:g} m: fewer of them, a smaller separation or a larger half_side"
    )
