# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

import sextant
from sextant.objects.ball_visibility import BallVisibility
from sextant.simulation.camera import camera_calibration, camera_mount

VISIBILITY = BallVisibility(sextant.CameraModel(camera_calibration(640, 480, 0.96)), 0.05, 0.4, 2.5)
T = camera_mount([0.1, 0.0, 0.3], [0.0, 0.25, 0.0])


@pytest.mark.parametrize(
    "x, y, is_seen",
    [
        (1.0, 0.0, True),
        (1.5, 0.5, True),
        (1.5, 0.8, False),  # beside the image
        (0.4, 0.0, False),  # below it
        (-1.0, 0.0, False),  # behind
        (3.0, 0.0, False),  # too far
    ],
)
def test_a_ball_well_inside_the_image_is_visible(x, y, is_seen):
    assert VISIBILITY.is_visible(np.array([x, y]), T) == is_seen


@pytest.mark.parametrize("pillar, hides", [((1.0, 0.0), True), ((1.0, 0.2), False), ((2.0, 0.0), False)])
def test_a_pillar_in_front_occludes_the_ball(pillar, hides):
    assert VISIBILITY.is_visible(np.array([1.5, 0.0]), T, [np.array([*pillar, 0.05])]) != hides
