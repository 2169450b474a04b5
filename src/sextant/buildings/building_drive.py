# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot in the simulated building: it drives its rounds or as commanded, with a camera, a sensor of pillars
and odometry.
"""

from dataclasses import dataclass
from typing import List, NamedTuple, Optional, Tuple

import numpy as np

from sextant.base.strict_params import StrictParams, nested, param, within
from sextant.buildings.building_looks import DRIVE_DAY, PILLAR_RADIUS, BuildingLooks
from sextant.buildings.building_view import BuildingCamera, building_view
from sextant.simulation.building import Building, observed_pillars
from sextant.simulation.building_round import RoundDriver
from sextant.simulation.motion import Motion, Unicycle
from sextant.simulation.odometry import OdometryNoise, OdometryReading, WheelOdometry

ROBOT_RADIUS = 0.2  # metres
CARRIED = 5.0  # metres, least distance of a kidnapping
FIRST_IMAGE = 1_000_000  # far from the numbers of photos in maps


@dataclass(frozen=True)
class BuildingDriveParams(StrictParams):
    """Parameters of robot and camera."""

    seed: int = param(0, "random seed of the route and of all noise", within(0, 2**31 - 1))
    speed: float = param(0.5, "speed of the rounds", within(0.0, 2.0), "m/s")
    odometry_rate: int = param(20, "rate of odometry", within(1, 100), "Hz")
    images_every: int = param(2, "readings of odometry per image and per scan for pillars", within(1, 1000))
    width: int = param(640, "image width", within(16, 4096), "px")
    height: int = param(480, "image height", within(16, 4096), "px")
    noise_sigma: float = param(
        4.0, "standard deviation of the sensor noise", within(0.0, 100.0), "grey levels"
    )
    odometry: OdometryNoise = nested(OdometryNoise, "odometry_")

    def camera(self) -> BuildingCamera:
        """The camera on the robot."""
        return BuildingCamera(self.width, self.height, noise=self.noise_sigma)


class BuildingStep(NamedTuple):
    """State and measurements at one instant."""

    time: float  # seconds since the start
    truth: Motion  # in the frame map
    odometry: OdometryReading  # at this time
    pillars: Optional[List]  # sextant.LabelledObservation in the robot frame; None: no image at this time


class BuildingDrive:
    """Generates the steps of a drive; deterministic for given parameters, commands and kidnappings."""

    def __init__(self, params: BuildingDriveParams, building: Building):
        self._params, self._building = params, building
        self._looks = BuildingLooks(building, day=DRIVE_DAY)
        self._camera, self._number = params.camera(), 0
        self._driver = RoundDriver(building, params.speed, np.random.default_rng([params.seed, 5]))
        self._commanded: Optional[Unicycle] = None  # None: it drives its rounds
        self._motion = _standing(self._driver.pose)
        self._wheels = WheelOdometry(params.odometry, params.seed)
        self._rng = np.random.default_rng([params.seed, 6])

    def step(self, command: Optional[Tuple[float, float]] = None) -> BuildingStep:
        """The next reading of odometry.

        :param command: speed (m/s) and turn rate (rad/s); None: the robot drives its rounds
        """
        seconds = 1.0 / self._params.odometry_rate
        self._motion = self._moved(command, seconds)
        reading = self._wheels.update(self._motion, seconds)
        is_image = self._number % self._params.images_every == 0
        self._number += 1
        pillars = observed_pillars(self._building, self.pose, self._rng) if is_image else None
        return BuildingStep(self._number * seconds, self._motion, reading, pillars)

    def image(self) -> np.ndarray:
        """What the camera sees after the last step, uint8 (height, width)."""
        number = FIRST_IMAGE + self._params.seed + self._number
        return building_view(self._building, self._looks, self._camera, self.pose, number)

    def carry(self) -> float:
        """Kidnaps the robot: moves it to another place without changing the odometry.

        :returns: distance, metres
        """
        before = self.pose
        self._driver.carry()
        while np.hypot(*(self._driver.pose - before)[:2]) < CARRIED:
            self._driver.carry()
        self._motion, self._commanded = _standing(self._driver.pose), None
        self._wheels.carry(self._motion)
        return float(np.hypot(*(self.pose - before)[:2]))

    @property
    def pose(self) -> np.ndarray:
        """The true pose (3,) in the map."""
        return np.array([self._motion.x, self._motion.y, self._motion.yaw])

    def is_free(self, x: float, y: float) -> bool:
        """Whether the robot fits at a place between walls and pillars."""
        angles = np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False)
        rim = np.array([x, y]) + ROBOT_RADIUS * np.column_stack([np.cos(angles), np.sin(angles)])
        nearest = np.linalg.norm(self._building.pillars - (x, y), axis=1).min()
        return bool(self._building.is_inside(rim).all() and nearest > ROBOT_RADIUS + PILLAR_RADIUS)

    def _moved(self, command: Optional[Tuple[float, float]], seconds: float) -> Motion:
        if command is not None:
            self._commanded = self._commanded or Unicycle(self._motion, self.is_free)
            return self._commanded.drive(*command, seconds)
        forward, _, turn = self._driver.move(seconds)
        x, y, yaw = self._driver.pose
        return Motion(x, y, 0.0, yaw, forward / seconds, turn / seconds)


def _standing(pose: np.ndarray) -> Motion:
    x, y, yaw = pose
    return Motion(x, y, 0.0, yaw)
