# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Of several boxes on one thing, the surest is told."""

import numpy as np
import pytest

from sextant.objects.detection import NOTHING, Detections, check_picture, names_of, suppressed

# The second and the third overlap the first by 1/3 and 9/11.
BOXES = np.array([[0, 0, 10, 10], [5, 0, 15, 10], [0, 1, 10, 11], [40, 40, 50, 50]], float)
SCORES = np.array([0.9, 0.8, 0.7, 0.6])


def kept(classes, overlap, class_agnostic=False, most=100):
    found = suppressed(Detections(BOXES, SCORES, np.array(classes)), overlap, class_agnostic, most)
    assert all(len(part) == len(found.scores) for part in found)
    return [SCORES.tolist().index(score) for score in found.scores]


@pytest.mark.parametrize(
    "overlap, left",
    [(0.3, [0, 3]), (0.34, [0, 1, 3]), (0.81, [0, 1, 3]), (0.83, [0, 1, 2, 3]), (1.0, [0, 1, 2, 3])],
)
def test_two_are_one_from_an_overlap_on(overlap, left):
    assert kept([0, 0, 0, 0], overlap) == left


def test_things_of_two_classes_are_two_unless_it_is_told_otherwise():
    assert kept([0, 0, 1, 0], 0.5) == [0, 1, 2, 3]
    assert kept([0, 0, 1, 0], 0.5, class_agnostic=True) == [0, 1, 3]


def test_the_surest_are_told():
    assert kept([0, 1, 2, 3], 0.5, most=2) == [0, 1]


def test_of_nothing_nothing_is_left():
    assert len(suppressed(NOTHING, 0.5, False, 10).boxes) == 0


def test_classes_are_named():
    assert names_of(np.array([1, 0, 1]), ["ball", "pillar"]) == ["pillar", "ball", "pillar"]


@pytest.mark.parametrize(
    "shape, kind", [((4, 4), "uint8"), ((4, 4, 4), "uint8"), ((0, 4, 3), "uint8"), ((4, 4, 3), "float32")]
)
def test_what_is_no_colour_picture_is_refused(shape, kind):
    with pytest.raises(ValueError, match=r"it must be uint8 \(height, width, 3\)"):
        check_picture(np.zeros(shape, kind))
