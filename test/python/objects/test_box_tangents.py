# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

import sextant
from sextant.objects.box_tangents import BOTTOM, LEFT, RIGHT, TOP, ball_tangents, pillar_tangents
from sextant.simulation.camera import camera_calibration, camera_mount

CAMERA = sextant.CameraModel(camera_calibration(640, 480, 0.96))
T = camera_mount([0.1, 0.0, 0.3], [0.0, 0.25, 0.0])
RADIUS = 0.05


def corners_of(points):
    """Rays in the robot's axes toward the corners of the box about points (n, 3) of the robot frame."""
    pixels = CAMERA.project_points((points - T[:3, 3]) @ T[:3, :3])
    (left, top), (right, bottom) = pixels.min(axis=0), pixels.max(axis=0)
    corners = np.array([[left, top], [right, top], [left, bottom], [right, bottom]])
    return CAMERA.rays(corners) @ T[:3, :3].T


def circle():
    angles = np.linspace(0.0, 2.0 * np.pi, 2000)
    return RADIUS * np.column_stack([np.cos(angles), np.sin(angles)])


@pytest.mark.parametrize("x, y", [(0.8, 0.25), (0.8, -0.25), (1.5, 0.0), (2.5, -1.0)])
def test_the_axis_of_a_pillar_is_its_radius_off_both_sides(x, y):
    foot, top = (np.column_stack([circle() + [x, y], np.full(2000, z)]) for z in (0.0, 0.4))
    found = pillar_tangents(corners_of(np.vstack([foot, top])))
    middle = np.array([x, y]) - T[:2, 3]
    # The outline is a straight line in the image only at a distance: the box contains nearly all of it.
    np.testing.assert_allclose(found.normals @ middle, RADIUS, atol=0.003)
    np.testing.assert_array_equal(found.sides, [LEFT, RIGHT])
    np.testing.assert_allclose(found.middle, middle / np.linalg.norm(middle), atol=0.003)


@pytest.mark.parametrize("x, y", [(0.8, 0.2), (1.5, -0.4), (2.5, 0.0)])
def test_the_middle_of_a_ball_is_its_radius_off_all_four_sides(x, y):
    random = np.random.default_rng(1).standard_normal((200000, 3))
    middle = np.array([x, y, RADIUS])
    ball = middle + RADIUS * random / np.linalg.norm(random, axis=1, keepdims=True)
    found = ball_tangents(corners_of(ball))
    np.testing.assert_allclose(found.normals @ (middle - T[:3, 3]), RADIUS, atol=3e-4)
    np.testing.assert_allclose(np.linalg.norm(found.normals, axis=1), 1.0)
    np.testing.assert_array_equal(found.sides, [LEFT, TOP, RIGHT, BOTTOM])
