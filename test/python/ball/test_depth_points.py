# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import cv2
import numpy as np
import pytest

import sextant
from sextant.ball.depth_points import DepthPoints

SIZE = (64, 48)
K = np.array([[40.0, 0.0, 30.0], [0.0, 42.0, 25.0], [0.0, 0.0, 1.0]])
D = np.array([0.1, -0.05, 0.002, -0.003, 0.01])
PITCH = 0.3  # downward
# Optical axes in the robot's: z is ahead and a little down, x to the right.
T_BASE_DEPTH = np.eye(4)
T_BASE_DEPTH[:3, 0] = 0.0, -1.0, 0.0
T_BASE_DEPTH[:3, 2] = np.cos(PITCH), 0.0, -np.sin(PITCH)
T_BASE_DEPTH[:3, 1] = np.cross(T_BASE_DEPTH[:3, 2], T_BASE_DEPTH[:3, 0])
T_BASE_DEPTH[:3, 3] = 0.1, -0.02, 0.3


def camera_with(distortion):
    calibration = sextant.CameraCalibration()
    calibration.width, calibration.height = SIZE
    calibration.distortion_model, calibration.D, calibration.K = "plumb_bob", distortion, K
    return sextant.CameraModel(calibration)


def test_a_camera_above_a_floor_sees_it_at_height_zero():
    depth = np.zeros(SIZE[::-1], np.float32)
    for v in range(SIZE[1]):
        ray = T_BASE_DEPTH[:3, :3] @ [0.0, (v - 25.0) / 42.0, 1.0]  # depth is the same along a row
        if ray[2] < -0.05:
            depth[v] = 0.3 / -ray[2]
    camera = camera_with(np.zeros(5))
    points = DepthPoints(camera, T_BASE_DEPTH, step=1).of(depth)
    assert len(points) == np.count_nonzero(depth) > 500
    np.testing.assert_allclose(points[:, 2], 0.0, atol=1e-6)
    assert points[:, 0].min() > 0.1 and points[:, 1].min() < -0.1 < 0.1 < points[:, 1].max()


@pytest.mark.parametrize("step", [1, 5, 8])
def test_points_are_projected_to_the_pixels_that_are_picked(step):
    rng = np.random.default_rng(2)
    depth = rng.uniform(0.5, 3.0, SIZE[::-1]).astype(np.float32)
    depth[rng.random(depth.shape) < 0.3] = 0.0
    scale = 1.04
    points = DepthPoints(camera_with(D), T_BASE_DEPTH, scale, step).of(depth)
    seen = (points - T_BASE_DEPTH[:3, 3]) @ T_BASE_DEPTH[:3, :3]
    pixels = cv2.projectPoints(seen.reshape(-1, 1, 3), np.zeros(3), np.zeros(3), K, D)[0][:, 0]
    at = np.rint(pixels).astype(int)
    np.testing.assert_allclose(pixels, at, atol=1e-3)
    assert set(at.ravel() % step) == {step // 2}
    np.testing.assert_allclose(seen[:, 2], scale * depth[at[:, 1], at[:, 0]], rtol=1e-6)
    picked = depth[step // 2 :: step, step // 2 :: step]
    assert len(points) == np.count_nonzero(picked)


def test_an_image_of_another_size_is_refused():
    with pytest.raises(ValueError, match="depth image is 32×48, its camera_info has 64×48"):
        DepthPoints(camera_with(D), T_BASE_DEPTH).of(np.ones((48, 32), np.float32))
