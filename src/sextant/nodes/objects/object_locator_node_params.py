# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of the node object_locator."""

from dataclasses import asdict, dataclass
from typing import Any, Dict

from sextant.base.strict_params import Check, StrictParams, nested, not_empty, param, within
from sextant.objects.ball_tracker import BallTrackerParams
from sextant.objects.object_kinds import KINDS, kinds_of
from sextant.objects.object_locator import ObjectLocatorParams

_BALL = ("confirm_hits", "relocate_hits", "max_misses", "max_age", "ball_deceleration")


def _kinds(value: Dict[str, Any]) -> str:
    """A check for parse_params()."""
    try:
        kinds_of(value)
    except ValueError as error:
        return str(error)
    return ""


@dataclass(frozen=True)
class ObjectLocatorNodeParams(StrictParams):
    """Parameters of the node, the locator and the ball tracker."""

    kinds: Dict[str, Dict[str, Any]] = param(
        {name: asdict(kind) for name, kind in KINDS.items()},
        "shape and radius of each class; other classes are not located",
        Check("shape: pillar, ball; radius: (0, 1] m", _kinds),
    )
    slop: float = param(
        0.05, "maximum time difference between an image and its depth image", within(0.0, 1.0), "s"
    )
    base_frame: str = param("base_link", "robot frame, z up, x forward", not_empty)
    ball_detection_range: float = param(
        2.5,
        "maximum range at which a ball is reliably detected; within it, a missing detection counts as "
        "a miss",
        within(0.1, 100.0),
        "m",
    )
    locator: ObjectLocatorParams = nested(ObjectLocatorParams)
    ball: BallTrackerParams = nested(BallTrackerParams, only=_BALL)
