# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

import sextant
from sextant.geometry.pinhole_camera import PinholeCamera
from sextant.simulation.camera import camera_calibration

LENSES = [(), (0.1, -0.2, 0.001, -0.002, 0.05)]


@pytest.mark.parametrize("distortion", LENSES)
def test_it_is_the_camera_of_the_core(distortion):
    calibration = camera_calibration(640, 480, 1.0, "plumb_bob", distortion)
    camera, model = PinholeCamera.of(calibration), sextant.CameraModel(calibration)
    points = np.random.default_rng(1).uniform([-0.4, -0.3, 1.0], [0.4, 0.3, 2.0], (50, 3))
    pixels = camera.project(points)
    np.testing.assert_allclose(pixels, [model.project(each) for each in points], atol=1e-6)
    np.testing.assert_allclose(camera.rays(pixels), points / points[:, 2:], atol=1e-5)
    assert camera.focal_length == pytest.approx(model.focal_length)
    assert camera.project(np.zeros((0, 3))).shape == (0, 2)


def test_another_lens_and_no_calibration_are_refused():
    with pytest.raises(ValueError, match="distortion_model is 'equidistant', it must be plumb_bob or"):
        PinholeCamera.of(camera_calibration(640, 480, 1.0, "equidistant"))
    calibration = camera_calibration(640, 480, 1.0)
    calibration.K = np.zeros((3, 3))
    with pytest.raises(ValueError, match="not calibrated"):
        PinholeCamera.of(calibration)
