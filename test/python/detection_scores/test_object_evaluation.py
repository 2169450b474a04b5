# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Evaluations of detectors whose mistakes are known."""

import numpy as np
import pytest
from made_labels import write_photos

from sextant.detection_scores.object_evaluation import evaluate_objects
from sextant.images.photo_depth import depth_path, encoded_depth
from sextant.objects.detections import Detections


class Known:
    """Returns the labels of the photos in their order, with mistakes."""

    notes, seconds = [], {}

    def __init__(self, photos, mistake):
        self.classes, self._answers = list(photos.classes), iter(photos.photos)
        self._mistake = mistake

    def detect(self, image):
        photo = next(self._answers)
        assert image.shape == (60, 80, 3)
        boxes, scores, classes = self._mistake(photo)
        order = np.argsort(-np.array(scores, float), kind="stable")
        boxes = np.array(boxes, float).reshape(-1, 4)
        return Detections(boxes[order], np.array(scores, float)[order], np.array(classes, int)[order])


def evaluated(tmp_path, mistake, count=6, confidence=0.4):
    photos = write_photos(tmp_path, count)  # with 0, 1, ... objects
    return evaluate_objects("made", photos, Known(photos, mistake), (64, 64), confidence)


def test_a_detector_without_mistakes(tmp_path):
    found = evaluated(tmp_path, lambda photo: (photo.boxes, [0.9] * len(photo.boxes), photo.classes))
    assert found.score.mean == found.map_50_95 == 1.0
    assert found.matched.recall(0.4) == found.matched.precision(0.4) == 1.0
    assert found.matched.false_alarms(0.4, found.photos) == 0.0 and found.worst == []
    assert found.recommended(0.0) == 0.05 and len(found.milliseconds) == found.photos == 6
    np.testing.assert_array_equal(np.diag(found.score.table)[:2].sum(), 15)


def test_missed_and_false_ones(tmp_path):
    """Of each photo one object is missed, and a box is where there is nothing, of score 0.5."""

    def mistake(photo):
        boxes, classes = photo.boxes[1:].tolist(), photo.classes[1:].tolist()
        return [*boxes, [70, 50, 79, 59]], [*[0.8] * len(boxes), 0.5], [*classes, 0]

    found = evaluated(tmp_path, mistake)
    assert found.matched.recall(0.4) == pytest.approx(10 / 15)
    assert found.matched.precision(0.4) == pytest.approx(10 / 16)
    assert found.matched.false_alarms(0.4, 6) == 1.0 and found.matched.false_alarms(0.6, 6) == 0.0
    assert found.recommended(0.02) == 0.51 and np.isnan(found.recommended(-1.0))
    assert found.worst[-1] == 0 and sorted(found.worst) == list(range(6))
    assert found.score.table[2].sum() == 6 and found.score.table[:2, 2].sum() == 5


def test_a_wrong_class_is_a_false_alarm_and_a_missed_object(tmp_path):
    found = evaluated(tmp_path, lambda photo: (photo.boxes, [0.9] * len(photo.boxes), 1 - photo.classes))
    assert found.matched.recall(0.4) == 0.0 and found.matched.precision(0.4) == 0.0
    assert found.score.mean == 0.0


def test_loose_boxes_count_at_small_overlaps_only(tmp_path):
    """Boxes three quarters as high have an overlap of 0.75: right at 0.5, 0.55, ... 0.75, six of ten."""

    def mistake(photo):
        boxes = photo.boxes.copy()
        boxes[:, 3] -= 0.2499 * (boxes[:, 3] - boxes[:, 1])
        return boxes, [0.9] * len(boxes), photo.classes

    found = evaluated(tmp_path, mistake)
    assert found.score.mean == 1.0 and found.map_50_95 == pytest.approx(0.6)


def test_reliability_of_scores(tmp_path):
    """Each object is found with a score of 0.75, and with each a box of the same score that is wrong."""

    def mistake(photo):
        boxes = [*photo.boxes.tolist(), *[[70, 50, 79, 59]] * len(photo.boxes)]
        return boxes, [0.75] * len(boxes), [*photo.classes, *photo.classes]

    mean, right, count = evaluated(tmp_path, mistake).reliability()
    assert count.tolist() == [0, 0, 0, 0, 0, 0, 0, 30, 0, 0]
    assert mean[7] == pytest.approx(0.75) and right[7] == pytest.approx(0.5) and np.isnan(mean[0])


def test_groups_by_size_and_distance(tmp_path):
    """Small objects are missed; the objects of the photos are 1, 2, ... metres away."""
    photos = write_photos(tmp_path, 7)
    for number, photo in enumerate(photos.photos):
        depth = np.full((60, 80), float(number), np.float32)
        depth_path(photo.path).write_bytes(encoded_depth(depth))
    areas = [np.prod(photo.boxes[:, 2:] - photo.boxes[:, :2], axis=1) for photo in photos.photos]
    middle = np.median(np.concatenate(areas))

    def mistake(photo):
        large = np.prod(photo.boxes[:, 2:] - photo.boxes[:, :2], axis=1) > middle
        return photo.boxes[large], [0.9] * int(large.sum()), photo.classes[large]

    groups = evaluated(tmp_path, mistake, 7).groups
    assert list(groups) == ["size", "light", "distance"]
    small, _, large = groups["size"]
    assert small.recall == 0.0 and large.recall == 1.0
    near, _, far = groups["distance"]
    assert near.name.startswith("near (1.0 m") and far.name.endswith("6.0 m)")
    assert sum(group.objects for group in groups["distance"]) == 21


def test_photos_without_objects_have_no_groups(tmp_path):
    found = evaluated(tmp_path, lambda photo: ([[1, 1, 9, 9]], [0.9], [0]), 1)
    assert found.groups == {} and found.matched.false_alarms(0.4, 1) == 1.0
    assert np.isnan(found.matched.recall(0.4))
