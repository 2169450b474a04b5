# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import pytest

from sextant.ball.ball_task_params import BallTaskParams
from sextant.ball.floor_grid import FloorGridParams
from sextant.base.strict_params import parse_params
from sextant.nodes.ball.ball_task_node_params import BallTaskNodeParams


def parse(**values):
    return parse_params(BallTaskNodeParams, values, "/ball_task")


def test_defaults_are_those_of_the_library_and_of_the_task():
    """Spec: two pillars at least 700 mm apart, the robot stops 20 cm before them."""
    params = parse()
    assert params.task == BallTaskParams() and params.grid == FloorGridParams()
    assert (params.task.goal_width, params.task.stop_distance) == (0.7, 0.2)


def test_every_value_reaches_its_place():
    params = parse(goal_width=0.8, run_up=0.5, speed=0.3, grid_max_evidence=5, pose_timeout=1)
    task = params.task
    assert (task.goal_width, task.kick.run_up, task.follower.speed) == (0.8, 0.5, 0.3)
    assert (params.grid.max_evidence, params.pose_timeout) == (5, 1.0)


@pytest.mark.parametrize(
    "values, message",
    [
        ({"goal_widht": 1.0}, "/ball_task/goal_widht: unknown parameter; did you mean goal_width?"),
        ({"max_kicks": 2.5}, "/ball_task/max_kicks: must be a whole number, is 2.5"),
        ({"max_kicks": 0}, "/ball_task/max_kicks: must be within [1, 100], is 0"),
        ({"speed": 50.0}, "/ball_task/speed: must be within [0.001, 10], is 50.0"),
        ({"run_up": 0.2}, "/ball_task/run_up: must be at least robot_radius + ball_radius, is 0.2"),
        ({"grid_resolution": 2.0}, "/ball_task/grid_resolution: must be within [0.01, 1], is 2.0"),
        (
            {"grid_floor_tolerance": 0.15},
            "/ball_task/grid_floor_tolerance: must be less than grid_min_obstacle_height, is 0.15",
        ),
        (
            {"ball_radius": 0.07},
            "/ball_task/grid_min_obstacle_height: must be more than 2 ball_radius, is 0.13",
        ),
        ({"depth_scale": 0.1}, "/ball_task/depth_scale: must be within [0.5, 2.0], is 0.1"),
    ],
)
def test_refused(values, message):
    with pytest.raises(ValueError) as error:
        parse(**values)
    assert str(error.value).startswith(message)


TASK = {"goal_width": 0.0, "pillar_radius": 2.0, "stop_distance": -0.1, "clearance": 2.0, "time_limit": 0.0}
MOST = {"max_bumps": -1, "max_searches": 0, "grid_max_evidence": 0}
KICK = {
    "robot_radius": 0.0,
    "ball_deceleration": 0.0,
    "ball_restitution": 1.1,
    "min_kick_speed": 0.7,
    "overshoot": -0.1,
}
FOLLOWER = dict.fromkeys(
    ("turn_rate", "acceleration", "lookahead", "rotate_in_place_angle", "min_speed"), 0.0
)
GRID = {"grid_half_side": 0.0, "grid_min_range": 3.0, "grid_min_obstacle_height": 0.7}


@pytest.mark.parametrize(
    "name, value", {**TASK, **MOST, **KICK, **FOLLOWER, **GRID, "min_tolerance": 2.0}.items()
)
def test_what_is_out_of_range_is_refused_by_name(name, value):
    with pytest.raises(ValueError, match=f"^/ball_task/{name}: must be (within|less than|at most)"):
        parse(**{name: value})
