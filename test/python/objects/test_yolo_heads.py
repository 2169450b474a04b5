# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Heads of exported networks, and the networks that end at them."""

import cv2
import numpy as np
import onnx
import pytest
from made_yolo import ConvolvedDetector, ExportedHeads, constant_network

from sextant.objects.yolo_heads import cut_at_heads, find_heads

NAMES = ["ball", "goal"]
BOXES, SCORES = np.arange(8.0), [1.5, -2.0]  # two bins


@pytest.mark.parametrize("prefix", ["", "one2one_"])
def test_heads_are_found_by_their_names(tmp_path, prefix):
    model = onnx.load(ExportedHeads(NAMES, BOXES, SCORES, prefix=prefix).write(tmp_path / "net.onnx"))
    heads = find_heads(model)
    assert heads.boxes == [f"model.22.{prefix}cv2.{grid}.2" for grid in range(3)]
    assert heads.scores == [f"model.22.{prefix}cv3.{grid}.2" for grid in range(3)]
    assert (heads.angles, heads.bins, heads.classes) == ([], 2, 2)


def test_the_cut_network_has_all_predictions_in_one_output(tmp_path):
    made = ExportedHeads(NAMES, BOXES, SCORES, angle=0.25)
    model = onnx.load(made.write(tmp_path / "net.onnx", taken=("n", 3, "h", "w")))
    cut = cut_at_heads(model, find_heads(model, "obb"), (64, 96))
    onnx.checker.check_model(cut)
    net = cv2.dnn.readNetFromONNX(np.frombuffer(cut.SerializeToString(), np.uint8))
    net.setInput(np.zeros((1, 3, 96, 64), np.float32))
    expected = np.broadcast_to(np.array([*BOXES, *SCORES, 0.25])[:, np.newaxis], (11, 96 + 24 + 6))
    np.testing.assert_allclose(net.forward()[0], expected, atol=1e-6)


def test_other_networks_have_no_heads(tmp_path):
    others = [
        constant_network(tmp_path / "constant.onnx", [np.zeros((1, 6, 84))]),
        ConvolvedDetector(NAMES).write_full(tmp_path / "full.onnx"),
        ExportedHeads(NAMES, BOXES[:6], SCORES).write(tmp_path / "six.onnx"),
    ]
    assert [find_heads(onnx.load(each)) for each in others] == [None] * 3
    wide = ExportedHeads(NAMES, BOXES, SCORES, angle=0.25, channels=16)
    assert find_heads(onnx.load(wide.write(tmp_path / "nano.onnx")), "obb").angles[0] == "model.22.cv4.0.2"
    four = ExportedHeads(NAMES, BOXES, SCORES, strides=(8, 16, 32, 64))
    assert find_heads(onnx.load(four.write(tmp_path / "four.onnx", taken=(1, 3, 64, 64)))) is None
    without_angles = onnx.load(ExportedHeads(NAMES, BOXES, SCORES).write(tmp_path / "upright.onnx"))
    assert find_heads(without_angles, "obb") is None
