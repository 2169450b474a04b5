# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Exported networks of known predictions."""

import numpy as np
import pytest
from made_yolo import ExportedHeads

from sextant.objects.yolo_model import YoloModel

NAMES = ["ball", "goal"]
DISTANCES = [1.0, 0.5, 2.0, 1.5]  # left, top, right, bottom of the middle of each cell, in cells
SCORES = [1.5, -2.0]  # before the sigmoid


def opened(path, size=0):
    return YoloModel(path, "opencv", [], size, 1)


def detections(model, threshold=0.5):
    grey = np.full((1, 3, model.size[1], model.size[0]), 0.5, np.float32)
    return model.decoded(model.run(grey), threshold)


def distributions(distances, bins=16):
    """Logits whose distributions have these means."""
    shares = np.full((4, bins), 1e-9)
    for row, distance in zip(shares, distances):
        low = int(distance)
        row[low], row[low + 1] = 1 - (distance - low), max(distance - low, 1e-9)
    return np.log(shares).ravel()


def expected(size=(64, 64)):
    """Boxes of all cells, row by row, the finest grid first."""
    boxes = []
    for stride in (8, 16, 32):
        y, x = np.mgrid[: size[1] // stride, : size[0] // stride]
        middle = (np.stack([x, y, x, y], axis=-1).reshape(-1, 4) + 0.5) * stride
        boxes.append(middle + stride * np.array([-1.0, -0.5, 2.0, 1.5]))
    return np.concatenate(boxes)


@pytest.mark.parametrize("boxes", [DISTANCES, distributions(DISTANCES)])
@pytest.mark.parametrize("half", [False, True])
def test_boxes_by_distances_and_by_distributions(tmp_path, boxes, half):
    model = opened(ExportedHeads(NAMES, boxes, SCORES).write(tmp_path / "net.onnx", half=half))
    found = detections(model)
    np.testing.assert_allclose(found.boxes, expected(), atol=0.2 if half else 1e-3)
    np.testing.assert_allclose(found.scores, 1 / (1 + np.exp(-1.5)), atol=1e-6)
    assert set(found.classes) == {0} and model.classes == NAMES and model.notes == []


def test_an_end_to_end_network_has_a_prediction_for_each_class(tmp_path):
    made = ExportedHeads(NAMES, DISTANCES, [1.5, 1.0], prefix="one2one_")
    model = opened(made.write(tmp_path / "net.onnx"))
    found = detections(model)
    assert model.is_end_to_end and len(found.boxes) == 2 * 84
    np.testing.assert_array_equal(found.classes, np.repeat([0, 1], 84))


def test_oriented_boxes_are_replaced_by_upright_ones(tmp_path):
    """Turned by 90 degrees about the middle of the cell: what was to the right is below."""
    made = ExportedHeads(NAMES, DISTANCES, SCORES, angle=np.log(3))  # sigmoid 0.75, (0.75 - 0.25) pi
    model = opened(made.write(tmp_path / "net.onnx", task="obb"))
    box = detections(model).boxes[0]
    np.testing.assert_allclose(box, 4 + 8 * np.array([-1.5, -1.0, 0.5, 2.0]), atol=1e-4)
    assert model.notes == ["oriented boxes are replaced by the upright boxes around them"]
    radians = ExportedHeads(NAMES, DISTANCES, SCORES, angle=np.pi / 2)
    model = opened(radians.write(tmp_path / "net.onnx", task="obb", head="OBB26"))
    np.testing.assert_allclose(detections(model).boxes[0], box, atol=1e-4)


def test_an_open_size_is_that_of_the_export_unless_it_is_set(tmp_path):
    made = ExportedHeads(NAMES, DISTANCES, SCORES)
    path = made.write(tmp_path / "net.onnx", taken=("batch", 3, "height", "width"), imgsz=[64, 96])
    assert opened(path).size == (96, 64) and opened(path, 120).size == (128, 128)
    np.testing.assert_allclose(detections(opened(path)).boxes, expected((96, 64)), atol=1e-4)
    path = made.write(tmp_path / "net.onnx", taken=("batch", 3, "height", "width"))
    with pytest.raises(ValueError, match="size must be set: .*net.onnx takes any width"):
        opened(path)


def test_another_number_of_names_is_refused(tmp_path):
    path = ExportedHeads(["a", "b", "c"], DISTANCES, SCORES).write(tmp_path / "net.onnx")
    with pytest.raises(ValueError, match="net.onnx: detects 2 classes, there are 3 class names"):
        opened(path)
