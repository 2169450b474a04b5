# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Boxes of a network's numbers, which are set here so that the boxes are known."""

import numpy as np
import pytest

from sextant.objects.yolo_output import cell_middles, decoded, joined, prediction_count

SIZE = (64, 96)  # 8 × 12, 4 × 6 and 2 × 3 cells
PLACES = 96 + 24 + 6
SURE = 40.0  # a weight beside which others do not count
# cells of a grid of 16 pixels: column 1, row 2 of it; 0.5 cells of both to the left and so on
PLACE, MIDDLE = 96 + 2 * 4 + 1, (24.0, 40.0)
SIDES = ((1, 2), (0, 0), (3, 3), (2, 5))  # bins of the same weight
BOX = [MIDDLE[0] - 1.5 * 16, MIDDLE[1], MIDDLE[0] + 3 * 16, MIDDLE[1] + 3.5 * 16]


def cut(classes, which=0, raw=2.0):
    """Boxes (64, places) and scores (classes, places), with one object."""
    boxes, scores = np.zeros((4, 16, PLACES), np.float32), np.full((classes, PLACES), -9.0, np.float32)
    for side, bins in enumerate(SIDES):
        boxes[side, list(bins), PLACE] = SURE
    scores[which, PLACE] = raw
    return boxes.reshape(64, PLACES), scores


def grids(whole):
    """The three grids of (channels, places), each as the network's layers have it."""
    parts = np.split(whole, [96, 96 + 24], axis=1)
    return [
        part.reshape(1, len(whole), 96 // stride, 64 // stride) for part, stride in zip(parts, (8, 16, 32))
    ]


def whole(*parts):
    return [np.concatenate(parts)[np.newaxis]]


def mixed(boxes, scores):
    """Six outputs in no order but that of a grid's two."""
    of_boxes, of_scores = grids(boxes), grids(scores)
    return [of_boxes[2], of_scores[2], of_boxes[0], of_scores[0], of_boxes[1], of_scores[1]]


LAYOUTS = {
    "one": whole,
    "apart": lambda *parts: [part[np.newaxis] for part in parts],
    "three": lambda *parts: grids(np.concatenate(parts)),
    "six": lambda *parts: [each for part in parts for each in grids(part)],
    "mixed": mixed,
}


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("classes", [1, 3, 4, 60, 64, 80, 200])
def test_a_cut_network_in_every_layout(layout, classes):
    which = classes // 2
    found = decoded(LAYOUTS[layout](*cut(classes, which)), SIZE, classes, 0.4)
    assert found.boxes == pytest.approx(np.array([BOX]), abs=1e-6)
    assert found.scores == pytest.approx([0.880797], abs=1e-6)  # the logistic function of 2
    assert found.classes.tolist() == [which]


@pytest.mark.parametrize("layout", ["apart", "six", "mixed"])
@pytest.mark.parametrize("classes", [1, 3, 80, 200])
def test_scores_may_come_before_boxes(layout, classes):
    outputs = LAYOUTS[layout](*cut(classes))[::-1]
    assert decoded(outputs, SIZE, classes, 0.4).boxes == pytest.approx(np.array([BOX]), abs=1e-6)


@pytest.mark.parametrize("layout", ["one", "apart"])
@pytest.mark.parametrize("classes", [1, 4, 60, 64, 80])
def test_a_full_export(layout, classes):
    boxes, scores = np.zeros((4, PLACES)), np.zeros((classes, PLACES))
    boxes[:, 7], scores[classes - 1, 7] = [30.0, 40.0, 20.0, 10.0], 0.6
    boxes[:, 9], scores[0, 9] = [10.0, 10.0, 2.0, 4.0], 0.7
    boxes[:, 10], scores[0, 10] = [11.0, 10.0, 2.0, 4.0], 0.39
    found = decoded(LAYOUTS[layout](boxes, scores), SIZE, classes, 0.4)
    assert found.boxes.tolist() == [[9.0, 8.0, 11.0, 12.0], [20.0, 35.0, 40.0, 45.0]]
    assert found.scores.tolist() == [0.7, 0.6]
    assert found.classes.tolist() == [0, classes - 1]


@pytest.mark.parametrize("threshold, count", [(0.01, 1), (0.7310, 1), (0.7311, 0), (0.99, 0)])
def test_the_threshold_is_of_the_score_behind_the_sigmoid(threshold, count):
    found = decoded(whole(*cut(3, raw=1.0)), SIZE, 3, threshold)  # 0.731059
    assert len(found.boxes) == len(found.scores) == len(found.classes) == count


def test_outputs_of_other_shapes_beside_do_not_matter():
    beside = [np.zeros((1, 300, 6), np.float32), np.zeros((1, 32, 24, 16), np.float32)]
    assert len(decoded([*beside, *whole(*cut(3))], SIZE, 3, 0.4).boxes) == 1


def test_places_are_counted_and_stand_row_by_row():
    assert prediction_count(SIZE) == PLACES and prediction_count((640, 640)) == 8400
    middles, strides = cell_middles(SIZE)
    assert middles[[0, 1, 8, 96, -1]].tolist() == [[4, 4], [12, 4], [4, 12], [8, 8], [48, 80]]
    assert strides[[0, 95, 96, 119, 120]].tolist() == [8, 8, 16, 16, 32]


@pytest.mark.parametrize(
    "shapes",
    [
        [(1, 68, PLACES)],  # four classes
        [(1, 67, PLACES - 1)],
        [(1, PLACES, 67)],
        [(2, 67, PLACES)],
        [(67, PLACES)],
        [(1, 300, 6)],  # with suppression in the graph
        [(1, 67, 12, 8), (1, 67, 6, 4)],
        [(1, 64, PLACES)],
        [(1, 64, PLACES), (1, 4, PLACES)],
        [(1, 64, PLACES), (1, 3, PLACES), (1, 3, PLACES)],
        [()],
        [(0, 67, PLACES)],
    ],
)
def test_what_is_no_such_network_is_named_with_what_is_needed(shapes):
    with pytest.raises(ValueError) as error:
        joined([np.zeros(shape, np.float32) for shape in shapes], SIZE, 3)
    text = ", ".join("×".join(map(str, shape)) for shape in shapes)
    assert str(error.value).startswith(
        f"outputs {text or 'a number'}; 3 classes and 64×96 pixels need 1×7×126 (a full"
    )
    assert "1×67×126 in one or more outputs" in str(error.value)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("row", [0, 63, 64, 66])
def test_what_is_no_number_is_refused(value, row):
    outputs = whole(*cut(3))
    outputs[0][0, row, PLACE] = value
    with pytest.raises(ValueError, match="outputs are not finite"):
        decoded(outputs, SIZE, 3, 0.4)


def test_a_full_export_without_its_sigmoid_is_refused():
    outputs = np.zeros((1, 7, PLACES))
    outputs[0, 5, 3] = -2.5
    with pytest.raises(
        ValueError, match=r"outputs scores of -2.5 to 0; a full export has scores in \[0, 1\]"
    ):
        decoded([outputs], SIZE, 3, 0.4)


def test_rows_of_an_end_to_end_export():
    rows = np.zeros((1, 300, 6), np.float32)
    rows[0, :3] = [[1, 2, 3, 4, 0.3, 1], [5, 6, 9, 8, 0.9, 0], [1, 2, 3, 4, 0.7, 2]]
    found = decoded([rows], SIZE, 3, 0.4)
    assert found.boxes.tolist() == [[5, 6, 9, 8], [1, 2, 3, 4]]
    assert found.classes.tolist() == [0, 2] and found.scores == pytest.approx([0.9, 0.7])
    with pytest.raises(ValueError, match="outputs class 2, there are 2 classes"):
        decoded([rows], SIZE, 2, 0.4)
    with pytest.raises(ValueError, match="right is left of left"):  # of YOLOv5: x, y, width, height
        decoded([np.array([[[40.0, 30, 10, 8, 0.9, 0]]])], SIZE, 2, 0.4)
