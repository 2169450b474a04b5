# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Poses from points with known noise."""

import numpy as np
import pytest

import sextant
from sextant.evaluation.nees import nees_band
from sextant.place_points.camera_pose_fit import MAX_ERROR, PointMatches, fit_camera_pose

SIGMA, POINT_SIGMA = 0.001, 0.02  # of an observation, normalized; of a point, metres
T_MAP_CAMERA = sextant.pose_from_xyz_rpy([300.0, -200.0, 1.5], [-1.6, 0.03, 0.4])


def matches(seed, count=80, noise=1.0, wrong=0):
    """Points in front of the camera with normal errors; the first ones are seen anywhere."""
    rng = np.random.default_rng(seed)
    xy, z = rng.uniform(-0.5, 0.5, (count, 2)), rng.uniform(4, 30, count)
    p = np.c_[xy * z[:, None], z]
    covariances = np.tile(POINT_SIGMA**2 * np.diag([1.0, 4.0, 0.25]), (count, 1, 1))
    xyz = p @ T_MAP_CAMERA[:3, :3].T + T_MAP_CAMERA[:3, 3]
    xyz = xyz + noise * rng.normal(0, np.sqrt(np.diagonal(covariances, axis1=1, axis2=2)))
    xy = xy + noise * rng.normal(0, SIGMA, xy.shape)
    xy[:wrong] = rng.uniform(-0.5, 0.5, (wrong, 2))
    return PointMatches(xyz, covariances, xy, np.full(count, SIGMA))


def test_exact_points_give_the_exact_pose():
    fit = fit_camera_pose(matches(1, noise=0.0))
    np.testing.assert_allclose(fit.T_map_camera, T_MAP_CAMERA, atol=1e-6)
    assert fit.inliers.all()


@pytest.mark.parametrize("wrong", [0, 40])
def test_the_covariance_is_that_of_the_errors(wrong):
    fits = [fit_camera_pose(matches(seed, 80 + wrong, wrong=wrong)) for seed in range(150)]
    errors = [sextant.pose_error(T_MAP_CAMERA, fit.T_map_camera) for fit in fits]
    values = [error @ np.linalg.solve(fit.covariance, error) for error, fit in zip(errors, fits)]
    low, high = nees_band(len(fits))
    false = 1 + MAX_ERROR**2 / 80 if wrong else 1.0  # one of 80 inliers with the largest possible error
    assert low < np.mean(values) < false * high


def test_wrong_matches_are_outliers():
    fit = fit_camera_pose(matches(3, 100, wrong=50))
    assert fit.inliers[50:].mean() > 0.95 and fit.inliers[:50].mean() < 0.05
    assert np.linalg.norm(fit.T_map_camera[:3, 3] - T_MAP_CAMERA[:3, 3]) < 0.05


@pytest.mark.parametrize(("count", "wrong"), [(0, 0), (5, 0), (30, 30)])
def test_there_is_no_pose_by_too_few_points(count, wrong):
    fit = fit_camera_pose(matches(4, count, wrong=wrong))
    assert fit is None or fit.inliers.sum() < 12
