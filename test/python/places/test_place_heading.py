# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Headings by matches: cameras that turn on the spot, and views of a simulated street."""

import numpy as np
import pytest
from made_photos import index_of
from posed_street import CAMERA, SIZE, STEP, street, view, write_street

from sextant.place_maps.place_map import Photo
from sextant.places.place_heading import MIN_MATCHES, turn_to_left
from sextant.places.place_localizer import PlaceLocalizationParams, PlaceLocalizer
from sextant.places.place_matches import MatchedPhoto

PHOTO = Photo(0, "0.png", 0.0, 0.0, 0.0)


def matches(angle, count, false=0):
    """Far points in two images; the second camera is turned to the left by the angle."""
    rng, camera = np.random.default_rng(count), CAMERA.model()
    points = np.c_[rng.uniform(-30, 30, count), rng.uniform(-10, 5, count), rng.uniform(60, 80, count)]
    cosine, sine = np.cos(angle), np.sin(angle)
    turned = points @ np.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]]).T
    photo_xy, query_xy = (np.asarray(camera.project_points(each)) / max(SIZE) for each in (points, turned))
    query_xy[:false] = rng.uniform(0, 0.75, (false, 2))
    return MatchedPhoto(PHOTO, query_xy, photo_xy, np.full(count, 0.3))


@pytest.mark.parametrize("angle", [-0.2, 0.0, 0.25])
@pytest.mark.parametrize("false", [0, 25])
def test_the_angle_between_two_cameras_is_found_despite_false_matches(angle, false):
    assert turn_to_left(matches(angle, 60, false), CAMERA.model()) == pytest.approx(angle, abs=0.01)


@pytest.mark.parametrize("count, false", [(MIN_MATCHES - 1, 0), (60, 60), (0, 0)])
def test_too_few_matches_have_no_angle(count, false):
    assert turn_to_left(matches(0.1, count, false), CAMERA.model()) is None


@pytest.mark.slow
def test_the_heading_in_a_map_without_poses_is_that_of_the_camera(tmp_path):
    _, place_map = write_street(tmp_path)
    photos = [photo._replace(yaw=street().pose(STEP * photo.id)[2]) for photo in place_map.photos]
    place_map = place_map._replace(photos=tuple(photos))
    given = place_map, index_of(place_map), PlaceLocalizationParams(mode="single")
    angle = 0.15
    image, _ = view(7.4, 0.2, angle, seed=99)
    truth = street().pose(7.4, 0.2, angle)[2]
    coarse, fine = (
        PlaceLocalizer(*given, same_camera=True).localize(image, camera=each).estimate
        for each in (None, CAMERA.model())
    )
    assert abs(coarse.yaw - truth) > 0.08
    assert fine.yaw == pytest.approx(truth, abs=0.05)
    assert fine.yaw_deviation < coarse.yaw_deviation / 3
    assert (fine.x, fine.y) == (coarse.x, coarse.y)
