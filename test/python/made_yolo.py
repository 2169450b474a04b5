# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""ONNX detectors in the layouts of YOLO that the tests make; all take `images`."""

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

BINS = 16
STRIDES = (8, 16, 32)


def saved(path, nodes, weights, outputs, taken, names=None):
    """:param outputs: (name, shape) each. :param names: of the classes, as their makers write them"""
    model = helper.make_model(
        helper.make_graph(
            nodes,
            "made",
            [helper.make_tensor_value_info("images", TensorProto.FLOAT, taken)],
            [helper.make_tensor_value_info(name, TensorProto.FLOAT, shape) for name, shape in outputs],
            [numpy_helper.from_array(value, name) for name, value in weights.items()],
        ),
        opset_imports=[helper.make_opsetid("", 12)],
    )
    model.ir_version = 7
    if names is not None:
        helper.set_model_props(
            model, {"names": names if isinstance(names, str) else str(dict(enumerate(names)))}
        )
    onnx.save(model, str(path))
    return str(path)


def constant_network(path, answers, taken=(1, 3, 64, 64), names=None):
    """Returns these arrays for every image."""
    nodes = [helper.make_node("GlobalAveragePool", ["images"], ["mean"])]
    weights, outputs = {}, []
    for number, answer in enumerate(answers):
        flat, shape, name = f"flat{number}", f"shape{number}", f"output{number}"
        weights[f"none{number}"] = np.zeros((answer.size, taken[1], 1, 1), np.float32)
        weights[f"answer{number}"] = answer.astype(np.float32).ravel()
        weights[shape] = np.array(answer.shape, np.int64)
        nodes.append(
            helper.make_node(
                "Conv", ["mean", f"none{number}", f"answer{number}"], [flat], kernel_shape=[1, 1]
            )
        )
        nodes.append(helper.make_node("Reshape", [flat, shape], [name]))
        outputs.append((name, answer.shape))
    return saved(path, nodes, weights, outputs, taken, names)


class ConvolvedDetector:
    """A few convolutions with drawn weights, which detect something in any image."""

    def __init__(self, classes, size=96, seed=1):
        self.classes, self.size = list(classes), size
        random = np.random.default_rng(seed)
        self._weights = {
            "first": random.normal(0.0, 0.35, (12, 3, 8, 8)).astype(np.float32),
            "head": random.normal(0.0, 0.7, (4 * BINS + len(self.classes), 12, 1, 1)).astype(np.float32),
        }

    @property
    def _cells(self):
        return [(self.size // stride) ** 2 for stride in STRIDES]

    def _heads(self):
        """Nodes; the grids are grid0, grid1, grid2."""
        nodes = [
            helper.make_node("Conv", ["images", "first"], ["raw"], kernel_shape=[8, 8], strides=[8, 8]),
            helper.make_node("Relu", ["raw"], ["cells0"]),
        ]
        for number in range(3):
            nodes.append(
                helper.make_node("Conv", [f"cells{number}", "head"], [f"grid{number}"], kernel_shape=[1, 1])
            )
            names = [f"cells{number}"], [f"cells{number + 1}"]
            nodes.append(helper.make_node("AveragePool", *names, kernel_shape=[2, 2], strides=[2, 2]))
        return nodes[:-1]

    def write_grids(self, path):
        """Cut, each grid by itself."""
        channels = 4 * BINS + len(self.classes)
        sides = [self.size // stride for stride in STRIDES]
        outputs = [(f"grid{number}", (1, channels, side, side)) for number, side in enumerate(sides)]
        return self._saved(path, self._heads(), outputs, {})

    def write_cut(self, path):
        """Cut, all places in one output."""
        outputs = [("places", (1, 4 * BINS + len(self.classes), sum(self._cells)))]
        return self._saved(path, self._joined(), outputs, self._shapes())

    def write_full(self, path):
        """With the boxes decoded, by nodes of the graph."""
        places = sum(self._cells)
        middles = [
            (x + 0.5, y + 0.5)
            for stride in STRIDES
            for y in range(self.size // stride)
            for x in range(self.size // stride)
        ]
        strides = np.repeat(STRIDES, self._cells).astype(np.float32)
        weights = {
            **self._shapes(),
            "four": np.array([1, 4, BINS, places], np.int64),
            "flat": np.array([1, 4, places], np.int64),
            "numbers": np.arange(BINS, dtype=np.float32).reshape(1, 1, 1, BINS),
            "middles": np.array(middles, np.float32).T[np.newaxis],
            "strides": strides.reshape(1, 1, -1),
            "half": np.array(0.5, np.float32),
        }
        nodes = [*self._joined(), *self._decoding()]
        return self._saved(path, nodes, [("output", (1, 4 + len(self.classes), places))], weights)

    def _decoding(self):
        """From all places to a full export's output."""
        return [
            helper.make_node(
                "Split", ["places"], ["box", "raw scores"], axis=1, split=[64, len(self.classes)]
            ),
            helper.make_node("Reshape", ["box", "four"], ["sides by bin"]),
            helper.make_node("Transpose", ["sides by bin"], ["bins last"], perm=[0, 1, 3, 2]),
            helper.make_node("Softmax", ["bins last"], ["shares"], axis=3),
            helper.make_node("Transpose", ["shares"], ["bins third"], perm=[0, 1, 3, 2]),
            helper.make_node("MatMul", ["numbers", "bins third"], ["reach"]),
            helper.make_node("Reshape", ["reach", "flat"], ["sides"]),
            helper.make_node("Split", ["sides"], ["before", "behind"], axis=1, split=[2, 2]),
            helper.make_node("Sub", ["middles", "before"], ["low"]),
            helper.make_node("Add", ["middles", "behind"], ["high"]),
            helper.make_node("Add", ["low", "high"], ["sum"]),
            helper.make_node("Mul", ["sum", "half"], ["centre"]),
            helper.make_node("Sub", ["high", "low"], ["extent"]),
            helper.make_node("Concat", ["centre", "extent"], ["in cells"], axis=1),
            helper.make_node("Mul", ["in cells", "strides"], ["pixels"]),
            helper.make_node("Sigmoid", ["raw scores"], ["scores"]),
            helper.make_node("Concat", ["pixels", "scores"], ["output"], axis=1),
        ]

    def _shapes(self):
        return {"row": np.array([1, 4 * BINS + len(self.classes), -1], np.int64)}

    def _joined(self):
        rows = [helper.make_node("Reshape", [f"grid{k}", "row"], [f"row{k}"]) for k in range(3)]
        return [
            *self._heads(),
            *rows,
            helper.make_node("Concat", ["row0", "row1", "row2"], ["places"], axis=2),
        ]

    def _saved(self, path, nodes, outputs, weights):
        taken = (1, 3, self.size, self.size)
        return saved(path, nodes, {**self._weights, **weights}, outputs, taken, self.classes)


class ExportedHeads:
    """Heads that predict the same in every cell, named as in exports, before operators that OpenCV lacks."""

    def __init__(self, classes, boxes, scores, angle=None, prefix="", channels=3, strides=STRIDES):
        """:param boxes: (4 * bins,) and scores (classes,) before the sigmoid

        :param prefix: of the heads' names. :param channels: before the last layers
        """
        self.classes, self._prefix, self._channels, self._strides = list(classes), prefix, channels, strides
        parts = {"2": boxes, "3": scores, **({} if angle is None else {"4": [angle]})}
        self._biases = {kind: np.array(values, np.float32) for kind, values in parts.items()}

    def write(self, path, taken=(1, 3, 64, 64), half=False, **metadata):
        """:param taken: shape of the input. :param half: whether all is in half precision"""
        number = np.float16 if half else np.float32
        nodes, weights, ends = [], {}, []
        weights["stem"] = np.zeros((self._channels, 3, 1, 1), number)
        nodes.append(helper.make_node("Conv", ["images", "stem"], ["features"], kernel_shape=[1, 1]))
        for grid, stride in enumerate(self._strides):
            pooled = f"pooled{grid}"
            nodes.append(
                helper.make_node(
                    "AveragePool", ["features"], [pooled], kernel_shape=[stride] * 2, strides=[stride] * 2
                )
            )
            for kind, biases in self._biases.items():
                name = f"model.22.{self._prefix}cv{kind}.{grid}.2"
                weights[f"{name}.weight"] = np.zeros((len(biases), self._channels, 1, 1), number)
                weights[f"{name}.bias"] = biases.astype(number)
                inputs = [pooled, f"{name}.weight", f"{name}.bias"]
                nodes.append(helper.make_node("Conv", inputs, [name], kernel_shape=[1, 1]))
                ends.append(f"{name}/flat")
                nodes.append(helper.make_node("Flatten", [name], [ends[-1]]))
        weights["most"] = np.array([300], np.int64)
        nodes.append(helper.make_node("Concat", ends, ["all"], axis=1))
        nodes.append(helper.make_node("TopK", ["all", "most"], ["output0", "which"]))
        return self._saved(path, nodes, weights, taken, half, metadata)

    def _saved(self, path, nodes, weights, taken, half, metadata):
        kind = TensorProto.FLOAT16 if half else TensorProto.FLOAT
        graph = helper.make_graph(
            nodes, "made", [helper.make_tensor_value_info("images", kind, taken)],
            [helper.make_tensor_value_info("output0", kind, None)],
            [numpy_helper.from_array(value, name) for name, value in weights.items()],
        )  # fmt: skip
        model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 18)])
        names = str(dict(enumerate(self.classes)))
        helper.set_model_props(
            model, {"names": names, **{key: str(value) for key, value in metadata.items()}}
        )
        onnx.save(model, str(path))
        return str(path)
