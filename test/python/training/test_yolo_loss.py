# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Losses of the detector's training against closed forms and the decoder that runs without PyTorch."""

import math

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="PyTorch is optional: apt install python3-torch")

from sextant.objects.yolo_output import BINS, cell_middles, decoded, prediction_count  # noqa: E402
from sextant.training.yolo_loss import Targets, YoloLoss, ciou, overlap  # noqa: E402

SIZE, CLASSES = 64, 2
PLACES = prediction_count((SIZE, SIZE))
BOX = [13.0, 9.0, 35.0, 41.0]


def targets(is_counted=True):
    boxes = torch.tensor([[BOX, [0.0, 0.0, 0.0, 0.0]]])
    flags = torch.tensor([[True, False]])
    return Targets(boxes, torch.tensor([[1, 0]]), flags, flags & is_counted)


def prediction(box, right=8.0, elsewhere=-8.0):
    """Outputs of a network that predicts this box in all candidate cells, there with class 1."""
    middles, strides = cell_middles((SIZE, SIZE))
    output = np.full((1, 4 * BINS + CLASSES, PLACES), 0.0, np.float32)
    output[:, 4 * BINS :] = elsewhere
    reach = np.hstack([middles - box[:2], box[2:] - middles]) / strides[:, np.newaxis]
    for place, far in enumerate(reach):
        if np.all((far >= 0.0) & (far < BINS - 1)):
            for side, cells in enumerate(far):
                low, share = int(cells), cells - int(cells)
                weights = np.full(BINS, 1e-6)
                weights[low], weights[low + 1] = 1.0 - share + 1e-6, share + 1e-6
                output[0, side * BINS : (side + 1) * BINS, place] = np.log(weights)
            output[0, 4 * BINS + 1, place] = right
    return output


def loss(output, **what):
    return float(YoloLoss(SIZE, CLASSES)(torch.tensor(output), targets(**what)))


def test_right_detections_cost_less_than_wrong_ones():
    right, nothing = loss(prediction(np.array(BOX))), loss(np.full_like(prediction(np.array(BOX)), 0.0))
    aside, wrong = (
        loss(prediction(np.array(BOX) + 3.0)),
        loss(prediction(np.array(BOX))[:, [*range(4 * BINS), 65, 64]]),
    )
    assert right < 0.5 * aside and right < 0.3 * nothing and right < 0.3 * wrong


def test_what_does_not_count_costs_nothing_whether_it_is_detected_or_not():
    silent = prediction(np.array(BOX), right=-8.0)
    assert loss(prediction(np.array(BOX)), is_counted=False) == pytest.approx(
        loss(silent, is_counted=False), abs=0.05
    )
    assert loss(silent) > 1.0


def test_boxes_are_those_of_the_decoder_without_pytorch():
    output = np.random.default_rng(1).normal(0.0, 2.0, (1, 4 * BINS + CLASSES, PLACES)).astype(np.float32)
    raw = torch.tensor(output).permute(0, 2, 1)[..., : 4 * BINS].unflatten(-1, (4, BINS))
    boxes = YoloLoss(SIZE, CLASSES)._boxes(raw)[0].numpy()
    expected = decoded([output], (SIZE, SIZE), CLASSES, 1e-6)
    scores = 1.0 / (1.0 + np.exp(-output[0, 4 * BINS :].max(axis=0)))
    order = np.argsort(-scores, kind="stable")
    np.testing.assert_allclose(boxes[order], expected.boxes, atol=1e-3)


def test_overlap_and_its_complete_form():
    box = torch.tensor([[0.0, 0.0, 10.0, 10.0]])
    assert float(overlap(box, box)) == pytest.approx(1.0) and float(ciou(box, box)) == pytest.approx(
        1.0, abs=1e-4
    )
    beside = torch.tensor([[10.0, 0.0, 20.0, 10.0]])
    # No overlap, the same shape: minus the squared distance over the squared diagonal of the box about both.
    assert float(ciou(box, beside)) == pytest.approx(-100.0 / (20.0**2 + 10.0**2), abs=1e-4)
    half = torch.tensor([[0.0, 0.0, 10.0, 5.0]])
    shape = (2.0 / math.pi * (math.atan(1.0) - math.atan(2.0))) ** 2
    weight = shape / (0.5 + shape)
    assert float(ciou(box, half)) == pytest.approx(0.5 - 2.5**2 / 200.0 - weight * shape, abs=1e-4)
