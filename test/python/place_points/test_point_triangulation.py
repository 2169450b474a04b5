# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Points from observations with known noise."""

import numpy as np
from scipy.stats import chi2

import sextant
from sextant.place_points.point_localizer import R_BODY_OPTICAL
from sextant.place_points.point_triangulation import Observations, triangulated

SIGMA = 0.001  # normalized


def pose(x, y=0.0, yaw=0.0):
    T = sextant.pose_from_xyz_rpy([x, y, 1.5], [0.0, 0.0, yaw])
    T[:3, :3] = T[:3, :3] @ R_BODY_OPTICAL
    return T


POSES = np.array([pose(3.0 * i) for i in range(4)])


def seen(xyz, seed=1, poses=POSES, noise=1.0):
    """Observations of all points in all photos."""
    rng = np.random.default_rng(seed)
    point, photo = (each.ravel() for each in np.meshgrid(range(len(xyz)), range(len(poses)), indexing="ij"))
    offset = xyz[point] - poses[photo, :3, 3]
    p = np.einsum("nji,nj->ni", poses[photo, :3, :3], offset)
    xy = p[:, :2] / p[:, 2:] + noise * rng.normal(0, SIGMA, (len(p), 2))
    return Observations(point, photo, xy, np.full(len(p), SIGMA))


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


def test_one_view_is_no_point():
    one = Observations(*(each[:1] for each in seen(scene(1))))
    points = triangulated(POSES, 1, one)
    assert not points.valid.any() and not points.used.any()
