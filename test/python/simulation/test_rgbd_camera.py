# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Two cameras in one housing, each with its own geometry: against the pinhole's equations."""

import numpy as np
import pytest

import sextant
from sextant.simulation.motion import Motion
from sextant.simulation.rgbd_camera import RgbdCamera, RgbdParams

CLEAN = dict(noise_sigma=0.0, depth_noise=0.0, holes=0.0)
RADIUS, HEIGHT = 0.05, 0.4
AT = np.array([1.6, 0.3])  # of the pillar in the map
ROBOT = Motion(0.2, -0.1, 0.0, 0.25)


def scene_with_pillar(at=AT):
    pillar = sextant.ArenaObject()
    pillar.position, pillar.radius, pillar.height = np.array([*at, 0.0]), RADIUS, HEIGHT
    pillar.colour = np.array([0.04, 0.12, 0.55])
    scene = sextant.ArenaScene(sextant.ArenaSceneParams())
    scene.set_objects([pillar])
    return scene


def projected(K, T_map_camera, points):
    """(n, 2) pixels of points (n, 3) of the map."""
    seen = (np.column_stack([points, np.ones(len(points))]) @ np.linalg.inv(T_map_camera).T)[:, :3]
    return (seen @ K.T)[:, :2] / seen[:, 2:]


def rims(at=AT):
    """(n, 3) points of the pillar's foot and top, whose box is that of its silhouette."""
    angles = np.linspace(0.0, 2.0 * np.pi, 721)
    ring = at + RADIUS * np.column_stack([np.cos(angles), np.sin(angles)])
    return np.vstack([np.column_stack([ring, np.full(len(ring), z)]) for z in (0.0, HEIGHT)])


def points_of(camera, depth):
    """(height, width, 3) in the robot frame of a depth image."""
    K = camera.depth.K
    u, v = np.meshgrid(np.arange(depth.shape[1]), np.arange(depth.shape[0]))
    rays = np.dstack([(u - K[0, 2]) / K[0, 0], (v - K[1, 2]) / K[1, 1], np.ones(depth.shape)])
    return rays * depth[..., None] @ camera.T_base_depth[:3, :3].T + camera.T_base_depth[:3, 3]


@pytest.mark.parametrize("mount", [{}, dict(x=-0.1, y=0.2, z=0.6, pitch=0.4), dict(width=320, height=200)])
def test_the_box_of_a_pillar_is_where_the_colour_camera_projects_it(mount):
    camera = RgbdCamera(RgbdParams(**CLEAN, **mount))
    picture = camera.take(scene_with_pillar(), ROBOT.pose, 0)
    (seen,) = picture.seen
    pixels = projected(camera.colour.K, ROBOT.pose @ camera.T_base_colour, rims())
    size = (camera.colour.width, camera.colour.height)
    np.testing.assert_allclose(seen.low, np.clip(np.ceil(pixels.min(axis=0)), 0, size), atol=1)
    np.testing.assert_allclose(seen.high, np.clip(np.floor(pixels.max(axis=0)) + 1, 0, size), atol=1)
    inside = picture.colour[seen.low[1] + 5 : seen.high[1] - 5, seen.low[0] + 5 : seen.high[0] - 5]
    assert inside[..., 2].mean() > 1.5 * inside[..., 0].mean()  # blue


@pytest.mark.parametrize("scale", [1.0, 1.0 / 1.04])
def test_depths_lie_on_the_pillar_by_the_depth_cameras_own_geometry(scale):
    camera = RgbdCamera(RgbdParams(**CLEAN, depth_scale=scale, depth_yaw=0.02, baseline=0.06))
    depth = camera.take(scene_with_pillar(), ROBOT.pose, 0).depth
    found = points_of(camera, depth / scale) @ ROBOT.pose[:3, :3].T + ROBOT.pose[:3, 3]
    pixels = projected(camera.depth.K, ROBOT.pose @ camera.T_base_depth, rims())
    (left, top), (right, bottom) = pixels.min(axis=0).astype(int) + 3, pixels.max(axis=0).astype(int) - 3
    on_it = found[top : bottom - 8, left:right].reshape(-1, 3)
    off = np.linalg.norm(on_it[:, :2] - AT, axis=1)
    is_top = on_it[:, 2] > HEIGHT - 1e-4
    assert len(off) > 500
    np.testing.assert_allclose(off[~is_top], RADIUS, atol=1e-4)
    floor = found[bottom + 20 :, :][depth[bottom + 20 :, :] > 0]
    np.testing.assert_allclose(floor[:, 2], 0.0, atol=1e-4)


def test_the_depth_camera_sees_farther_around_and_stands_beside():
    params = RgbdParams()
    camera = RgbdCamera(params)
    for calibration, fov in ((camera.colour, params.colour_fov), (camera.depth, params.depth_fov)):
        assert calibration.K[0, 0] == pytest.approx(320.0 / np.tan(fov / 2.0))
    off = np.linalg.inv(camera.T_base_depth) @ camera.T_base_colour
    np.testing.assert_allclose(off[:3, 3], [-0.015, 0.0, 0.0], atol=1e-4)  # to the left
    assert np.arccos((np.trace(off[:3, :3]) - 1.0) / 2.0) == pytest.approx(0.005, rel=0.01)


def test_noise_follows_seed_and_frame():
    scene, params = scene_with_pillar(), RgbdParams(width=160, height=120)

    def both(seed, frame):
        picture = RgbdCamera(params, seed).take(scene, ROBOT.pose, frame)
        return picture.colour, picture.depth

    for one, same, other_frame, other_seed in zip(both(1, 1), both(1, 1), both(1, 2), both(2, 1)):
        np.testing.assert_array_equal(one, same)
        assert np.mean(one != other_frame) > 0.5 and np.mean(one != other_seed) > 0.5


def test_a_camera_outside_of_the_arena_is_refused():
    with pytest.raises(ValueError, match="outside"):
        RgbdCamera(RgbdParams()).take(scene_with_pillar(), Motion(x=20.0).pose, 0)
