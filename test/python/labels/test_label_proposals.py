# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Proposals of a detector that always finds the same."""

import numpy as np
from made_labels import write_photos

from sextant.labels.label_proposals import proposed_labels
from sextant.objects.detections import Detections


class Same:
    """Finds an object in each photo, and an empty box."""

    classes, notes, seconds = ["goal", "ball"], [], {}

    def detect(self, image):
        assert image.shape == (60, 80, 3) and image.dtype == np.uint8
        boxes = np.array([[1.0, 2, 30, 40], [5, 5, 5, 9]])
        return Detections(boxes, np.array([0.9, 0.5]), np.array([1, 0]))


def test_what_a_detector_finds_is_proposed(tmp_path):
    paths = [photo.path for photo in write_photos(tmp_path, 2).photos]
    photos, scores = proposed_labels(paths, Same())
    assert photos.classes == ("goal", "ball") and [photo.path for photo in photos.photos] == paths
    for photo, score in zip(photos.photos, scores):
        assert photo.boxes.tolist() == [[1, 2, 30, 40]] and photo.classes.tolist() == [1]
        assert score.tolist() == [0.9]
