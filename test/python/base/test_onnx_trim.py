# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Networks with constructs that old versions of OpenCV do not know, and what they compute."""

import cv2
import numpy as np
import onnx
import pytest
from onnx import TensorProto, helper, numpy_helper

from sextant.base.onnx_trim import trimmed

RANDOM = np.random.default_rng(7)
IMAGE = RANDOM.uniform(-1, 1, (1, 3, 8, 12)).astype(np.float32)


def node(kind, inputs, outputs, **settings):
    return helper.make_node(kind, inputs.split(), outputs.split(), **settings)


def model(nodes, outputs="y", weights=None, opset=18, shape=("batch", 3, "height", "width")):
    """A network of `images`; its size is left open."""
    graph = helper.make_graph(
        nodes, "made", [helper.make_tensor_value_info("images", TensorProto.FLOAT, shape)],
        [helper.make_tensor_value_info(name, TensorProto.FLOAT, None) for name in outputs.split()],
        [numpy_helper.from_array(np.asarray(value), name) for name, value in (weights or {}).items()],
    )  # fmt: skip
    made = helper.make_model(graph, opset_imports=[helper.make_opsetid("", opset)])
    helper.set_model_props(made, {"names": "{0: 'ball'}"})
    return made


def run(made, wanted="y"):
    """The output of the trimmed network in OpenCV."""
    result = trimmed(made, [wanted], IMAGE.shape)
    onnx.checker.check_model(result)
    assert result.metadata_props[0].value == "{0: 'ball'}"
    (output,) = result.graph.output
    net = cv2.dnn.readNetFromONNX(np.frombuffer(result.SerializeToString(), np.uint8))
    net.setInput(IMAGE)
    found = net.forward()
    assert found.shape == tuple(side.dim_value for side in output.type.tensor_type.shape.dim)
    return found


def test_shape_arithmetic_becomes_constant():
    """As x.view(n, c, -1) and x.chunk(2, 1) are exported."""
    made = model(
        [
            node("Shape", "images", "shape"),
            node("Constant", "", "one", value=numpy_helper.from_array(np.array(1))),
            node("Gather", "shape one", "channels", axis=0),
            node("Constant", "", "axes", value=numpy_helper.from_array(np.array([0]))),
            node("Unsqueeze", "channels axes", "list"),
            node("Constant", "", "rest", value=numpy_helper.from_array(np.array([-1]))),
            node("Constant", "", "first", value=numpy_helper.from_array(np.array([1]))),
            node("Concat", "first list rest", "target", axis=0),
            node("Reshape", "images target", "flat"),
            node("Div", "channels two", "half"),
            node("Unsqueeze", "half axes", "end"),
            node("Slice", "flat start end middle", "y"),
        ],
        weights={"two": np.array(2), "start": np.array([0]), "middle": np.array([1])},
    )
    np.testing.assert_array_equal(run(made), IMAGE.reshape(1, 3, -1)[:, :1])


def test_shared_weights_in_half_precision():
    weights = RANDOM.uniform(-1, 1, (4, 3, 1, 1)).astype(np.float16)
    made = model(
        [
            node("Cast", "images", "half", to=TensorProto.FLOAT16),
            node("Identity", "kernel", "same"),
            node("Conv", "half same", "raw", kernel_shape=[1, 1]),
            node("Cast", "raw", "y", to=TensorProto.FLOAT),
        ],
        weights={"kernel": weights},
    )
    expected = np.einsum("oc,bchw->bohw", weights[:, :, 0, 0].astype(np.float32), IMAGE)
    np.testing.assert_allclose(run(made), expected, atol=1e-5)


def test_equal_parts_by_number():
    made = model([node("Split", "images", "a b", axis=3, num_outputs=2), node("Add", "a b", "y")])
    np.testing.assert_allclose(run(made), IMAGE[..., :6] + IMAGE[..., 6:], atol=1e-6)


def test_parts_by_an_input():
    made = model(
        [node("Split", "images sizes", "a b", axis=1), node("Mul", "b b", "y")],
        weights={"sizes": np.array([1, 2])},
    )
    np.testing.assert_allclose(run(made), IMAGE[:, 1:] ** 2, atol=1e-6)


def test_an_enlarged_image():
    made = model(
        [
            helper.make_node(
                "Resize", ["images", "", "scales"], ["y"], mode="nearest", nearest_mode="floor",
                coordinate_transformation_mode="asymmetric",
            )
        ],
        weights={"scales": np.array([1, 1, 2, 2], np.float32)},
    )  # fmt: skip
    np.testing.assert_array_equal(run(made), IMAGE.repeat(2, axis=2).repeat(2, axis=3))


def test_attention():
    """Softmax without an axis, of the last one since set 13, between products of matrices."""
    made = model(
        [
            node("Reshape", "images target", "q"),
            node("Transpose", "q", "k", perm=[0, 2, 1]),
            node("MatMul", "q k", "products"),
            node("Softmax", "products", "shares"),
            node("MatMul", "shares q", "y"),
        ],
        weights={"target": np.array([0, 0, -1])},
    )
    q = IMAGE.reshape(1, 3, -1)
    products = np.exp(q @ q.transpose(0, 2, 1))
    np.testing.assert_allclose(run(made), products / products.sum(axis=2, keepdims=True) @ q, atol=1e-4)


def test_convolutions_and_pools_have_their_sizes():
    kernel = RANDOM.uniform(-1, 1, (5, 3, 3, 3)).astype(np.float32)
    made = model(
        [
            node("Conv", "images kernel", "a", kernel_shape=[3, 3], strides=[2, 2], pads=[1, 1, 1, 1]),
            node("MaxPool", "a", "b", kernel_shape=[5, 5], pads=[2, 2, 2, 2]),
            node("AveragePool", "b", "y", kernel_shape=[2, 2], strides=[2, 2]),
        ],
        weights={"kernel": kernel},
    )
    assert run(made).shape == (1, 5, 2, 3)


def test_nodes_beyond_the_outputs_do_not_matter():
    made = model([node("Sigmoid", "images", "y"), node("NonMaxSuppression", "y y", "z")], "z")
    np.testing.assert_allclose(run(made), 1 / (1 + np.exp(-IMAGE)), atol=1e-6)


def test_constants_whose_value_would_be_wrong_are_refused():
    made = model([node("Relu", "given", "positive"), node("Mul", "images positive", "y")],
                 weights={"given": np.array([-1.0], np.float32)})  # fmt: skip
    with pytest.raises(ValueError, match="its operator Relu of a constant is not supported"):
        trimmed(made, ["y"], IMAGE.shape)


def test_a_part_of_a_shape():
    made = model(
        [
            helper.make_node("Shape", ["images"], ["sides"], start=2, end=4),
            node("Concat", "first sides", "target", axis=0),
            node("Reshape", "images target", "y"),
        ],
        weights={"first": np.array([3, 1])},
    )
    np.testing.assert_array_equal(run(made), IMAGE.reshape(3, 1, 8, 12))


def test_an_operator_that_is_not_supported_is_named():
    made = model([node("TopK", "images k", "values y", axis=1)], weights={"k": np.array([2])})
    with pytest.raises(ValueError, match="its operator TopK is not supported"):
        trimmed(made, ["y"], IMAGE.shape)


@pytest.mark.parametrize(
    "damaged",
    [
        node("Concat", "images images", "y"),
        node("Reshape", "images target", "y"),
        node("Conv", "images", "y"),
        node("Add", "images target", "y"),
        node("Transpose", "images", "y", perm=[0, 9, 1, 2]),
    ],
)
def test_damaged_nodes_are_named(damaged):
    made = model([damaged], weights={"target": np.array([7, 5])})
    with pytest.raises(ValueError, match=f"its {damaged.op_type} .*is damaged"):
        trimmed(made, ["y"], IMAGE.shape)
