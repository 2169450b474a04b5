# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of the node ball_task by flat names; defaults and ranges of most are those of the library."""

from dataclasses import dataclass

from sextant.ball.ball_task_params import BallTaskParams
from sextant.ball.floor_grid import FloorGridParams
from sextant.base.strict_params import ParamError, StrictParams, nested, param, within


@dataclass(frozen=True)
class BallTaskNodeParams(StrictParams):
    """What the library does not know, and the library's."""

    autostart: bool = param(True)
    use_depth: bool = param(True)  # look at the floor with the depth camera
    depth_scale: float = param(1.0, within(0.5, 2.0))  # that depths are multiplied by
    depth_step: int = param(8, within(1, 100))  # pixels from one that is looked at to the next
    pose_timeout: float = param(0.5, within(0.01, 60.0))  # seconds after which a pose is too old to drive by
    picture_timeout: float = param(2.0, within(0.01, 60.0))  # the same of depth images, and of objects
    ball_timeout: float = param(1.0, within(0.01, 60.0))  # seconds after which nobody follows the ball
    patience: float = param(60.0, within(0.0, 1e6))  # seconds of waiting, after which the task has failed
    task: BallTaskParams = nested(BallTaskParams)
    grid: FloorGridParams = nested(FloorGridParams, "grid_")

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.grid.low <= 2.0 * self.task.kick.ball_radius:
            raise ParamError("grid_low", "must be more than 2 ball_radius", self.grid.low)
