# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a robot knows: what of it is refused."""

import numpy as np
import pytest

from sextant.ball.floor_grid import FloorGrid, FloorGridParams
from sextant.ball.task_view import STILL, SeenBall, SeenPillar, TaskView

GRID = FloorGrid(FloorGridParams(half_side=1.0))
NOWHERE = np.array([np.nan, 0.0])
BALL = SeenBall(np.ones(2), np.zeros(2), 0.0)
GOOD = TaskView(0.0, np.zeros(3), [SeenPillar("blue_pillar", np.ones(2))], BALL, False, GRID)


def test_a_view_with_and_without_a_ball_is_good():
    GOOD.validate()
    GOOD._replace(ball=None, pillars=[]).validate()


@pytest.mark.parametrize(
    "wrong, named",
    [
        ({"pose": np.array([0.0, 0.0, np.inf])}, "pose"),
        ({"ball": BALL._replace(position=NOWHERE)}, "ball/position"),
        ({"ball": BALL._replace(velocity=NOWHERE)}, "ball/velocity"),
        ({"pillars": [*GOOD.pillars, SeenPillar("blue_pillar", NOWHERE)]}, "pillars/1"),
    ],
)
def test_places_that_are_not_finite_are_named(wrong, named):
    with pytest.raises(ValueError, match=f"^{named} is .*finite"):
        GOOD._replace(**wrong).validate()


def test_a_ball_that_is_slow_lies():
    assert SeenBall(np.ones(2), np.array([0.0, 0.9 * STILL]), 0.0).is_still
    assert not SeenBall(np.ones(2), np.array([0.8, -0.8]) * STILL, 0.0).is_still
