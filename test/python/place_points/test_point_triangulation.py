# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Points from observations with known noise."""

import numpy as np
from scipy.stats import chi2

import sextant
from sextant.geometry.poses import R_BODY_OPTICAL
from sextant.place_points.point_triangulation import (
    DEPTH_SCALE_SIGMA,
    DEPTH_SIGMA,
    Observations,
    triangulated,
)

SIGMA = 0.001  # normalized


def pose(x, y=0.0, yaw=0.0):
    T = sextant.pose_from_xyz_rpy([x, y, 1.5], [0.0, 0.0, yaw])
    T[:3, :3] = T[:3, :3] @ R_BODY_OPTICAL
    return T


POSES = np.array([pose(3.0 * i) for i in range(4)])


def seen(xyz, seed=1, poses=POSES, noise=1.0, depth_noise=None):
    """Observations of all points in all photos. :param depth_noise: standard deviations; None: no depth"""
    rng = np.random.default_rng(seed)
    point, photo = (each.ravel() for each in np.meshgrid(range(len(xyz)), range(len(poses)), indexing="ij"))
    offset = xyz[point] - poses[photo, :3, 3]
    p = np.einsum("nji,nj->ni", poses[photo, :3, :3], offset)
    xy = p[:, :2] / p[:, 2:] + noise * rng.normal(0, SIGMA, (len(p), 2))
    depth = np.full(len(p), np.nan)
    if depth_noise is not None:
        sigma = np.hypot(DEPTH_SCALE_SIGMA * p[:, 2], DEPTH_SIGMA * p[:, 2] ** 2)
        depth = p[:, 2] + depth_noise * rng.normal(0, sigma)
    return Observations(point, photo, xy, np.full(len(p), SIGMA), depth)


def scene(count, seed=2):
    rng = np.random.default_rng(seed)
    side = rng.choice([-1, 1], count)
    return np.c_[rng.uniform(13, 25, count), side * rng.uniform(3, 9, count), rng.uniform(0, 6, count)]


def test_exact_observations_give_the_exact_points():
    points = triangulated(POSES, 50, seen(scene(50), noise=0.0))
    assert points.valid.all() and points.used.all()
    np.testing.assert_allclose(points.xyz, scene(50), atol=1e-6)


def test_the_covariances_are_those_of_the_errors():
    xyz = scene(2000)
    points = triangulated(POSES, 2000, seen(xyz))
    error = (points.xyz - xyz)[points.valid]
    squared = np.einsum("ni,nij,nj->n", error, np.linalg.inv(points.covariances[points.valid]), error)
    assert points.valid.mean() > 0.99
    assert 0.93 < np.mean(squared < chi2.ppf(0.95, 3)) < 0.97
    assert 0.9 < np.mean(squared) / 3 < 1.1


def test_a_wrong_observation_is_left_out():
    xyz, observations = scene(20), seen(scene(20))
    observations.xy[observations.photo == 1] += 0.05
    points = triangulated(POSES, 20, observations)
    assert points.used[observations.photo != 1].all() and not points.used[observations.photo == 1].any()
    assert np.isnan(points.errors[~points.used]).all()
    assert np.linalg.norm(points.xyz - xyz, axis=1).max() < 1.5


def test_points_without_parallax_or_behind_a_camera_are_not_valid():
    ahead = np.array([[60.0, 0.05, 1.5]])  # in the direction of the motion
    behind = np.array([[5.0, 3.0, 1.0]])  # of two cameras
    assert not triangulated(POSES, 1, seen(ahead)).valid.any()
    assert not triangulated(POSES, 1, seen(behind)).valid.any()


def test_the_covariances_with_depth_are_those_of_the_errors():
    xyz = scene(2000)
    known = seen(xyz, depth_noise=1.0)
    points = triangulated(POSES, 2000, known)
    error = points.xyz - xyz
    squared = np.einsum("ni,nij,nj->n", error, np.linalg.inv(points.covariances), error)
    assert points.valid.mean() > 0.99
    assert 0.93 < np.mean(squared[points.valid] < chi2.ppf(0.95, 3)) < 0.97


def near(count):
    """Points that a depth camera reaches."""
    return scene(count) * [0.25, 0.25, 0.25] + [1.0, 0.0, 0.0]


def test_one_view_with_depth_is_a_point():
    xyz = near(2000)
    known = seen(xyz, poses=POSES[:1], depth_noise=1.0)
    points = triangulated(POSES[:1], 2000, known)
    assert points.valid.mean() > 0.99
    error = points.xyz - xyz
    squared = np.einsum("ni,nij,nj->n", error, np.linalg.inv(points.covariances), error)
    assert 0.93 < np.mean(squared < chi2.ppf(0.95, 3)) < 0.97


def test_a_wrong_depth_is_left_out():
    xyz = near(20)
    poses = np.array([POSES[0], pose(0.3), pose(0.6)])
    known = seen(xyz, poses=poses, depth_noise=0.0)
    known.depth[known.photo == 2] *= 1.2
    points = triangulated(poses, 20, known)
    assert points.used[known.photo != 2].all() and not points.used[known.photo == 2].any()
    assert np.linalg.norm(points.xyz - xyz, axis=1).max() < 0.2


def test_one_view_is_no_point():
    one = Observations(*(each[:1] for each in seen(scene(1))))
    points = triangulated(POSES, 1, one)
    assert not points.valid.any() and not points.used.any()
