# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The heads of the YOLO networks that Ultralytics' software exports, and the network that ends at them.

YOLOv5u, v8, v9, v10, 11, 12 and 26 differ in what follows the last convolutions (distributions or distances,
the decoding of boxes, selection or suppression), but their heads have the same names: `cv2` of the boxes,
`cv3` of the scores and, of oriented boxes, `cv4` of the angles, one of each for every grid.
"""

import ast
import re
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from sextant.base.onnx_trim import trimmed
from sextant.objects.yolo_output import STRIDES, prediction_count

# cv2.0.2.weight: last layer (2) of the box head of the finest grid (0); one2one_cv2: of an end-to-end head
_HEAD = re.compile(r"(?:^|[./])(?:one2one_)?cv([234])[./](\d+)[./].*weight")
BOXES, SCORES, ANGLES = "2", "3", "4"
DISTRIBUTION = (1, 16, 1, 1)  # weights of the convolution that computes the means of distributions


class HeadOutputs(NamedTuple):
    """Tensors of the last convolutions, the finest grid first."""

    boxes: List[str]  # 4 * bins channels
    scores: List[str]  # a channel per class
    angles: List[str]  # one channel; empty: boxes are not oriented
    bins: int  # of the distance distributions; 1: distances
    classes: int  # number of classes
    is_one_to_one: bool = False  # whether an object has one prediction


def find_heads(model: Any, task: str = "") -> Optional[HeadOutputs]:
    """The heads on which the outputs of an onnx.ModelProto depend; None: it is of another kind.

    :param task: of the metadata; `obb`: the boxes are oriented
    """
    sizes = {each.name: tuple(each.dims) for each in model.graph.initializer}
    found = _last_convolutions(model.graph, sizes)
    boxes, scores = _of_kind(found, BOXES), _of_kind(found, SCORES)
    angles = _of_kind(found, ANGLES) if task == "obb" else _Head([], 1)
    if not (boxes and scores and angles) or boxes.channels % 4 or angles.channels != 1:
        return None
    is_one_to_one = _is_one_to_one(model.graph, boxes.names)
    return HeadOutputs(
        boxes.names, scores.names, angles.names, boxes.channels // 4, scores.channels, is_one_to_one
    )


def _is_one_to_one(graph: Any, boxes: Sequence[str]) -> bool:
    """Whether the weights of these convolutions are those of an end-to-end head."""
    weights_of = {node.output[0]: node.input[1] for node in graph.node if node.op_type == "Conv"}
    return any("one2one" in weights_of[name] for name in boxes)


class _Head(NamedTuple):
    names: List[str]  # of its last convolutions, the finest grid first
    channels: int  # of each


def _of_kind(found: Dict[Tuple[str, int], Tuple[str, int]], kind: str) -> Optional[_Head]:
    """The head of a kind; None: a grid is missing or too many, or has another number of channels."""
    if {grid for each, grid in found if each == kind} != set(range(len(STRIDES))):
        return None
    grids = [found.get((kind, grid), ("", 0)) for grid in range(len(STRIDES))]
    channels = {each for _, each in grids}
    if len(channels) > 1 or 0 in channels:
        return None
    return _Head([name for name, _ in grids], grids[0][1])


def _last_convolutions(graph: Any, sizes: Dict[str, tuple]) -> Dict[Tuple[str, int], Tuple[str, int]]:
    """Output and channels of the last convolutions before the outputs, by kind of head and grid."""
    made = {output: node for node in graph.node for output in node.output}
    todo, seen, found = [each.name for each in graph.output], set(), {}
    while todo:
        tensor = todo.pop()
        if tensor in seen or tensor not in made:
            continue
        seen.add(tensor)
        weight = _weight_of(made[tensor], made)
        name = _HEAD.search(weight)
        if name and weight in sizes:
            found[name.group(1), int(name.group(2))] = tensor, sizes[weight][0]
        elif sizes.get(weight, DISTRIBUTION) == DISTRIBUTION:
            todo += made[tensor].input
    return found


def _weight_of(node: Any, made: Dict[str, Any]) -> str:
    """The weights of a convolution; empty: it is none."""
    return _source(node.input[1], made) if node.op_type == "Conv" else ""


def _source(tensor: str, made: Dict[str, Any]) -> str:
    """The tensor that a tensor is a copy of."""
    while tensor in made and made[tensor].op_type == "Identity":
        tensor = made[tensor].input[0]
    return tensor


def cut_at_heads(model: Any, heads: HeadOutputs, size: Tuple[int, int]) -> Any:
    """An onnx.ModelProto with one output (1, 4 * bins + classes (+ 1), predictions), the finest grid first.

    :param size: width and height of the input, pixels, multiples of the largest stride
    :raises ValueError: see trimmed()
    """
    from onnx import TensorProto, helper, numpy_helper

    tensors = [*heads.boxes, *heads.scores, *heads.angles]
    cut = trimmed(model, tensors, (1, 3, size[1], size[0]))
    names = [each.name for each in cut.graph.output]
    rows = []
    for grid, stride in enumerate(STRIDES):
        parts = names[grid :: len(STRIDES)]
        channels = 4 * heads.bins + heads.classes + bool(heads.angles)
        shape = np.array([1, channels, (size[0] // stride) * (size[1] // stride)], np.int64)
        cut.graph.initializer.append(numpy_helper.from_array(shape, f"shape of grid {grid}"))
        grid_name, row = f"grid {grid}", f"row {grid}"
        rows.append(row)
        cut.graph.node.extend([
            helper.make_node("Concat", parts, [grid_name], axis=1),
            helper.make_node("Reshape", [grid_name, f"shape of grid {grid}"], [row]),
        ])  # fmt: skip
    cut.graph.node.append(helper.make_node("Concat", rows, ["predictions"], axis=2))
    shape = [1, 4 * heads.bins + heads.classes + bool(heads.angles), prediction_count(size)]
    del cut.graph.output[:]
    cut.graph.output.append(helper.make_tensor_value_info("predictions", TensorProto.FLOAT, shape))
    return cut


def metadata_value(metadata: Dict[str, str], name: str) -> Any:
    """A literal of the exporter's metadata; None: it is missing or no literal."""
    try:
        return ast.literal_eval(metadata.get(name, "None"))
    except (ValueError, SyntaxError):
        return None
