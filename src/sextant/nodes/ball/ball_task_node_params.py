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

    autostart: bool = param(True)  # start the task at once
    use_depth: bool = param(True)  # detect obstacles with the depth camera
    depth_scale: float = param(1.0, within(0.5, 2.0))  # factor that corrects the depths
    depth_step: int = param(8, within(1, 100))  # pixels between used depths
    pose_timeout: float = param(0.5, within(0.01, 60.0))  # seconds, maximum age of a pose
    image_timeout: float = param(2.0, within(0.01, 60.0))  # seconds, the same of depth images and objects
    ball_timeout: float = param(
        1.0, within(0.01, 60.0)
    )  # seconds since the last message; then the ball is unknown
    patience: float = param(60.0, within(0.0, 1e6))  # seconds of waiting until the task fails
    task: BallTaskParams = nested(BallTaskParams)
    grid: FloorGridParams = nested(FloorGridParams, "grid_")

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.grid.min_obstacle_height <= 2.0 * self.task.kick.ball_radius:
            raise ParamError(
                "grid_min_obstacle_height", "must be more than 2 ball_radius", self.grid.min_obstacle_height
            )
