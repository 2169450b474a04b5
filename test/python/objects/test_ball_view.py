# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

import sextant
from sextant.objects.ball_view import BallView
from sextant.simulation.camera import camera_calibration, camera_mount

VIEW = BallView(sextant.CameraModel(camera_calibration(640, 480, 0.96)), 0.05, 0.4, 2.5)
T = camera_mount([0.1, 0.0, 0.3], [0.0, 0.25, 0.0])


@pytest.mark.parametrize(
    "x, y, is_seen",
    [
        (1.0, 0.0, True),
        (1.5, 0.5, True),
        (1.5, 0.8, False),  # beside the picture
        (0.4, 0.0, False),  # below it
        (-1.0, 0.0, False),  # behind
        (3.0, 0.0, False),  # too far
    ],
)
def test_what_is_well_inside_the_picture_is_seen(x, y, is_seen):
    assert VIEW.has(np.array([x, y]), T) == is_seen


@pytest.mark.parametrize("pillar, hides", [((1.0, 0.0), True), ((1.0, 0.2), False), ((2.0, 0.0), False)])
def test_a_pillar_before_it_hides_it(pillar, hides):
    assert VIEW.has(np.array([1.5, 0.0]), T, [np.array([*pillar, 0.05])]) != hides
