# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of the node ball_task."""

from dataclasses import dataclass

from sextant.ball.ball_task_params import BallTaskParams
from sextant.ball.floor_grid import FloorGridParams
from sextant.base.strict_params import ParamError, StrictParams, nested, param, within


@dataclass(frozen=True)
class BallTaskNodeParams(StrictParams):
    """Parameters of the node, the task and the occupancy grid."""

    autostart: bool = param(True, "start the task at once; false: wait for `~start`")
    use_depth: bool = param(True, "detect obstacles in depth images; false: only pillars are obstacles")
    depth_scale: float = param(1.0, "factor that corrects the depths", within(0.5, 2.0))
    depth_step: int = param(
        8, "distance between the pixels of the depth image that are used", within(1, 100), "px"
    )
    pose_timeout: float = param(0.5, "maximum age of a pose", within(0.01, 60.0), "s")
    image_timeout: float = param(
        2.0, "maximum age of a depth image, and of `objects` once they were received", within(0.01, 60.0), "s"
    )
    ball_timeout: float = param(
        1.0, "time since the last `ball` after which the ball is unknown", within(0.01, 60.0), "s"
    )
    patience: float = param(
        60.0, "time of waiting for an input after which the task fails", within(0.0, 1e6), "s"
    )
    task: BallTaskParams = nested(BallTaskParams)
    grid: FloorGridParams = nested(FloorGridParams, "grid_")

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.grid.min_obstacle_height <= 2.0 * self.task.kick.ball_radius:
            raise ParamError(
                "grid_min_obstacle_height", "must be more than 2 ball_radius", self.grid.min_obstacle_height
            )
