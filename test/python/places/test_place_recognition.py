# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of places that the tests make are recognized, others are not; so is the external test data."""

import csv
from pathlib import Path

import cv2
import numpy as np
import pytest
from made_photos import index_of, picture, shifted, written_photos

from sextant.place_maps.place_map import Overview, Photo, PlaceMap
from sextant.places.index_params import IndexParams, plain_features
from sextant.places.place_belief import PlaceBelief
from sextant.places.place_metrics import precision_recall
from sextant.places.place_recognition import PlaceRecognizer, RecognitionParams

CORRIDOR = Path(__file__).resolve().parents[4] / "shared" / "data" / "places" / "corridor"
COUNT = 20


@pytest.fixture(scope="module")
def place_map(tmp_path_factory):
    return written_photos(tmp_path_factory.mktemp("map"), COUNT)


@pytest.fixture(scope="module")
def recognizer(place_map):
    return PlaceRecognizer(place_map, index_of(place_map))


@pytest.mark.slow
@pytest.mark.parametrize("place", range(0, COUNT, 3))
def test_an_image_is_recognized(recognizer, place):
    found = recognizer.recognize(shifted(picture(place), 12, 4, 6.0))
    assert found.scores.argmax() == place
    assert found.log_ratios[place] > np.delete(found.log_ratios, place).max() + 5
    assert found.match.photo.id == place


def test_keypoints_of_a_match_lie_where_the_image_was_moved_to(recognizer):
    match = recognizer.recognize(shifted(picture(4), 16, 8)).match
    moved = np.median(match.query_xy - match.photo_xy, axis=0)
    assert moved * 320 == pytest.approx([16, 8], abs=0.5)


def test_images_of_elsewhere_are_probably_of_an_unknown_place(place_map, recognizer):
    unknown = []
    for i in range(8):
        belief = PlaceBelief(np.array([place[0][2:4] for place in place_map.places()]))
        belief.update(recognizer.recognize(picture(100 + i)).log_ratios)
        unknown.append(belief.unknown)
    assert np.mean(unknown) > 0.5 and max(unknown) < 0.9  # one image is not enough to be certain


@pytest.mark.parametrize("image", [np.full((240, 320), 90, np.uint8), np.zeros((1, 1), np.uint8)])
def test_an_image_without_anything_gives_no_evidence(recognizer, image):
    found = recognizer.recognize(image)
    assert found.statistics.keypoints == 0
    assert not found.scores.any() and not found.log_ratios.any()


@pytest.mark.slow
def test_photos_of_one_place_speak_for_it_together(tmp_path):
    place_map = written_photos(tmp_path, 8)
    photos = tuple(photo._replace(x=photo.x - photo.x % 20) for photo in place_map.photos)  # two and two
    recognizer = PlaceRecognizer(place_map._replace(photos=photos), index_of(place_map))
    found = recognizer.recognize(shifted(picture(5), 5, 5))
    assert len(found.scores) == 4 and found.scores.argmax() == 2
    assert found.best_photos[2].id == 5


@pytest.mark.slow
def test_a_turned_image_of_plain_features_is_recognized(place_map, tmp_path):
    recognizer = PlaceRecognizer(place_map, index_of(place_map, IndexParams(plain_features("SIFT", "SIFT"))))
    assert recognizer.recognize(cv2.rotate(picture(7), cv2.ROTATE_180)).scores.argmax() == 7


@pytest.mark.parametrize(
    "changed, reason",
    [
        ({"min_keypoints": 0}, r"min_keypoints: must be within \[1, 100000\], is 0"),
        ({"network_weight": -1}, r"network_weight: must be within \[0, 100\], is -1"),
        ({"min_contrast": -1}, r"min_contrast: must be within \[0, 128\], is -1"),
    ],
)
def test_parameters_out_of_range_are_refused(changed, reason):
    with pytest.raises(ValueError, match=reason):
        RecognitionParams(**changed)


@pytest.mark.slow
@pytest.mark.skipif(not CORRIDOR.is_dir(), reason="external test data")
def test_a_corridor_is_recognized():
    names = sorted(path.name for path in (CORRIDOR / "ref").glob("*.jpg"))
    photos = tuple(Photo(i, name, float(i), 1.0) for i, name in enumerate(names))
    place_map = PlaceMap(CORRIDOR / "ref", Overview("none.png", 200, 2), photos)
    recognizer = PlaceRecognizer(place_map, index_of(place_map))
    right, confidence = [], []
    with open(CORRIDOR / "truth.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        found = recognizer.recognize(cv2.imread(str(CORRIDOR / "query" / row["query"]), cv2.IMREAD_GRAYSCALE))
        right.append(names[int(found.scores.argmax())] in row["right_refs"].split())
        confidence.append(found.log_ratios.max())
    assert np.mean(right) >= 0.93
    assert precision_recall(confidence, right).area >= 0.86
