# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Metric poses of images of a simulated street."""

import dataclasses

import numpy as np
import pytest
from posed_street import CAMERA, SIZE, STEP, errors, view, write_street

import sextant
from sextant.place_points.place_points_file import points_of_map
from sextant.place_points.point_localizer import PointLocalizer


@pytest.fixture(scope="module")
def points(tmp_path_factory):
    return points_of_map(*write_street(tmp_path_factory.mktemp("street")))


@pytest.mark.parametrize(("arc", "aside", "turn"), [(4.0, 0.4, 0.1), (7.5, -0.6, -0.08), (9.1, 0.0, 0.0)])
def test_a_pose_is_accurate_and_its_covariance_fits(points, arc, aside, turn):
    image, T = view(arc, aside, turn, seed=99)
    pose = PointLocalizer(points).localize(image, CAMERA.model(), f"{round(arc / STEP)}.png")
    distance, angle = errors(T, pose)
    assert distance < 0.05 and angle < 0.005 and pose.inliers > 30
    error = np.asarray(sextant.pose_error(T, pose.T_map_camera))
    assert error @ np.linalg.solve(pose.covariance, error) < 22.5  # 99.9 % of chi-square


def test_the_body_looks_ahead(points):
    image, T = view(6.0, seed=99)
    pose = PointLocalizer(points).localize(image, CAMERA.model(), "2.png")
    body = pose.T_map_body()
    np.testing.assert_allclose(body[:3, 3], T[:3, 3], atol=0.05)
    np.testing.assert_allclose(body[:3, 0], T[:3, 2], atol=0.01)  # x is the optical axis
    np.testing.assert_allclose(body[:3, 2], [0, 0, 1], atol=0.01)


def test_the_points_of_one_photo_are_not_enough(points):
    image, _ = view(6.0, seed=99)
    keep = points.photo == 2
    alone = dataclasses.replace(
        points, point=points.point[keep], photo=points.photo[keep], descriptors=points.descriptors[keep]
    )
    assert PointLocalizer(alone).localize(image, CAMERA.model(), "2.png") is None


def test_another_place_has_no_pose(points):
    image, _ = view(150.0, seed=99)
    assert PointLocalizer(points).localize(image, CAMERA.model(), "2.png") is None


def test_a_blank_image_and_a_photo_without_pose_have_no_pose(points):
    localizer, blank = PointLocalizer(points), np.full(SIZE[::-1], 90, np.uint8)
    assert localizer.localize(blank, CAMERA.model(), "2.png") is None
    assert localizer.localize(view(6.0)[0], CAMERA.model(), "of another drive.jpg") is None
