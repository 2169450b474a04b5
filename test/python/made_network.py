# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""ONNX networks that the tests make, of which it is known what they answer."""

from typing import Sequence

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

CELLS = 8  # a side, of pooling_network()


def written(
    path, nodes, taken=("n", 3, "h", "w"), made=("n", "d"), weights=(), more_inputs=(), elements=None
):
    """A network from `image` to `vector`; the other tensors are named by the nodes."""
    elements = elements or TensorProto.FLOAT
    inputs = [
        helper.make_tensor_value_info(name, elements, shape)
        for name, shape in (("image", taken), *more_inputs)
    ]
    output = helper.make_tensor_value_info("vector", elements, made)
    initializers = [numpy_helper.from_array(value, name) for name, value in weights]
    graph = helper.make_graph(nodes, "made", inputs, [output], initializers)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 13)])
    model.ir_version = 7
    onnx.save(model, str(path))
    return str(path)


def pooling_network(path, size: Sequence[int] = (96, 64), channels: int = 3) -> str:
    """Means of 8×8 cells of a picture of that width and height, channel by channel, row by row."""
    width, height = size
    cell = (height // CELLS, width // CELLS)
    return written(
        path,
        [
            helper.make_node("AveragePool", ["image"], ["cells"], kernel_shape=cell, strides=cell),
            helper.make_node("Flatten", ["cells"], ["vector"]),
        ],
        (1, channels, height, width),
        (1, channels * CELLS * CELLS),
    )


def projection_network(path, matrix) -> str:
    """The matrix, float32 (d, 3), times the means of the channels, of a picture of any size."""
    return written(
        path,
        [
            helper.make_node("Conv", ["image", "matrix"], ["projected"], kernel_shape=[1, 1]),
            helper.make_node("GlobalAveragePool", ["projected"], ["means"]),
            helper.make_node("Flatten", ["means"], ["vector"]),
        ],
        weights=[("matrix", matrix[:, :, None, None])],
    )


def root_network(path) -> str:
    """Roots of the channels' means, which are no numbers of what is darker than `mean`."""
    return written(
        path,
        [
            helper.make_node("GlobalAveragePool", ["image"], ["means"]),
            helper.make_node("Pow", ["means", "half"], ["roots"]),
            helper.make_node("Flatten", ["roots"], ["vector"]),
        ],
        (1, 3, 8, 8),
        weights=[("half", np.array(0.5, np.float32))],
    )
