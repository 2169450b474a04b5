# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of the node ball_task by flat names; defaults and ranges of most are those of the library."""

from dataclasses import dataclass, fields, make_dataclass
from operator import attrgetter
from typing import Dict

from sextant.ball.ball_task_params import BallTaskParams
from sextant.ball.floor_grid import FloorGridParams
from sextant.ball.kick_plan import KickParams
from sextant.ball.path_follower import FollowerParams
from sextant.base.strict_params import param, within

_TASK, _PARTS = BallTaskParams(), ("kick", "follower")


@dataclass(frozen=True)
class _NodeParams:
    """What the library does not know."""

    autostart: bool = param(True)
    use_depth: bool = param(True)  # look at the floor with the depth camera
    depth_scale: float = param(1.0, within(0.5, 2.0))  # that depths are multiplied by
    depth_step: int = param(8, within(1, 100))  # pixels from one that is looked at to the next
    pose_timeout: float = param(0.5, within(0.01, 60.0))  # seconds after which a pose is too old to drive by
    picture_timeout: float = param(2.0, within(0.01, 60.0))  # the same of depth images, and of objects
    ball_timeout: float = param(1.0, within(0.01, 60.0))  # seconds after which nobody follows the ball
    patience: float = param(60.0, within(0.0, 1e6))  # seconds of waiting, after which the task has failed

    def task(self) -> BallTaskParams:
        """For sextant.ball.ball_task.BallTask."""
        own = {field.name for field in fields(BallTaskParams)}.difference(_PARTS)
        parts = {"kick": _taken(self, KickParams), "follower": _taken(self, FollowerParams)}
        return BallTaskParams(**{name: getattr(self, name) for name in own}, **parts)

    def grid(self) -> FloorGridParams:
        """For sextant.ball.floor_grid.FloorGrid."""
        return _taken(self, FloorGridParams, "grid_")

    def __post_init__(self):
        """:raises ValueError: names the first parameter out of range"""
        self.task().validate()
        try:
            self.grid().validate()
        except ValueError as error:
            raise ValueError(f"grid_{error}".replace("less than ", "less than grid_")) from None
        if self.grid_low <= 2.0 * self.ball_radius:
            raise ValueError(f"grid_low is {self.grid_low}, it must be more than 2 ball_radius")


def _taken(params: _NodeParams, cls: type, prefix: str = ""):
    return cls(**{field.name: getattr(params, prefix + field.name) for field in fields(cls)})


def _names(record: object, prefix: str = "", leave: tuple = ()) -> Dict[str, object]:
    """Defaults by name."""
    names = [field.name for field in fields(record) if field.name not in leave]
    return {prefix + name: attrgetter(name)(record) for name in names}


_DEFAULTS = {
    **_names(_TASK, leave=_PARTS),
    **_names(_TASK.kick),
    **_names(_TASK.follower),
    **_names(FloorGridParams(), "grid_"),
}
BallTaskNodeParams = make_dataclass(
    "BallTaskNodeParams",
    [(name, type(value), param(value)) for name, value in _DEFAULTS.items()],
    bases=(_NodeParams,),
    frozen=True,
)
