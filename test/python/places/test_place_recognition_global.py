# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A global descriptor recognizes what keypoints cannot, and spoils nothing that they can."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from made_network import pooling_network, root_network
from made_photos import index_of, picture, shifted, written_photos

from sextant.places.global_descriptor import GlobalDescriptorParams
from sextant.places.index_params import IndexParams
from sextant.places.place_localizer import PlaceLocalizationParams, PlaceLocalizer, Status
from sextant.places.place_recognition import PlaceRecognizer, RecognitionParams, contrast

COUNT = 30


@pytest.fixture(scope="module")
def place_map(tmp_path_factory):
    return written_photos(tmp_path_factory.mktemp("map"), COUNT)


@pytest.fixture(scope="module")
def index(place_map):
    model = pooling_network(place_map.folder / "net.onnx")
    shown = GlobalDescriptorParams(model, mean=(0.5, 0.5, 0.5), std=(1.0, 1.0, 1.0))
    return index_of(place_map, IndexParams(global_descriptor=shown))


@pytest.fixture(scope="module")
def recognizer_of(place_map, index):
    """By the weight of the global descriptor."""
    return {
        weight: PlaceRecognizer(place_map, index, RecognitionParams(network_weight=weight))
        for weight in (0, 1, 2)
    }


def blurred(place, sigma):
    """What a camera sees a bit farther on, out of focus."""
    return shifted(cv2.GaussianBlur(shifted(picture(place), 12, 4, 0.0), (0, 0), sigma), 0, 0)


def likeliest(found):
    return found.log_ratios.argmax()


def recall(recognizer, sigma):
    places = range(0, COUNT, 2)
    return np.mean([likeliest(recognizer.recognize(blurred(place, sigma))) == place for place in places])


@pytest.mark.slow
def test_places_are_recognized_out_of_focus(recognizer_of):
    votes, fused, more = (recall(recognizer_of[weight], 25) for weight in (0, 1, 2))
    assert votes < 0.8 and fused > 0.9 and more > 0.9


def test_places_in_focus_stay_recognized(recognizer_of):
    for place in range(0, COUNT, 5):
        found = recognizer_of[1].recognize(blurred(place, 1))
        assert likeliest(found) == place
        assert found.log_ratios[place] > np.delete(found.log_ratios, place).max() + 5


def fog(place):
    """Without a keypoint."""
    grey = cv2.GaussianBlur(shifted(picture(place), 12, 4, 0.0), (0, 0), 40)
    return cv2.merge([grey // 16 + 120] * 3)


def covered(noise=0.0, level=0.0):
    """What a camera with its lens covered sees: its noise."""
    seen = np.random.default_rng(1).normal(level, noise, (240, 320, 3))
    return np.clip(seen, 0, 255).astype(np.uint8)


def test_without_a_keypoint_the_descriptor_decides(recognizer_of):
    found, votes = recognizer_of[1].recognize(fog(8)), recognizer_of[0].recognize(fog(8))
    assert found.statistics.keypoints == 0 and not votes.scores.any()
    assert likeliest(found) == 8 and len(found.match.weights) == 0
    assert (found.usable, found.is_absolute) == (True, False) and not votes.usable


def test_without_a_keypoint_the_unknown_probability_is_unchanged(recognizer_of):
    for weight in (1, 2):
        assert np.exp(recognizer_of[weight].recognize(fog(8)).log_ratios).mean() == pytest.approx(1.0)


def test_places_count_alike_however_many_photos_they_have(place_map, index):
    """Photos 0 to 4 are one place, the others one each."""
    photos = [photo._replace(x=0.0) if photo.id < 5 else photo for photo in place_map.photos]
    recognizer = PlaceRecognizer(place_map._replace(photos=tuple(photos)), index)
    found = recognizer.recognize(fog(8))
    assert len(found.log_ratios) == COUNT - 4
    assert np.exp(found.log_ratios).mean() == pytest.approx(1.0)


@pytest.mark.parametrize("noise, level", [(0.0, 0), (0.0, 255), (1.0, 10), (8.0, 10), (10.0, 200)])
def test_of_an_image_of_nothing_the_network_is_not_asked(recognizer_of, noise, level):
    image = covered(noise, level)
    found, votes = recognizer_of[2].recognize(image), recognizer_of[0].recognize(image)
    assert found.usable == votes.usable == (noise > 5)  # has keypoints, which are of no place
    assert np.array_equal(found.log_ratios, votes.log_ratios)


@pytest.mark.parametrize("image", [covered(), covered(1.0, 10), covered()[..., 0] + 255])
def test_an_image_of_nothing_is_unusable_for_a_network_too(place_map, index, image):
    robot = PlaceLocalizer(place_map, index, PlaceLocalizationParams())
    before = [robot.localize(blurred(place, 1)) for place in (3, 4, 5)][-1]
    after = robot.localize(image)
    assert (before.status, after.status) == (Status.LOCALIZED, Status.UNUSABLE)


@pytest.mark.slow
def test_an_image_that_the_network_makes_no_number_of_leaves_no_trace(place_map):
    model = root_network(place_map.folder / "root.onnx")
    shown = GlobalDescriptorParams(model, mean=(0.25, 0.25, 0.25))
    index = index_of(place_map, IndexParams(global_descriptor=shown))
    robot, other = (PlaceLocalizer(place_map, index) for _ in range(2))
    for each in (robot, other):
        each.localize(blurred(3, 1))
    with pytest.raises(ValueError, match="root.onnx: its output is not finite"):
        robot.localize(picture(3) // 5)
    after, expected = (each.localize(blurred(4, 1)).hypotheses for each in (robot, other))
    assert [each[:2] for each in after] == [each[:2] for each in expected]


def test_the_least_contrast_can_be_set(place_map, index):
    strict = PlaceRecognizer(place_map, index, RecognitionParams(min_contrast=5.0))
    assert not strict.recognize(fog(8)).usable
    assert strict.recognize(blurred(3, 1)).usable


def test_contrast_is_that_of_the_parts():
    halves = np.zeros((240, 320), np.uint8)
    halves[:, 160:] = 10
    assert contrast(halves) == pytest.approx(5.0)
    assert contrast(cv2.merge([halves * 0, halves, halves * 0])) == pytest.approx(5.0)
    noise = np.random.default_rng(2).normal(100, 20, (240, 320)).astype(np.uint8)
    assert contrast(noise) == pytest.approx(20 / np.sqrt(30 * 40), rel=0.25)  # of 64 means of 1200 pixels


@pytest.mark.slow
def test_with_weight_0_it_is_as_if_there_were_none(place_map, index, recognizer_of):
    plain = PlaceRecognizer(place_map, index_of(place_map, replace(index.params, global_descriptor=None)))
    for image in (blurred(3, 1), blurred(4, 25), picture(100)):
        with_it, without = recognizer_of[0].recognize(image), plain.recognize(image)
        assert np.array_equal(with_it.scores, without.scores)
        assert np.array_equal(with_it.log_ratios, without.log_ratios)


def test_vectors_are_those_of_the_maps_photos_in_any_order(place_map, index):
    turned = place_map._replace(photos=place_map.photos[::-1])
    recognizer = PlaceRecognizer(turned, index, RecognitionParams(network_weight=100))
    assert likeliest(recognizer.recognize(blurred(2, 25))) == COUNT - 1 - 2
