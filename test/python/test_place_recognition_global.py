# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A global descriptor recognizes what keypoints cannot, and spoils nothing that they can."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from made_network import pooling_network
from made_photos import index_of, picture, shifted, written_photos

from sextant.places.global_descriptor import GlobalDescriptorSettings
from sextant.places.place_index import IndexSettings
from sextant.places.place_recognition import PlaceRecognizer, RecognitionParams

COUNT = 30


@pytest.fixture(scope="module")
def place_map(tmp_path_factory):
    return written_photos(tmp_path_factory.mktemp("map"), COUNT)


@pytest.fixture(scope="module")
def index(place_map):
    model = pooling_network(place_map.folder / "net.onnx")
    shown = GlobalDescriptorSettings(model, mean=(0.5, 0.5, 0.5), std=(1.0, 1.0, 1.0))
    return index_of(place_map, IndexSettings(global_descriptor=shown))


@pytest.fixture(scope="module")
def recognizer_of(place_map, index):
    """By the weight of the global descriptor."""
    return {
        weight: PlaceRecognizer(place_map, index, RecognitionParams(global_weight=weight))
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


def test_places_are_recognized_out_of_focus(recognizer_of):
    votes, fused, more = (recall(recognizer_of[weight], 25) for weight in (0, 1, 2))
    assert votes < 0.6 and fused > 0.7 and more > 0.9


def test_places_in_focus_stay_recognized(recognizer_of):
    for place in range(0, COUNT, 5):
        found = recognizer_of[1].recognize(blurred(place, 1))
        assert likeliest(found) == place
        assert found.log_ratios[place] > np.delete(found.log_ratios, place).max() + 5


def test_without_a_keypoint_the_descriptor_decides(recognizer_of):
    grey = cv2.GaussianBlur(shifted(picture(8), 12, 4, 0.0), (0, 0), 40)
    image = cv2.merge([grey // 16 + 120] * 3)
    found, votes = recognizer_of[1].recognize(image), recognizer_of[0].recognize(image)
    assert found.statistics.keypoints == 0 and not votes.scores.any()
    assert likeliest(found) == 8 and len(found.match.weights) == 0


def test_with_weight_0_it_is_as_if_there_were_none(place_map, index, recognizer_of):
    plain = PlaceRecognizer(place_map, index_of(place_map, replace(index.settings, global_descriptor=None)))
    for image in (blurred(3, 1), blurred(4, 25), picture(100)):
        with_it, without = recognizer_of[0].recognize(image), plain.recognize(image)
        assert np.array_equal(with_it.scores, without.scores)
        assert np.array_equal(with_it.log_ratios, without.log_ratios)


def test_vectors_are_those_of_the_maps_photos_in_any_order(place_map, index):
    turned = place_map._replace(photos=place_map.photos[::-1])
    recognizer = PlaceRecognizer(turned, index, RecognitionParams(global_weight=100))
    assert likeliest(recognizer.recognize(blurred(2, 25))) == COUNT - 1 - 2


def test_a_weight_out_of_range_is_refused(place_map, index):
    with pytest.raises(ValueError, match=r"global_weight is -1, allowed is \[0, 100\]"):
        PlaceRecognizer(place_map, index, RecognitionParams(global_weight=-1))
