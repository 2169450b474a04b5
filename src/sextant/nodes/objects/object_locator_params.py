# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of the node object_locator, and what they are for the library."""

from dataclasses import dataclass
from typing import Any, Dict

from sextant.base.strict_params import not_empty, param, within
from sextant.objects.ball_motion import BallMotionSettings
from sextant.objects.ball_tracker import BallTrackerSettings
from sextant.objects.object_kinds import KINDS, kinds_of
from sextant.objects.object_locator import LocatorSettings

_LOCATOR, _BALL = LocatorSettings(), BallTrackerSettings()


def _kinds(value: Dict[str, Any]) -> str:
    """For parse_params()."""
    try:
        kinds_of(value)
    except ValueError as error:
        return str(error)
    return ""


@dataclass(frozen=True)
class ObjectLocatorParams:
    """What is looked at, how far it is believed, and what the objects are."""

    scale: float = param(_LOCATOR.scale, within(0.5, 2.0))
    kinds: Dict[str, Dict[str, Any]] = param({name: kind._asdict() for name, kind in KINDS.items()}, _kinds)
    slop: float = param(0.05, within(0.0, 1.0))  # seconds between a picture and its depth image
    base_frame: str = param("base_link", not_empty)
    nearest: float = param(_LOCATOR.nearest, within(0.01, 100.0))
    farthest: float = param(_LOCATOR.farthest, within(0.01, 100.0))
    fewest: int = param(_LOCATOR.fewest, within(1, 10000))
    range_sigma: float = param(_LOCATOR.range_sigma, within(1e-6, 10.0))
    lump: float = param(_LOCATOR.lump, within(1.0, 1000.0))
    scale_sigma: float = param(_LOCATOR.scale_sigma, within(0.0, 1.0))
    pixel_sigma: float = param(_LOCATOR.pixel_sigma, within(0.01, 100.0))
    size_sigma: float = param(_LOCATOR.size_sigma, within(0.0, 1.0))
    worst: float = param(_LOCATOR.worst, within(0.0, 10.0))
    sure_range: float = param(2.5, within(0.1, 100.0))  # metres to which a ball is always detected
    rolling: float = param(_BALL.motion.rolling, within(0.01, 10.0))
    begin: int = param(_BALL.begin, within(1, 100))
    move: int = param(_BALL.move, within(1, 100))
    missed: int = param(_BALL.missed, within(1, 10000))
    memory: float = param(_BALL.memory, within(0.1, 3600.0))

    def locator(self) -> LocatorSettings:
        """For sextant.objects.object_locator.ObjectLocator."""
        return LocatorSettings(
            self.scale, self.fewest, self.nearest, self.farthest, self.range_sigma, self.lump,
            self.scale_sigma, self.pixel_sigma, self.size_sigma, self.worst,
        )  # fmt: skip

    def ball(self) -> BallTrackerSettings:
        """For sextant.objects.ball_tracker.BallTracker."""
        motion = BallMotionSettings(rolling=self.rolling)
        return BallTrackerSettings(self.begin, self.move, self.missed, self.memory, motion)
