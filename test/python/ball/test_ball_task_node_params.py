# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import pytest

from sextant.ball.ball_task_params import BallTaskParams
from sextant.ball.floor_grid import FloorGridParams
from sextant.base.strict_params import parse_params
from sextant.nodes.ball.ball_task_node_params import BallTaskNodeParams


def parse(**values):
    return parse_params(BallTaskNodeParams, values, "/ball_task")


def test_defaults_are_those_of_the_library():
    params = parse()
    assert params.task == BallTaskParams() and params.grid == FloorGridParams()


def test_every_value_reaches_its_place():
    params = parse(goal_width=0.8, run_up=0.5, speed=0.3, grid_most=5, pose_timeout=1)
    task = params.task
    assert (task.goal_width, task.kick.run_up, task.follower.speed) == (0.8, 0.5, 0.3)
    assert (params.grid.most, params.pose_timeout) == (5, 1.0)


@pytest.mark.parametrize(
    "values, message",
    [
        ({"goal_widht": 1.0}, "/ball_task/goal_widht: unknown parameter; did you mean goal_width?"),
        ({"most_kicks": 2.5}, "/ball_task/most_kicks: must be a whole number, is 2.5"),
        ({"most_kicks": 0}, "/ball_task/most_kicks: must be within [1, 100], is 0"),
        ({"speed": 50.0}, "/ball_task/speed: must be within [0.001, 10], is 50.0"),
        ({"run_up": 0.2}, "/ball_task/run_up: must be more than robot_radius + ball_radius, is 0.2"),
        ({"grid_cell": 2.0}, "/ball_task/grid_cell: must be within [0.01, 1], is 2.0"),
        ({"grid_floor": 0.15}, "/ball_task/grid_floor: must be less than grid_low, is 0.15"),
        ({"ball_radius": 0.07}, "/ball_task/grid_low: must be more than 2 ball_radius, is 0.13"),
        ({"depth_scale": 0.1}, "/ball_task/depth_scale: must be within [0.5, 2.0], is 0.1"),
    ],
)
def test_refused(values, message):
    with pytest.raises(ValueError) as error:
        parse(**values)
    assert str(error.value).startswith(message)
