# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import cv2
import numpy as np
import pytest

import sextant
from sextant.simulation.camera import camera_calibration

LENSES = [(), (0.1, -0.2, 0.001, -0.002, 0.05), (-0.3, 0.12, 0.001, -0.002)]


@pytest.mark.parametrize("distortion", LENSES)
def test_many_points_are_projected_as_opencv_does_and_their_rays_lead_back(distortion):
    calibration = camera_calibration(640, 480, 1.0, "plumb_bob", distortion)
    camera = sextant.CameraModel(calibration)
    points = np.random.default_rng(1).uniform([-0.4, -0.3, 1.0], [0.4, 0.3, 2.0], (50, 3))
    pixels = camera.project_points(points)
    found, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), calibration.K, np.array(calibration.D))
    np.testing.assert_allclose(pixels, found[:, 0], atol=1e-9)
    np.testing.assert_allclose(camera.rays(pixels), points / points[:, 2:], atol=1e-9)


def test_where_the_lens_does_not_reach_there_is_no_number():
    camera = sextant.CameraModel(camera_calibration(640, 480, 1.0, "plumb_bob", (-0.5, 0.0, 0.0, 0.0)))
    points = np.array([[0.0, 0.0, -1.0], [2.0, 0.0, 1.0], [0.0, 0.0, 1.0]])
    assert np.isnan(camera.project_points(points)).all(axis=1).tolist() == [True, True, False]
    edge = camera.project([0.8, 0.0, 1.0])  # the polynomial turns back at 0.816
    assert np.isnan(camera.rays([edge, edge + [50.0, 0.0]])[:, 2]).tolist() == [False, True]
    assert camera.project_points(np.zeros((0, 3))).shape == (0, 2)
    assert camera.size == (640, 480)
