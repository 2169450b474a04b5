# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Simulated planar world with landmarks of several classes, and a robot with odometry and a landmark sensor.

Everything is drawn from the seed. The published covariances are those of the simulated noise.
"""

from collections import deque
from dataclasses import dataclass
from typing import Deque, Iterator, List, NamedTuple, Optional, Tuple

import numpy as np

import sextant
from sextant.base.strict_params import Check, ParamError, StrictParams, param, within
from sextant.geometry.plane_poses import composed, in_frame, rotation

COLOURS = ("blue", "red", "yellow", "green", "orange", "purple", "white", "black")
STAMP_TOLERANCE = 1e-9  # maximum difference of stamps that count as equal, seconds


@dataclass(frozen=True)
class LandmarkWorldParams(StrictParams):
    """Parameters of world, robot and sensor."""

    seed: int = param(0, "random seed of the world, the path and all noise", within(0, 2**31 - 1))
    landmarks: int = param(15, "number of landmarks", within(0, 10000))
    classes: int = param(
        3,
        "number of classes: `blue_pillar`, `red_pillar`, `yellow_pillar`, green, orange, purple, "
        "white, black, `blue_pillar_2` …",
        within(1, 1000),
    )
    half_side: float = param(
        8.0, "half the side of the square in which the landmarks are", within(1, 1e5), "m"
    )
    min_separation: float = param(1.0, "minimum distance between two landmarks", within(0, 100), "m")
    duration: float = param(
        300.0,
        "simulated duration of the drive; afterwards only the clock is published",
        Check("(0, 1e6]", within(1e-9, 1e6)),
        "s",
    )
    odometry_rate: float = param(20.0, "rate of odometry", Check("(0, 1000]", within(1e-9, 1000)), "Hz")
    sensor_rate: float = param(5.0, "rate of observations", Check("(0, 1000]", within(1e-9, 1000)), "Hz")
    speed: float = param(0.5, "speed of the random motion", within(0, 100), "m/s")
    turn_rate: float = param(0.8, "maximum turn rate of the random motion", within(0, 10), "rad/s")
    max_range: float = param(5.0, "maximum range of the sensor", Check("(0, 1e5]", within(1e-9, 1e5)), "m")
    field_of_view: float = param(
        1.6, "field of view of the sensor", Check("(0, 2π]", within(1e-9, 6.2832)), "rad"
    )
    range_noise: Tuple[float, float] = param(
        (0.02, 0.005),
        "standard deviation of the range: constant part, and factor of the squared range",
        unit="m, 1/m",
    )
    bearing_noise: float = param(0.02, "standard deviation of the bearing", within(0, 1), "rad")
    detection_probability: float = param(
        1.0, "probability that the sensor detects a landmark in view", Check("(0, 1]", within(1e-9, 1))
    )
    false_alarm_probability: float = param(
        0.0, "probability of a false alarm per detection", Check("[0, 1)", within(0, 1 - 1e-9))
    )
    delay: float = param(0.0, "delay of observations", within(0, 10), "s")
    clock_offset: float = param(
        0.0,
        "offset by which the stamps of observations are too early: the correct `clock_offset` of "
        "landmark_slam",
        within(-10, 10),
        "s",
    )
    rotation_from_rotation: float = param(
        0.03, "odometry noise, as in [landmark_slam](#landmark_slam)", within(0, 1), "rad"
    )
    rotation_from_translation: float = param(
        0.02, "odometry noise, as in [landmark_slam](#landmark_slam)", within(0, 1), "rad"
    )
    translation_from_translation: float = param(
        0.03, "odometry noise, as in [landmark_slam](#landmark_slam)", within(0, 1), "m"
    )
    translation_from_rotation: float = param(
        0.01, "odometry noise, as in [landmark_slam](#landmark_slam)", within(0, 1), "m"
    )
    lateral_from_translation: float = param(
        0.01, "odometry noise, as in [landmark_slam](#landmark_slam)", within(0, 1), "m"
    )
    scale: float = param(
        1.0, "ratio of the distance that odometry measures to the true distance", within(0.1, 10)
    )
    turn_scale: float = param(
        1.0, "ratio of the angle that odometry measures to the true angle", within(0.1, 10)
    )
    lead: float = param(
        0.0, "time by which odometry leads the motion, as where it is the command", within(0, 10), "s"
    )
    gross_error_probability: float = param(0.0, "probability that a range has a gross error", within(0, 1))
    gross_error: float = param(2.0, "largest gross error of the range", within(0, 1000), "m")
    bearing_offset: float = param(0.0, "error of the sensor's mount", within(-1, 1), "rad")
    gap_probability: float = param(
        0.0, "probability per minute that the sensor detects nothing for a while", within(0, 60), "1/min"
    )
    shortest_gap: float = param(2.0, "duration of the shortest gap", within(0.1, 3600), "s")
    longest_gap: float = param(60.0, "duration of the longest gap", within(0.1, 3600), "s")
    jump_probability: float = param(
        0.0,
        "probability that a detection jumps towards a neighbour: it is between both landmarks of a class",
        within(0, 1),
    )
    jump_distance: float = param(
        1.0, "largest distance of a neighbour that a detection jumps to", within(0, 100), "m"
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.longest_gap < self.shortest_gap:
            raise ParamError("longest_gap", "must be at least", self.longest_gap, "shortest_gap")

    def odometry_noise(self) -> "sextant.OdometryNoiseParams":
        """Noise parameters of the steps that odometry measures."""
        noise = sextant.OdometryNoiseParams()
        for name in (
            "rotation_from_rotation",
            "rotation_from_translation",
            "translation_from_translation",
            "translation_from_rotation",
            "lateral_from_translation",
        ):
            setattr(noise, name, getattr(self, name))
        return noise


class SimulatedObservation(NamedTuple):
    """A measurement of the sensor, in the robot frame."""

    position: np.ndarray  # (2,) metres
    covariance: np.ndarray  # (2, 2) of the sensor noise, m^2
    class_name: str  # of the landmark
    truth: Optional[int]  # index of the landmark; None: a false alarm


class LandmarkScan(NamedTuple):
    """All measurements of the sensor at one stamp; empty if nothing was detected."""

    stamp: float  # seconds, by the sensor's clock
    observations: List[SimulatedObservation]  # in the robot frame


class SimulationStep(NamedTuple):
    """One odometry reading, and the scan that arrives with it."""

    stamp: float  # seconds
    pose: np.ndarray  # (3,) x, y, heading in the map
    odometry_step: np.ndarray  # (3,) x, y, yaw measured by odometry, in the robot frame at the previous step
    noise: np.ndarray  # (3, 3) covariance of the odometry step, in the same frame
    scan: Optional[LandmarkScan]  # None: no scan arrives
    speed: float  # m/s, forward, during the step
    turn_rate: float  # rad/s, during the step


class LandmarkWorld:
    """Landmarks in the plane; every call of steps() gives the same drive with the same noise."""

    def __init__(self, params: LandmarkWorldParams):
        """:raises ValueError: a parameter is out of range, or there is no room for the landmarks"""
        self.params = params
        rng = np.random.default_rng([params.seed, 0])
        self.positions = _scattered(rng, params)  # (n, 2) metres
        self.classes = [class_name(number % params.classes) for number in range(params.landmarks)]
        self.start = self.random_pose(rng)

    def steps(self) -> Iterator[SimulationStep]:
        """Yields all steps of the drive."""
        drive = LandmarkDrive(self)
        for _ in range(round(self.params.duration * self.params.odometry_rate)):
            yield drive.advance()

    def random_pose(self, rng: np.random.Generator) -> np.ndarray:
        """Draws a pose (3,) in the middle of the world."""
        return np.array([*rng.uniform(-0.4, 0.4, 2) * self.params.half_side, rng.uniform(-np.pi, np.pi)])

    def sense(self, rng: np.random.Generator, pose: np.ndarray) -> List[SimulatedObservation]:
        """Draws the measurements of the sensor at a pose (3,)."""
        positions = in_frame(pose, self.positions)
        bearings, params = np.arctan2(positions[:, 1], positions[:, 0]), self.params
        is_near = np.hypot(*positions.T) <= params.max_range
        observations = []
        for number in np.flatnonzero(is_near & (abs(bearings) <= params.field_of_view / 2)):
            if rng.random() >= 1 - params.detection_probability:
                position = self._jumped(rng, positions, int(number))
                observations.append(self._measured(rng, position, self.classes[number], int(number)))
        for _ in range(len(observations)):
            if rng.random() < params.false_alarm_probability:
                observations.append(self._false_alarm(rng))
        return observations

    def _measured(
        self, rng: np.random.Generator, position: np.ndarray, class_name: str, truth: Optional[int]
    ) -> SimulatedObservation:
        """Adds range and bearing noise to a position (2,) in the robot frame."""
        distance, bearing = np.hypot(*position), np.arctan2(position[1], position[0])
        constant, quadratic = self.params.range_noise
        deviations = np.array([constant + quadratic * distance**2, self.params.bearing_noise * distance])
        axes = rotation(bearing)
        covariance = axes @ np.diag(deviations**2) @ axes.T
        measured = position + axes @ (deviations * rng.standard_normal(2))
        if _happens(rng, self.params.gross_error_probability):
            measured = measured + axes[:, 0] * rng.uniform(-1, 1) * self.params.gross_error
        measured = rotation(self.params.bearing_offset) @ measured
        return SimulatedObservation(measured, covariance, class_name, truth)

    def _jumped(self, rng: np.random.Generator, positions: np.ndarray, number: int) -> np.ndarray:
        """Position (2,) of a detection in the frame of the positions (n, 2)."""
        if not _happens(rng, self.params.jump_probability):
            return positions[number]
        distances = np.hypot(*(positions - positions[number]).T)
        distances[[name != self.classes[number] for name in self.classes]] = np.inf
        distances[number] = np.inf
        nearest = int(distances.argmin())
        part = rng.random() if distances[nearest] <= self.params.jump_distance else 0.0
        return (1 - part) * positions[number] + part * positions[nearest]

    def _false_alarm(self, rng: np.random.Generator) -> SimulatedObservation:
        bearing = rng.uniform(-0.5, 0.5) * self.params.field_of_view
        distance = self.params.max_range * np.sqrt(rng.uniform(0.01, 1))
        position = distance * np.array([np.cos(bearing), np.sin(bearing)])
        return self._measured(rng, position, class_name(rng.integers(self.params.classes)), None)


class LandmarkDrive:
    """Simulates a robot in a landmark world step by step."""

    def __init__(self, world: LandmarkWorld):
        self._world, self._pose, self._noise = world, world.start, world.params.odometry_noise()
        self._rng = np.random.default_rng([world.params.seed, 1])
        self._number, self._turn_rate = 0, 0.0
        self._delayed: Deque[LandmarkScan] = deque()
        params = world.params
        self._commands = deque([(0.0, 0.0)] * round(params.lead * params.odometry_rate))
        self._detects_from = 0.0  # stamp of the end of a gap

    def advance(self, command: Optional[Tuple[float, float]] = None) -> SimulationStep:
        """Simulates the next odometry step.

        :param command: speed (m/s) and turn rate (rad/s); None: random motion
        """
        params = self._world.params
        self._number += 1
        stamp = self._number / params.odometry_rate
        commanded = self._wandering() if command is None else command
        self._commands.append(commanded)
        speed, turn_rate = self._commands.popleft()
        self._pose = composed(self._pose, np.array([speed, 0.0, turn_rate]) / params.odometry_rate)
        step = np.array([commanded[0], 0.0, commanded[1]]) / params.odometry_rate
        noise = sextant.odometry_step_noise(step, self._noise)
        error = np.sqrt(np.diag(noise)) * self._rng.standard_normal(3)
        measured = composed(error, step * (params.scale, params.scale, params.turn_scale))
        if self._number % max(1, round(params.odometry_rate / params.sensor_rate)) == 0:
            observations = [] if self._is_in_gap(stamp) else self._world.sense(self._rng, self._pose)
            self._delayed.append(LandmarkScan(stamp - params.clock_offset, observations))
        return SimulationStep(stamp, self._pose, measured, noise, self._arrived(stamp), speed, turn_rate)

    def kidnap(self) -> float:
        """Moves the robot to a random pose; odometry does not measure it.

        :returns: distance between the poses, metres
        """
        before, self._pose = self._pose, self._world.random_pose(self._rng)
        return float(np.hypot(*(self._pose - before)[:2]))

    def _is_in_gap(self, stamp: float) -> bool:
        """Whether the sensor detects nothing; durations of gaps are log-uniform."""
        params = self._world.params
        if _happens(self._rng, params.gap_probability / 60 / params.sensor_rate):
            duration = np.exp(self._rng.uniform(np.log(params.shortest_gap), np.log(params.longest_gap)))
            self._detects_from = max(self._detects_from, stamp + duration)
        return stamp < self._detects_from

    def _arrived(self, stamp: float) -> Optional[LandmarkScan]:
        """The scan that arrives at this stamp; at most one, as scans are not more frequent than odometry."""
        waiting, params = self._delayed, self._world.params
        latency = params.clock_offset + params.delay - STAMP_TOLERANCE
        return waiting.popleft() if waiting and waiting[0].stamp + latency <= stamp else None

    def _wandering(self) -> Tuple[float, float]:
        """Speed and turn rate of random motion; turns to the centre before the robot leaves the world."""
        params, limit = self._world.params, self._world.params.turn_rate
        if np.hypot(*self._pose[:2]) > 0.75 * params.half_side:
            inwards = np.arctan2(-self._pose[1], -self._pose[0]) - self._pose[2]
            self._turn_rate = limit if np.sin(inwards) > 0 else -limit
        elif (self._number - 1) % max(1, round(2 * params.odometry_rate)) == 0:
            self._turn_rate = self._rng.uniform(-limit, limit)
        return params.speed, self._turn_rate


def _happens(rng: np.random.Generator, probability: float) -> bool:
    """Draws nothing if it is impossible: worlds without this fault stay as they are."""
    return probability > 0 and rng.random() < probability


def class_name(number: int) -> str:
    """Name of a class: coloured pillars, numbered where the colours repeat."""
    colour = COLOURS[number % len(COLOURS)]
    return f"{colour}_pillar" if number < len(COLOURS) else f"{colour}_pillar_{number // len(COLOURS) + 1}"


def _scattered(rng: np.random.Generator, params: LandmarkWorldParams) -> np.ndarray:
    """Draws positions (n, 2), metres, with the minimum separation."""
    points = np.empty((0, 2))
    for _ in range(1000 * (params.landmarks + 1)):
        if len(points) == params.landmarks:
            return points
        point = rng.uniform(-params.half_side, params.half_side, 2)
        if not len(points) or np.hypot(*(points - point).T).min() >= params.min_separation:
            points = np.vstack([points, point])
    raise ValueError(
        f"{params.landmarks} landmarks {params.min_separation:g} m apart do not fit into a square of "
        f"{2 * params.half_side:g} m: fewer landmarks, a smaller min_separation or a larger half_side"
    )
