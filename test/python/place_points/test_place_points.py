# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Points of a map from photos of known points."""

import numpy as np
import pytest
from test_point_triangulation import SIGMA, pose, scene, seen

from sextant.place_points.place_points import MIN_POSES, triangulated_points
from sextant.place_points.point_keypoints import PointKeypoints

POSES = np.array([pose(1.0 * i) for i in range(MIN_POSES + 2)])
COUNT = 80


def photos(noise):
    rng = np.random.default_rng(5)
    observations = seen(scene(COUNT), poses=POSES, noise=noise)
    known, ones = np.rint(rng.uniform(0, 255, (COUNT, 128))).astype(np.uint8), np.ones(COUNT)
    return [
        PointKeypoints(observations.xy[observations.photo == i], SIGMA * ones, 4 * ones, known, np.nan * ones)
        for i in range(len(POSES))
    ]


@pytest.mark.parametrize("noise", [1.0, 2.0])
def test_noise_is_calibrated(noise):
    points = triangulated_points([str(i) for i in range(len(POSES))], POSES, photos(noise))
    assert len(points.xyz) > 0.8 * COUNT
    assert points.sigma_factor == pytest.approx(noise, rel=0.2)
    assert 1.0 <= points.covariance_factor < 1.6
    nearest = np.linalg.norm(points.xyz[:, None] - scene(COUNT), axis=2).min(axis=1)
    assert np.median(nearest) < 0.1 * noise


def test_depth_gives_points_to_a_single_photo():
    known = seen(0.25 * scene(COUNT) + [1, 0, 0], poses=POSES[:1], depth_noise=1.0)
    keypoints = photos(1.0)[0]._replace(xy=known.xy, depth=known.depth)
    points = triangulated_points(["0"], POSES[:1], [keypoints])
    assert len(points.xyz) == COUNT
    truth = 0.25 * scene(COUNT) + [1, 0, 0]
    error = points.xyz - truth
    squared = np.einsum("ni,nij,nj->n", error, np.linalg.inv(points.covariances), error)
    assert 0.2 < squared.mean() / 3 < 1.0  # FIRST_FACTOR is assumed for the noise of keypoints


def test_photos_without_keypoints_have_no_points():
    none = [PointKeypoints(*(each[:0] for each in photo)) for photo in photos(1.0)]
    points = triangulated_points([str(i) for i in range(len(POSES))], POSES, none)
    assert not len(points.xyz) and not len(points.point)
