# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Walk along a simulated street, a loop around a block; season and light change with each lap."""

from dataclasses import dataclass
from typing import List, NamedTuple, Optional

import numpy as np

from sextant.base.strict_params import Check, StrictParams, each, not_empty, one_of, param, within
from sextant.geometry.plane_poses import wrapped
from sextant.simulation.motion import Motion
from sextant.simulation.odometry import OdometryNoise, OdometryReading, WheelOdometry
from sextant.streets.street import Street
from sextant.streets.street_conditions import CONDITIONS
from sextant.streets.street_view import street_view

NOISE_SEED = 1_000_000  # of the first image's noise; far from the seeds of photos in maps
WAVE = 23.0  # wavelength of the lateral motion, metres
STEP = 0.01  # of the numerical derivative for the heading, metres


def _known_conditions(conditions: List[str]) -> str:
    """Check for param(): at least one name, all in CONDITIONS."""
    return not_empty(conditions) or each(one_of(*CONDITIONS))(conditions)


known_conditions = Check(", ".join(CONDITIONS), _known_conditions)


@dataclass(frozen=True)
class WalkParams(StrictParams):
    """Parameters of the walk."""

    seed: int = param(1, "random seed of the street and of all noise", within(0, 2**31 - 1))
    seasons: List[str] = param(
        ["autumn", "winter"],
        "seasons of the walk, one per lap",
        known_conditions,
    )
    rate: float = param(2.0, "image rate", within(0.1, 100.0), "Hz")
    speed: float = param(2.0, "walking speed", within(0.01, 20.0), "m/s")
    sway: float = param(0.4, "amplitude of the lateral motion", within(0.0, 1.5), "m")
    width: int = param(480, "image width", within(16, 8192), "px")
    height: int = param(360, "image height", within(16, 8192), "px")


class WalkFrame(NamedTuple):
    """State and measurements at one instant."""

    time: float  # seconds since the start
    conditions: str  # key of CONDITIONS
    truth: Motion  # in the frame map
    odometry: OdometryReading  # at the time of the image
    image: np.ndarray  # uint8 (height, width)


class StreetWalk:
    """Generates frames; the first one of a lap takes seconds, as the street is built in the lap's season."""

    def __init__(self, params: WalkParams):
        self._params = params
        self._wheels = WheelOdometry(OdometryNoise(), params.seed)
        self._street: Optional[Street] = None
        self._lap, self._number, self._arc = -1, 0, 0.0  # arc length, metres
        self._rng = np.random.default_rng([params.seed, 3])

    def carry(self) -> float:
        """Kidnaps the walker: moves it along the street without changing the odometry.

        :returns: distance, metres
        """
        street = self._street_now()
        distance = float(self._rng.uniform(0.25, 0.75) * street.length)
        self._arc += distance
        self._wheels.carry(self._motion(self._street_now()))
        return distance

    def frame(self) -> WalkFrame:
        """Renders the next frame."""
        if self._number:
            self._arc += self._params.speed / self._params.rate
        street = self._street_now()
        motion = self._motion(street)
        reading = self._wheels.update(motion, 1 / self._params.rate)
        size = (self._params.width, self._params.height)
        image = street_view(street, [motion.x, motion.y, motion.yaw], size, NOISE_SEED + self._number)
        time = self._number / self._params.rate
        self._number += 1
        return WalkFrame(time, self._conditions(), motion, reading, image)

    def _conditions(self) -> str:
        return self._params.seasons[self._lap % len(self._params.seasons)]

    def _street_now(self) -> Street:
        """The street in the conditions of the current lap."""
        number = int(self._arc / self._street.length) if self._street else 0
        if number != self._lap:
            self._lap = number
            self._street = Street(self._params.seed, CONDITIONS[self._conditions()])
        return self._street

    def _motion(self, street: Street) -> Motion:
        """Motion along a sine curve around the centre line, heading along the curve."""
        here, near, far = (self._position(street, self._arc + step) for step in (0.0, STEP, 1.0))
        yaw, chord_yaw = (np.arctan2(*(to - here)[::-1]) for to in (near, far))
        curvature = 2 * wrapped(chord_yaw - yaw)  # rad/m; the chord turns half as much as the curve
        speed = self._params.speed
        return Motion(*here.tolist(), 0.0, float(yaw), speed, speed * float(curvature))

    def _position(self, street: Street, arc: float) -> np.ndarray:
        return street.pose(arc, self._params.sway * np.sin(2 * np.pi * arc / WAVE))[:2]
