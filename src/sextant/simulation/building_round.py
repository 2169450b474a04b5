# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot that drives its rounds in a simulated building, and is carried to another place now and then.

Photos are not rendered: the answers of place_localizer are drawn. They are calibrated, and wrong ones are of
the place that looks the same; what is drawn holds for some seconds, since consecutive photos err alike.
"""

from dataclasses import dataclass
from typing import Iterator, List, NamedTuple, Optional, Tuple

import numpy as np

import sextant
from sextant.base.strict_params import StrictParams, param, within
from sextant.geometry.plane_poses import composed, wrapped
from sextant.simulation.building import Building, observed_markers, observed_pillars

Place = Tuple[np.ndarray, np.ndarray, float]  # pose (3,), covariance (3, 3), probability
PLACE_SIGMAS = np.array([0.3, 0.3, 0.08])  # metres, metres, radians
NEAR_NODE = 0.25  # metres
TURN_GAIN, TURN_RATE = 2.0, 1.0  # 1/s; rad/s


@dataclass(frozen=True)
class RoundParams(StrictParams):
    """Parameters of a round."""

    seed: int = param(0, "random seed of the route and of all noise", within(0, 2**31 - 1))
    duration: float = param(600.0, "simulated duration", within(1, 1e6), "s")
    kidnappings: int = param(5, "number of times that the robot is carried", within(0, 1000))
    odometry_rate: int = param(10, "rate of odometry", within(1, 100), "Hz")
    sensor_rate: int = param(5, "rate of images with markers and pillars", within(1, 100), "Hz")
    photo_rate: float = param(1.0, "rate of the photos whose place is recognized", within(0.01, 100), "Hz")
    speed: float = param(0.5, "speed", within(0, 10), "m/s")
    scale: float = param(1.05, "distance and angle of odometry over the true one", within(0.1, 10))
    unknown: float = param(0.1, "share of the time in which no photo is recognized", within(0, 1))
    least_certain: float = param(0.5, "least probability of the place that looks right", within(0, 1))
    holds: float = param(3.0, "time for which the answers of photos err alike", within(0.1, 100), "s")


class RoundStep(NamedTuple):
    """One reading of odometry, and what was observed at its stamp."""

    stamp: float  # seconds
    pose: np.ndarray  # (3,) true one, in the map
    T_odom_base: np.ndarray  # (3,)
    is_kidnapped: bool  # whether the robot was carried since the last step
    pillars: Optional[List]  # sextant.LabelledObservation; None: no image
    markers: Optional[List]  # sextant.LabelledObservation; None: no image
    places: Optional[List[Place]]  # None: no photo
    is_black: bool = False  # whether the photo has too little content to recognize a place


class BuildingRound:
    """A round through a building; iterating twice gives the same."""

    def __init__(self, building: Building, params: RoundParams):
        self.building, self.params = building, params
        times = np.random.default_rng([params.seed, 3])
        parts = params.duration / (params.kidnappings + 1)
        self.kidnappings = [parts * (k + 1 + times.uniform(-0.2, 0.2)) for k in range(params.kidnappings)]

    def __iter__(self) -> Iterator[RoundStep]:
        drive, due = _Drive(self), list(self.kidnappings)
        for number in range(round(self.params.duration * self.params.odometry_rate)):
            stamp = (number + 1) / self.params.odometry_rate
            is_kidnapped = bool(due) and stamp >= due[0]
            if is_kidnapped:
                due.pop(0)
                drive.carry()
            yield drive.step(number, stamp, is_kidnapped)


class RoundDriver:
    """Drives a robot along the ways of a building, to a random neighbour of each node."""

    def __init__(self, building: Building, speed: float, rng: np.random.Generator):
        """:param speed: m/s"""
        self._building, self._speed, self._rng = building, speed, rng
        self.carry()

    def carry(self) -> None:
        """To another place of the ways."""
        nodes, edges = self._building.nodes, self._building.edges
        self._from = int(self._rng.integers(len(nodes)))
        self._to = int(self._rng.choice(edges[self._from]))
        share = self._rng.uniform(0.1, 0.9)
        position = (1 - share) * nodes[self._from] + share * nodes[self._to]
        ahead = nodes[self._to] - nodes[self._from]
        self.pose = np.array([*position, np.arctan2(ahead[1], ahead[0])])

    def move(self, duration: float) -> np.ndarray:
        """Towards the next node; turns before it drives.

        :param duration: seconds
        :returns: the step (3,) in the robot frame at its start, metres and radians
        """
        off = self._building.nodes[self._to] - self.pose[:2]
        if np.hypot(*off) < NEAR_NODE:
            choices = [each for each in self._building.edges[self._to] if each != self._from]
            self._from, self._to = self._to, int(self._rng.choice(choices or [self._from]))
            off = self._building.nodes[self._to] - self.pose[:2]
        error = wrapped(np.arctan2(off[1], off[0]) - self.pose[2])
        turn = float(np.clip(TURN_GAIN * error, -TURN_RATE, TURN_RATE))
        speed = self._speed * max(0.0, np.cos(error)) ** 3
        step = np.array([speed, 0.0, turn]) * duration
        self.pose = composed(self.pose, step)
        return step


class _Drive:
    def __init__(self, of: BuildingRound):
        self._building, self._params = of.building, of.params
        self._rng = np.random.default_rng([of.params.seed, 4])
        self._odom = np.zeros(3)
        self._noise = sextant.OdometryNoiseParams()
        self._answer_until, self._answer = 0.0, (1.0, False)
        self._place_error = np.zeros(3)
        self._driver = RoundDriver(of.building, of.params.speed, self._rng)

    @property
    def pose(self) -> np.ndarray:
        return self._driver.pose

    def carry(self) -> None:
        self._driver.carry()

    def step(self, number: int, stamp: float, is_kidnapped: bool) -> RoundStep:
        params = self._params
        self._move(1 / params.odometry_rate)
        is_image = number % max(1, params.odometry_rate // params.sensor_rate) == 0
        is_photo = number % max(1, round(params.odometry_rate / params.photo_rate)) == 0
        return RoundStep(
            stamp,
            self.pose,
            self._odom,
            is_kidnapped,
            observed_pillars(self._building, self.pose, self._rng) if is_image else None,
            observed_markers(self._building, self.pose, self._rng) if is_image else None,
            self._places(stamp) if is_photo else None,
        )

    def _move(self, duration: float) -> None:
        step = self._driver.move(duration)
        noise = sextant.odometry_step_noise(step, self._noise)
        error_of_step = np.sqrt(np.maximum(np.diag(noise), 0)) * self._rng.standard_normal(3)
        self._odom = composed(self._odom, self._params.scale * step + error_of_step)

    def _places(self, stamp: float) -> List[Place]:
        """The true place and the one that looks the same, or nothing."""
        if stamp >= self._answer_until:
            certain = self._rng.uniform(self._params.least_certain, 1.0)
            self._answer = certain, bool(self._rng.random() < certain)
            if self._rng.random() < self._params.unknown:
                self._answer = 0.0, True
            self._place_error = PLACE_SIGMAS * self._rng.standard_normal(3)
            self._answer_until = stamp + self._params.holds
        certain, is_right = self._answer
        if certain == 0.0:
            return []
        here = composed(self.pose, self._place_error)
        there = self._building.twin(here)
        likely, other = (here, there) if is_right else (there, here)
        known = 0.95  # the rest is the probability of an unknown place
        return [
            (likely, _covariance(), known * certain),
            (other, _covariance(), known * (1 - certain)),
        ]


def _covariance() -> np.ndarray:
    """(3, 3) in the map frame; that of the position is the same along both axes."""
    return np.diag(PLACE_SIGMAS**2)
