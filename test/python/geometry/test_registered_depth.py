# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Depth of planes in the view of another camera."""

import numpy as np
import pytest

import sextant
from sextant.geometry.registered_depth import DepthRegistration, depths_at
from sextant.simulation.camera import camera_calibration

COLOUR = sextant.CameraModel(camera_calibration(640, 480, 1.0))
DEPTH = sextant.CameraModel(camera_calibration(320, 240, 1.2))
PLANE = np.array([0.1, -0.2, 1.0]), 2.0  # normal n and distance d of n p = d, in the colour camera's frame
T = np.array(sextant.pose_from_xyz_rpy([0.05, -0.02, 0.01], [0.01, -0.03, 0.02]))


def plane_depth(camera, T_plane_camera):
    """Depth image of PLANE."""
    width, height = camera.size
    pixels = np.stack(np.meshgrid(np.arange(width), np.arange(height)), axis=-1).reshape(-1, 2)
    rays = camera.rays(pixels) @ T_plane_camera[:3, :3].T
    depth = (PLANE[1] - PLANE[0] @ T_plane_camera[:3, 3]) / (rays @ PLANE[0])
    return depth.reshape(height, width).astype(np.float32)


def test_a_plane_has_its_depth_in_the_other_view():
    found = DepthRegistration(COLOUR, DEPTH, T).registered(plane_depth(DEPTH, T))
    assert found.shape == (160, 214)  # cells of three pixels
    truth = plane_depth(COLOUR, np.eye(4))
    pixels = np.random.default_rng(1).uniform([40, 40], [600, 440], (200, 2))
    depths = depths_at(found, pixels, COLOUR.size)
    expected = truth[tuple(np.rint(pixels).astype(int).T[::-1])]
    assert np.isfinite(depths).mean() > 0.98
    np.testing.assert_allclose(depths[np.isfinite(depths)], expected[np.isfinite(depths)], rtol=0.02)


def test_aligned_depth_stays_as_it_is():
    depth = plane_depth(COLOUR, np.eye(4))
    depth[100:200, 100:300] = 0
    np.testing.assert_allclose(
        DepthRegistration(COLOUR, COLOUR, np.eye(4)).registered(depth), depth, rtol=1e-5
    )


def test_the_nearest_surface_hides_those_behind_it():
    depth = np.full((240, 320), 3.0, np.float32)
    depth[60:180, 100:220] = 1.0
    registration = DepthRegistration(COLOUR, DEPTH, sextant.pose_from_xyz_rpy([0.2, 0, 0], [0, 0, 0]))
    found = registration.registered(depth)
    columns = np.unique(np.nonzero(np.abs(found - 1.0) < 1e-3)[1])
    inside = found[70:90, columns.min() + 1 : columns.max()]
    assert np.isin(np.round(inside[inside > 0], 3), [1.0]).mean() > 0.95


def test_there_is_no_depth_at_edges_and_outside():
    depth = np.full((480, 640), 3.0, np.float32)
    depth[:, :320] = 1.0
    pixels = np.array(
        [[319.6, 200.0], [100.0, 200.0], [-5.0, 3.0], [640.0, 3.0], [np.nan, 3.0], [500.2, 0.0]]
    )
    found = depths_at(depth, pixels, (640, 480))
    np.testing.assert_array_equal(found, [np.nan, 1.0, np.nan, np.nan, np.nan, 3.0])


def test_an_image_of_another_size_is_refused():
    with pytest.raises(ValueError, match="has 640 x 480 pixels, its camera_info 320 x 240"):
        DepthRegistration(COLOUR, DEPTH, T).registered(np.zeros((480, 640), np.float32))
