# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

import sextant
from sextant.objects.ball_observations import BallObservations
from sextant.objects.ball_tracker import BallTracker, BallTrackerParams
from sextant.objects.ball_visibility import BallVisibility
from sextant.objects.object_kinds import KINDS
from sextant.objects.object_locator import LocatedObject
from sextant.simulation.camera import camera_calibration

VISIBILITY = BallVisibility(
    sextant.CameraModel(camera_calibration(640, 480, 2 * np.arctan(320 / 600))), 0.05, 0.3, 4.0
)
T_BASE_CAMERA = np.array(
    [[0.0, 0.0, 1.0, 0.1], [-1.0, 0.0, 0.0, 0.0], [0.0, -1.0, 0.0, 0.3], [0.0, 0.0, 0.0, 1.0]]
)
POSE = np.array([2.0, 1.0, 0.5 * np.pi])  # of the robot, which images along y


def place(x, y):
    return LocatedObject(np.array([x, y]), np.diag([1e-4, 4e-4]))


def observations(*seen):
    return BallObservations.of(seen, T_BASE_CAMERA, VISIBILITY)


def tracked(*images):
    """The ball after images 0.1 s apart."""
    tracker = BallTracker(BallTrackerParams())
    for number, each in enumerate(images):
        each.update(tracker, 0.1 * number, POSE)
    return tracker.at(0.1 * (len(images) - 1))


def test_balls_and_pillars_are_distinguished_by_their_shape():
    observed = observations((KINDS["ball"], place(1.0, 0.2)), (KINDS["red_pillar"], place(2.0, -0.3)))
    assert [each.position.tolist() for each in observed.balls] == [[1.0, 0.2]]
    np.testing.assert_allclose(observed.pillars, [[2.0, -0.3, 0.05]])


def test_the_ball_is_transformed_by_the_robots_pose():
    ball = tracked(*[observations((KINDS["ball"], place(1.0, 0.2)))] * 5)
    # 1 m ahead along y, 0.2 m to the left along -x.
    np.testing.assert_allclose(ball.position, [1.8, 2.0], atol=1e-3)
    assert ball.covariance[0, 0] > ball.covariance[1, 1]  # less certain across the line of sight
    assert ball.seen == pytest.approx(0.4)


def test_a_ball_that_is_missed_is_deleted_but_not_one_behind_a_pillar():
    seen, nothing = [observations((KINDS["ball"], place(1.5, 0.0)))] * 5, [observations()] * 20
    hidden = [observations((KINDS["red_pillar"], place(0.8, 0.0)))] * 20
    assert tracked(*seen, *nothing) is None
    assert tracked(*seen, *hidden) is not None
