# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Files of networks: what is read from them, and damage at which OpenCV would crash."""

import numpy as np
import onnx
import pytest
from made_yolo import ConvolvedDetector, constant_network

from sextant.base.onnx_model import ImageInput, open_network, read_model


def test_a_file_describes_its_model(tmp_path):
    facts = read_model(
        constant_network(tmp_path / "net.onnx", [np.zeros((1, 4)), np.ones(3)], names=["a", "b"])
    )
    assert facts.input == ImageInput(3, 64, 64)
    assert facts.outputs == ["output0", "output1"]
    assert facts.metadata == {"names": "{0: 'a', 1: 'b'}"}


def test_a_constant_network_returns_its_answers(tmp_path):
    answers = [np.arange(12.0).reshape(1, 3, 4), np.array([[7.0]])]
    run = open_network(constant_network(tmp_path / "net.onnx", answers), "opencv", 1)
    outputs = run(np.random.default_rng(1).random((1, 3, 64, 64)).astype(np.float32))
    assert sorted(each.size for each in outputs) == [1, 12]
    assert max(outputs, key=np.size) == pytest.approx(answers[0])


def shorter(weights):
    weights.raw_data = weights.raw_data[:100]


def none(weights):
    weights.raw_data = b""


def larger(weights):
    weights.dims[0] = 10**9


def of_texts(weights):
    weights.data_type = onnx.TensorProto.STRING


def of_nothing(weights):
    weights.data_type = 77


@pytest.mark.parametrize("damage", [shorter, none, larger, of_texts, of_nothing])
def test_damaged_weights_are_named(tmp_path, damage):
    model = onnx.load(ConvolvedDetector(["ball"]).write_cut(tmp_path / "net.onnx"))
    damage(model.graph.initializer[0])
    onnx.save(model, str(tmp_path / "net.onnx"))
    with pytest.raises(ValueError, match="net.onnx: its weights first cannot be read"):
        read_model(str(tmp_path / "net.onnx"))
