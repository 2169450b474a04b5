# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of the ball task: which are refused."""

import numpy as np
import pytest

from sextant.ball.ball_task_params import BallTaskParams


def test_the_defaults_are_those_of_the_task():
    """Spec: two pillars at least 700 mm apart, the robot stops 20 cm before them."""
    params = BallTaskParams()
    assert (params.goal_width, params.stop_distance) == (0.7, 0.2)


@pytest.mark.parametrize(
    "wrong, named",
    [
        ({"goal_width": 0.0}, "goal_width"),
        ({"pillar_radius": np.nan}, "pillar_radius"),
        ({"stop_distance": -0.1}, "stop_distance"),
        ({"clearance": 2.0}, "clearance"),
        ({"time_limit": 0.0}, "time_limit"),
        ({"most_kicks": 0}, "most_kicks"),
        ({"most_bumps": -1}, "most_bumps"),
        ({"most_searches": 0}, "most_searches"),
    ],
)
def test_wrong_parameters_are_named(wrong, named):
    with pytest.raises(ValueError, match=f"^{named}: "):
        BallTaskParams(**wrong)
