# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Average precision and the table of confusions, against cases worked out by hand."""

import numpy as np
import pytest

from sextant.detection_scores.average_precision import (
    TrueObjects,
    detector_score,
    overlaps,
    recall_and_precision,
)
from sextant.objects.detections import NO_DETECTIONS, Detections

BOXES = np.array([[0.0, 0, 10, 10], [20, 0, 30, 10], [40, 0, 50, 10]])


def known(classes, is_counted=None):
    many = len(classes)
    return TrueObjects(BOXES[:many], np.array(classes), np.array(is_counted or [True] * many))


def found(*rows):
    """Of (index of a box or a box, score, class), the surest first."""
    boxes = np.array([BOXES[row[0]] if isinstance(row[0], int) else row[0] for row in rows])
    return Detections(boxes, np.array([row[1] for row in rows]), np.array([row[2] for row in rows]))


def test_all_found_and_nothing_else():
    score = detector_score([found((0, 0.9, 0), (1, 0.8, 1))], [known([0, 1])], 2, 0.5)
    np.testing.assert_allclose(score.precision, [1.0, 1.0])
    assert score.mean == 1.0
    np.testing.assert_array_equal(score.table, [[1, 0, 0], [0, 1, 0], [0, 0, 0]])


def test_a_false_one_between_two_right_ones():
    # right, wrong, right of three: recall 1/3, 1/3, 2/3 at precision 1, 1/2, 2/3; falling: 1, 2/3, 2/3.
    rows = found((0, 0.9, 0), (np.array([100.0, 0, 110, 10]), 0.8, 0), (1, 0.7, 0))
    score = detector_score([rows], [known([0, 0, 0])], 1, 0.5)
    assert score.mean == pytest.approx(1.0 / 3.0 + 2.0 / 9.0)
    np.testing.assert_array_equal(score.table, [[2, 1], [1, 0]])


def test_a_second_box_on_one_object_is_false():
    # precision 1 up to recall 1 before the second comes
    score = detector_score([found((0, 0.9, 0), (0, 0.8, 0))], [known([0])], 1, 0.5)
    assert score.mean == 1.0
    np.testing.assert_array_equal(score.table, [[1, 0], [1, 0]])


def test_of_what_does_not_count_nothing_matters():
    score = detector_score([found((0, 0.9, 0), (1, 0.95, 0))], [known([0, 0], [True, False])], 1, 0.5)
    assert score.mean == 1.0
    score = detector_score([found((0, 0.9, 0))], [known([0, 0], [True, False])], 1, 0.5)
    assert score.mean == 1.0
    np.testing.assert_array_equal(score.table, [[1, 0], [0, 0]])


def test_another_class_is_in_the_table():
    score = detector_score([found((0, 0.9, 1))], [known([0])], 2, 0.5)
    assert score.precision[0] == 0.0 and np.isnan(score.precision[1])
    np.testing.assert_array_equal(score.table, [[0, 1, 0], [0, 0, 0], [0, 0, 0]])
    recall, _ = recall_and_precision(score.table)
    assert recall[0] == 0.0


def test_scores_rank_over_all_pictures():
    pictures = [found((np.array([100.0, 0, 110, 10]), 0.95, 0)), found((0, 0.9, 0)), NO_DETECTIONS]
    score = detector_score(pictures, [known([]), known([0]), known([0])], 1, 0.5)
    assert score.mean == pytest.approx(0.5 * 0.5)


def test_an_overlap_below_one_half_is_none():
    shifted = BOXES[:1] + [4.0, 0.0, 4.0, 0.0]  # 6 of 14 columns are common
    assert overlaps(shifted, BOXES)[0] == pytest.approx([6.0 / 14.0, 0.0, 0.0])
    score = detector_score([found((shifted[0], 0.9, 0))], [known([0])], 1, 0.5)
    assert score.mean == 0.0
