# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A walk along a simulated street, round after round, each in a season of its own."""

from dataclasses import dataclass, field
from typing import List, NamedTuple, Optional

import numpy as np

from sextant.base.strict_params import StrictParams, param, within
from sextant.geometry.plane_poses import wrapped
from sextant.simulation.motion import Motion
from sextant.simulation.odometry import OdometryNoise, OdometryReading, WheelOdometry
from sextant.simulation.street import CONDITIONS, Street
from sextant.simulation.street_view import street_view

WAVE = 23.0  # metres of a swing to the left and to the right
STEP = 0.01  # metres


@dataclass(frozen=True)
class WalkParams(StrictParams):
    """Where, when and how it is walked."""

    seed: int = param(1, within(0, 2**31 - 1))  # of the street, the camera's noise and the wheels'
    seasons: List[str] = field(default_factory=lambda: ["autumn", "winter"])  # of CONDITIONS, round by round
    rate: float = param(2.0, within(0.1, 100.0))  # pictures a second
    speed: float = param(2.0, within(0.01, 20.0))  # metres a second
    sway: float = param(0.4, within(0.0, 1.5))  # metres to the left and to the right of the way
    width: int = param(480, within(16, 8192))  # pixels
    height: int = param(360, within(16, 8192))

    def __post_init__(self) -> None:
        super().__post_init__()
        check_seasons("seasons", self.seasons)


def check_seasons(name: str, seasons: List[str]) -> None:
    """:raises ValueError: there is none, or an unknown one"""
    unknown = [season for season in seasons if season not in CONDITIONS]
    if unknown or not seasons:
        told = f"'{unknown[0]}'" if unknown else "empty"
        raise ValueError(f"{name} is {told}, allowed are {', '.join(CONDITIONS)}")


class WalkFrame(NamedTuple):
    """What there is at one instant."""

    time: float  # seconds since the begin
    season: str
    truth: Motion  # in map
    odometry: OdometryReading
    image: np.ndarray  # uint8 (height, width)


class StreetWalk:
    """Makes one frame after another; the first one of a round takes seconds, in which its street is built."""

    def __init__(self, params: WalkParams):
        self._params = params
        self._wheels = WheelOdometry(OdometryNoise(), params.seed)
        self._street: Optional[Street] = None
        self._round, self._number, self._arc = -1, 0, 0.0  # arc length that was gone, or carried, metres
        self._rng = np.random.default_rng([params.seed, 3])

    def carry(self) -> float:
        """Takes the walker somewhere else, of which its wheels know nothing.

        :returns: metres along the way
        """
        street = self._street_now()
        distance = float(self._rng.uniform(0.25, 0.75) * street.length)
        self._arc += distance
        self._wheels.carry(self._motion(self._street_now()))
        return distance

    def frame(self) -> WalkFrame:
        """The next one."""
        if self._number:
            self._arc += self._params.speed / self._params.rate
        street = self._street_now()
        motion = self._motion(street)
        reading = self._wheels.update(motion, 1 / self._params.rate)
        size = (self._params.width, self._params.height)
        image = street_view(street, [motion.x, motion.y, motion.yaw], size, 1_000_000 + self._number)
        time = self._number / self._params.rate
        self._number += 1
        return WalkFrame(time, self._season(), motion, reading, image)

    def _season(self) -> str:
        return self._params.seasons[self._round % len(self._params.seasons)]

    def _street_now(self) -> Street:
        number = int(self._arc / self._street.length) if self._street else 0
        if number != self._round:
            self._round = number
            self._street = Street(self._params.seed, CONDITIONS[self._season()])
        return self._street

    def _motion(self, street: Street) -> Motion:
        """Swinging about the way, looking where it goes."""
        ahead, here, after = (self._swung(street, self._arc + way) for way in (STEP, 0.0, 1.0))
        yaw, later = (np.arctan2(*(to - here)[::-1]) for to in (ahead, after))
        turn_rate = 2 * wrapped(later - yaw)  # radians a metre
        return Motion(
            *here.tolist(), 0.0, float(yaw), self._params.speed, self._params.speed * float(turn_rate)
        )

    def _swung(self, street: Street, arc: float) -> np.ndarray:
        return street.pose(arc, self._params.sway * np.sin(2 * np.pi * arc / WAVE))[:2]
