# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Rough poses: weights against the normal distribution, and maps in which every place has a double."""

import math

import cv2
import numpy as np
import pytest
from made_photos import index_of, picture, shifted
from scipy.stats import multivariate_normal

from sextant.place_maps.place_map import Overview, Photo, PlaceMap
from sextant.places.place_belief import PlaceBelief
from sextant.places.place_localizer import PlaceLocalizationParams, PlaceLocalizer, Status
from sextant.places.place_matches import MapPhotos
from sextant.places.rough_pose import DEVIATIONS, LEAST, TURNED, RoughPose, log_weights

COVARIANCE = np.array([[9.0, 3.0], [3.0, 4.0]])
COUNT = 12  # pictures, each at two places
APART = 400.0  # pixels between the two places


def test_photos_within_three_deviations_are_equal_and_others_fall_as_the_normal_distribution():
    rough = RoughPose(50.0, 20.0, COVARIANCE)
    axis = np.linalg.cholesky(COVARIANCE)[:, 0]  # one deviation
    positions = [50.0, 20.0] + np.outer([0.0, DEVIATIONS - 0.01, 3.5, 4.0, 30.0], axis)
    density = multivariate_normal([50.0, 20.0], COVARIANCE).logpdf(positions)
    edge = multivariate_normal([50.0, 20.0], COVARIANCE).logpdf([50.0, 20.0] + DEVIATIONS * axis)
    expected = np.clip(density - edge, LEAST, 0.0)
    assert log_weights(rough, positions, np.full(5, np.nan)) == pytest.approx(expected, abs=1e-9)
    assert expected[1] == 0.0 > expected[2] > expected[3] > expected[4] == LEAST


def test_photos_in_another_direction_are_excluded_unless_theirs_is_unknown():
    rough = RoughPose(0.0, 0.0, np.eye(2), yaw=math.pi - 0.1, yaw_deviation=0.1)
    across = -math.pi + 0.1  # 0.2 rad to the left
    weights = log_weights(
        rough, np.zeros((5, 2)), np.array([np.nan, across, across + TURNED, 0.0, across + TURNED + 0.2])
    )
    assert weights[:3] == pytest.approx([0, 0, 0])
    assert weights[3] == LEAST
    assert weights[4] == pytest.approx(-((0.2 + 0.2) ** 2 / 0.1**2 - DEVIATIONS**2) / 2)


def test_weights_do_not_change_the_probability_of_an_unknown_place():
    belief = PlaceBelief(np.c_[np.arange(4.0), np.zeros(4)])
    belief.restrict(np.log([1.0, 0.5, 0.25, 0.25]))
    assert belief.unknown == 0.5
    assert belief.places == pytest.approx([0.25, 0.125, 0.0625, 0.0625])


@pytest.fixture(scope="module")
def doubles(tmp_path_factory):
    """A map in which each picture was taken twice, far from each other, and in opposite directions."""
    folder, photos = tmp_path_factory.mktemp("doubles"), []
    for number in range(2 * COUNT):
        cv2.imwrite(str(folder / f"{number}.png"), picture(number % COUNT))
        second, place = divmod(number, COUNT)
        photos.append(Photo(number, f"{number}.png", APART * second + 10 * place, 50.0, second * math.pi))
    return PlaceMap(folder, Overview("town.png", 1000, 100), tuple(photos))


@pytest.fixture(scope="module")
def index(doubles):
    return index_of(doubles)


NEAR_SECOND = RoughPose(APART + 40, 50.0, 20.0**2 * np.eye(2))
COMPASS = RoughPose(0.0, 0.0, 1e6**2 * np.eye(2), yaw=math.pi, yaw_deviation=0.3)
FAR_OUTSIDE = RoughPose(-1e7, 0.0, 20.0**2 * np.eye(2))


def answer(doubles, index, rough, mode="single"):
    robot = PlaceLocalizer(doubles, index, PlaceLocalizationParams(mode=mode))
    images = [shifted(picture(place), 9, 3, 6.0, place) for place in (2, 3, 4)]
    return [robot.localize(image, rough=rough) for image in images][-1]


@pytest.mark.slow
@pytest.mark.parametrize("mode", ["single", "filter", "sequence"])
@pytest.mark.parametrize("rough", [NEAR_SECOND, COMPASS])
def test_a_rough_pose_decides_between_places_that_look_alike(doubles, index, rough, mode):
    found = answer(doubles, index, rough, mode)
    assert found.status == Status.LOCALIZED
    assert found.hypotheses[0].photo.id == COUNT + 4


@pytest.mark.parametrize("rough", [None, FAR_OUTSIDE])
def test_without_one_in_the_map_they_remain_equal(doubles, index, rough):
    found = answer(doubles, index, rough)
    assert found.status != Status.LOCALIZED
    first, second = found.hypotheses[:2]
    assert {first.photo.id, second.photo.id} == {4, COUNT + 4}
    assert first.probability == pytest.approx(second.probability)


def test_an_image_of_elsewhere_remains_unknown_with_a_rough_pose(doubles, index):
    robot = PlaceLocalizer(doubles, index, PlaceLocalizationParams(mode="single"))
    for seed in (300, 301, 302):
        assert robot.localize(picture(seed), rough=NEAR_SECOND).status == Status.UNKNOWN_PLACE


@pytest.mark.parametrize("place", [2, 5, 9])
def test_a_small_region_does_not_make_its_images_unknown(doubles, index, place):
    """Its photos are all near the correct one, so they alone are no evidence."""
    first = doubles._replace(photos=doubles.photos[:COUNT])
    robot = PlaceLocalizer(first, index, PlaceLocalizationParams(mode="single"))
    rough = RoughPose(10.0 * place, 50.0, 4.0**2 * np.eye(2))
    image = shifted(picture(place), 9, 3, 60.0, place)
    alone, given = (robot.localize(image, rough=each) for each in (None, rough))
    assert given.unknown_probability <= alone.unknown_probability + 1e-3
    assert given.hypotheses[0].photo.id == place


@pytest.mark.slow
def test_places_with_photos_in_several_directions_are_as_probable_as_others(tmp_path):
    """Dark images, and a compass: a photo of each place is in its direction."""
    photos = []
    for number in range(12):
        cv2.imwrite(str(tmp_path / f"{number}.png"), picture(number))
        place, direction = (number, 0) if number < 4 else (4 + (number - 4) // 4, number % 4)
        photos.append(Photo(number, f"{number}.png", 10.0 * place, 50.0, direction * math.pi / 2))
    place_map = PlaceMap(tmp_path, Overview("town.png", 1000, 100), tuple(photos))
    robot = PlaceLocalizer(place_map, index_of(place_map), PlaceLocalizationParams(mode="filter"))
    compass = COMPASS._replace(yaw=0.0)
    probabilities = []
    for rough in (None, compass):
        robot.reset()
        for _ in range(6):
            found = robot.localize(np.zeros((240, 320), np.uint8), rough=rough)
        probabilities.append({each.photo.x: each.probability for each in found.hypotheses})
    assert len(probabilities[0]) > 1
    assert probabilities[1] == pytest.approx(probabilities[0])


def test_weights_of_a_place_are_divided_among_its_photos(doubles, index):
    places = [photo._replace(x=10.0 * (photo.id // 2)) for photo in doubles.photos]
    photos = MapPhotos(doubles._replace(photos=tuple(places)), index)
    weights = np.zeros(2 * COUNT)
    weights[[0, 2, 3]] = -1.0, -2.0, -3.0
    assert photos.of_best(weights)[:3] == pytest.approx([0.0, -2.0, 0.0])
    shares = photos.weighted_shares(weights).reshape(-1, 2)
    total = COUNT - 1 + math.exp(-2)
    assert shares.sum(axis=1)[:3] == pytest.approx(np.array([1.0, math.exp(-2), 1.0]) / total)
    assert shares[:, 1][:3] / shares[:, 0][:3] == pytest.approx([math.e, 1 / math.e, 1.0])
