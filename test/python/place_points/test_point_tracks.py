# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tracks of keypoints with known correspondences."""

import numpy as np
import pytest
from test_point_triangulation import POSES, SIGMA, pose, scene, seen

from sextant.place_points.point_keypoints import PointKeypoints
from sextant.place_points.point_tracks import neighbours, point_tracks

COUNT = 60


def photos(noise=5.0, poses=POSES):
    """Keypoints of all points in all photos, in another order in each photo, and the point of each."""
    rng = np.random.default_rng(3)
    known, observations = rng.uniform(0, 255, (COUNT, 128)), seen(scene(COUNT), poses=poses)
    keypoints, points = [], []
    for photo in range(len(poses)):
        order = rng.permutation(COUNT)
        descriptors = np.rint(np.clip(known[order] + rng.normal(0, noise, (COUNT, 128)), 0, 255))
        xy = observations.xy[observations.photo == photo][order]
        ones = np.ones(COUNT)
        descriptors = descriptors.astype(np.uint8)
        keypoints.append(PointKeypoints(xy, SIGMA * ones, 4 * ones, descriptors, np.nan * ones))
        points.append(order)
    return keypoints, np.concatenate(points)


def test_a_track_is_one_point_in_all_photos():
    keypoints, truth = photos()
    observations, rows = point_tracks(POSES, keypoints)
    assert len(rows) > 0.9 * 4 * COUNT
    for point in range(observations.point.max() + 1):
        assert len(set(truth[rows[observations.point == point]])) == 1
    np.testing.assert_array_equal(observations.photo, rows // COUNT)


def test_a_match_far_from_the_epipolar_line_is_none():
    keypoints, truth = photos()
    moved = keypoints[2].xy + [0.0, 0.1]
    observations, _ = point_tracks(POSES, [*keypoints[:2], keypoints[2]._replace(xy=moved), keypoints[3]])
    assert np.mean(observations.photo == 2) < 0.05


def test_two_keypoints_of_one_photo_are_no_point():
    keypoints, _ = photos()
    twice = PointKeypoints(*(np.concatenate([each, each]) for each in keypoints[0]))
    observations, _ = point_tracks(POSES[:2], [twice, keypoints[1]])
    assert not len(observations.point)


def test_a_keypoint_with_depth_may_be_alone():
    keypoints, _ = photos()
    depth = np.where(np.arange(COUNT) < 7, 2.0, np.nan)
    observations, rows = point_tracks(POSES[:1], [keypoints[0]._replace(depth=depth)])
    assert rows.tolist() == list(range(7)) and len(set(observations.point)) == 7
    np.testing.assert_array_equal(observations.depth, 2.0)


@pytest.mark.parametrize("count", [0, 1])
def test_photos_without_keypoints_have_no_tracks(count):
    none = PointKeypoints(*(each[:count] for each in photos()[0][0]))
    observations, rows = point_tracks(POSES, [none] * 4)
    assert not len(rows) and not len(observations.point)


def test_neighbours_look_in_a_similar_direction():
    poses = np.array([pose(0), pose(1, yaw=np.pi), pose(5), pose(3, yaw=0.5), pose(4, yaw=1.0)])
    assert neighbours(poses, 0, 9).tolist() == [3, 2]
    assert neighbours(poses, 0, 1).tolist() == [3]
