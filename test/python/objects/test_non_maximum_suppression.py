# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Non-maximum suppression keeps the box with the highest score."""

import numpy as np
import pytest

from sextant.objects.detections import NO_DETECTIONS, Detections
from sextant.objects.non_maximum_suppression import non_maximum_suppression

# The second and the third overlap the first by 1/3 and 9/11.
BOXES = np.array([[0, 0, 10, 10], [5, 0, 15, 10], [0, 1, 10, 11], [40, 40, 50, 50]], float)
SCORES = np.array([0.9, 0.8, 0.7, 0.6])


def kept(classes, max_overlap, class_agnostic=False, max_objects=100):
    found = non_maximum_suppression(
        Detections(BOXES, SCORES, np.array(classes)), max_overlap, class_agnostic, max_objects
    )
    assert all(len(part) == len(found.scores) for part in found)
    return [SCORES.tolist().index(score) for score in found.scores]


@pytest.mark.parametrize(
    "overlap, left",
    [(0.3, [0, 3]), (0.34, [0, 1, 3]), (0.81, [0, 1, 3]), (0.83, [0, 1, 2, 3]), (1.0, [0, 1, 2, 3])],
)
def test_boxes_are_suppressed_from_an_overlap_on(overlap, left):
    assert kept([0, 0, 0, 0], overlap) == left


def test_boxes_of_two_classes_are_kept_unless_class_agnostic():
    assert kept([0, 0, 1, 0], 0.5) == [0, 1, 2, 3]
    assert kept([0, 0, 1, 0], 0.5, class_agnostic=True) == [0, 1, 3]


def test_only_the_highest_scores_are_kept():
    assert kept([0, 1, 2, 3], 0.5, max_objects=2) == [0, 1]


def test_no_detections_stay_none():
    assert len(non_maximum_suppression(NO_DETECTIONS, 0.5, False, 10).boxes) == 0
