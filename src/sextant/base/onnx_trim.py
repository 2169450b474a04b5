# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reduces an ONNX model to a part of it, in a form that old versions of OpenCV's dnn run, too.

The size of the input is fixed, so that shape arithmetic becomes constant; weights in half precision become
single; nodes of newer operator sets are written as in set 12.
"""

from typing import Any, Callable, Dict, List, Sequence, Tuple

import numpy as np

OPSET, IR_VERSION = 12, 7  # of the result
RESIZE_SETTINGS = ("mode", "coordinate_transformation_mode", "nearest_mode", "cubic_coeff_a")  # in set 12
COPIES = ("Identity", "Cast")  # of a tensor that is not constant
WRITTEN_AS = {
    "Split": "split", "Softmax": "softmax", "Resize": "resize", "Upsample": "resize",
    "BatchNormalization": "normalization",
    **dict.fromkeys(["Reshape", "Squeeze", "Unsqueeze", "Flatten"], "reshape"),
    **dict.fromkeys(["ReduceMean", "ReduceSum", "ReduceMax"], "reduction"),
}  # fmt: skip

Arrays = List[np.ndarray]
_Node = Tuple[str, List[str], Dict[str, Any]]  # operator, inputs, attributes


def trimmed(model: Any, outputs: Sequence[str], shape: Tuple[int, ...]) -> Any:
    """The part of an onnx.ModelProto that computes some tensors; its metadata is kept.

    :param outputs: names of these tensors
    :param shape: of the only input
    :raises ValueError: the part has an operator that is not supported here, or a damaged node
    """
    from onnx import TensorProto, helper

    trimmer = _Trimmer(model.graph, shape)
    trimmer.run(_needed(model.graph, outputs))
    names = [trimmer.name(each) for each in outputs]
    inputs, made = (
        [
            helper.make_tensor_value_info(each, TensorProto.FLOAT, trimmer.values[each].shape)
            for each in tensors
        ]
        for tensors in ([trimmer.input], names)
    )
    graph = helper.make_graph(trimmer.nodes, "trimmed", inputs, made, trimmer.initializers(names))
    result = helper.make_model(graph, opset_imports=[helper.make_opsetid("", OPSET)])
    result.ir_version = IR_VERSION
    result.metadata_props.extend(model.metadata_props)
    return result


def _needed(graph: Any, outputs: Sequence[str]) -> List[Any]:
    """The nodes that these tensors depend on, in the order of the graph."""
    wanted, nodes = set(outputs), []
    for node in reversed(graph.node):
        if wanted.intersection(node.output):
            wanted.update(node.input)
            nodes.append(node)
    return nodes[::-1]


def _weights(graph: Any) -> Dict[str, np.ndarray]:
    """Initializers by name, in single instead of half precision."""
    from onnx import numpy_helper

    return {each.name: _single(numpy_helper.to_array(each)) for each in graph.initializer}


def _single(values: np.ndarray) -> np.ndarray:
    return values.astype(np.float32) if values.dtype == np.float16 else values


def attributes(node: Any) -> Dict[str, Any]:
    """Attributes of a node by name."""
    from onnx import helper

    return {each.name: helper.get_attribute_value(each) for each in node.attribute}


class _Trimmer:
    """Computes constants, and shapes of the other tensors, and writes the nodes that remain."""

    def __init__(self, graph: Any, shape: Tuple[int, ...]):
        # Of tensors that are not constant, only the shape is right.
        self.values: Dict[str, np.ndarray] = _weights(graph)
        self._constant = set(self.values)
        (self.input,) = (each.name for each in graph.input if each.name not in self._constant)
        self.values[self.input] = _unknown(shape)
        self._alias: Dict[str, str] = {}
        self.nodes: List[Any] = []

    def name(self, tensor: str) -> str:
        """The tensor that a tensor is a copy of."""
        return self._alias.get(tensor, tensor)

    def run(self, nodes: Sequence[Any]) -> None:
        """:raises ValueError: as trimmed()"""
        for node in nodes:
            inputs = [self.name(each) for each in node.input]
            is_constant = node.op_type == "Shape" or self._constant.issuperset(filter(None, inputs))
            if node.op_type in COPIES and not is_constant:
                self._alias[node.output[0]] = inputs[0]
                continue
            settings = attributes(node)
            made = self._computed(node, inputs, settings)
            self.values.update(
                zip(
                    node.output,
                    map(_single, made) if is_constant else (_unknown(each.shape) for each in made),
                )
            )
            if is_constant:
                self._constant.update(node.output)
            else:
                self._write(node, inputs, settings, [each.shape for each in made])

    def _computed(self, node: Any, inputs: List[str], settings: Dict[str, Any]) -> Arrays:
        """Outputs of a node; of one that is not constant only the shapes are right."""
        if node.op_type not in OPERATORS:
            raise ValueError(f"its operator {node.op_type} is not supported")
        if node.op_type in SHAPE_ONLY and self._constant.issuperset(filter(None, inputs)):
            raise ValueError(f"its operator {node.op_type} of a constant is not supported")
        given = [self.values[each] if each else None for each in inputs]
        try:
            return OPERATORS[node.op_type](given, settings, len(node.output))
        except (ValueError, TypeError, IndexError, KeyError, AttributeError) as error:
            raise ValueError(f"its {node.op_type} {node.name} is damaged ({error})") from None

    def _write(
        self, node: Any, inputs: List[str], settings: Dict[str, Any], shapes: List[Tuple[int, ...]]
    ) -> None:
        from onnx import helper

        write = getattr(self, f"_as_{WRITTEN_AS.get(node.op_type, 'it_is')}")
        op, inputs, settings = write(node, inputs, settings, shapes)
        self.nodes.append(helper.make_node(op, inputs, list(node.output), node.name, **settings))

    def _as_it_is(self, node: Any, inputs: List[str], settings: Dict[str, Any], _shapes: list) -> _Node:
        return node.op_type, inputs, settings

    def _as_split(self, _node: Any, inputs: List[str], settings: Dict[str, Any], shapes: list) -> _Node:
        axis = settings.get("axis", 0)
        return "Split", inputs[:1], {"axis": axis, "split": [shape[axis] for shape in shapes]}

    def _as_reshape(self, node: Any, inputs: List[str], _settings: Dict[str, Any], shapes: list) -> _Node:
        target = self._added(f"{node.output[0]}/shape", np.array(shapes[0], np.int64))
        return "Reshape", [inputs[0], target], {}

    def _as_resize(self, node: Any, inputs: List[str], settings: Dict[str, Any], shapes: list) -> _Node:
        scales = np.array(shapes[0], np.float32) / np.array(self.values[inputs[0]].shape, np.float32)
        region = self._added(f"{node.output[0]}/roi", np.zeros(0, np.float32))  # required, but not used
        kept = {name: value for name, value in settings.items() if name in RESIZE_SETTINGS}
        return "Resize", [inputs[0], region, self._added(f"{node.output[0]}/scales", scales)], kept

    def _as_softmax(self, _node: Any, inputs: List[str], settings: Dict[str, Any], shapes: list) -> _Node:
        return "Softmax", inputs, {"axis": settings.get("axis", -1) % len(shapes[0])}

    def _as_normalization(self, _node: Any, inputs: List[str], settings: Dict[str, Any], _: list) -> _Node:
        return "BatchNormalization", inputs, {"epsilon": settings.get("epsilon", 1e-5)}

    def _as_reduction(self, node: Any, inputs: List[str], settings: Dict[str, Any], _shapes: list) -> _Node:
        axes = _axes([self.values[each] for each in inputs], settings)
        return node.op_type, inputs[:1], {"axes": axes, "keepdims": settings.get("keepdims", 1)}

    def _added(self, name: str, value: np.ndarray) -> str:
        """Adds a constant."""
        self.values[name] = value
        self._constant.add(name)
        return name

    def initializers(self, outputs: Sequence[str]) -> List[Any]:
        """The constants that the nodes use."""
        from onnx import numpy_helper

        used = {each for node in self.nodes for each in node.input} | set(outputs)
        names = sorted(used & self._constant)
        return [numpy_helper.from_array(np.ascontiguousarray(self.values[each]), each) for each in names]


def _unknown(shape: Sequence[int]) -> np.ndarray:
    """Stands for a tensor of which only the shape is known; takes no memory."""
    return np.broadcast_to(np.float32(0), tuple(shape))


# ---- operators: inputs, attributes, number of outputs -> outputs


def _elementwise(function: Callable[..., Any]) -> Callable[..., Arrays]:
    def run(inputs: Arrays, settings: Dict[str, Any], _: int) -> Arrays:
        del settings
        return [np.asarray(function(*inputs))]

    return run


def _same_shape(inputs: Arrays, _settings: Dict[str, Any], _: int) -> Arrays:
    return [inputs[0]]


def _divided(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Integers are divided as in ONNX, toward zero."""
    return np.trunc(a / b).astype(a.dtype) if np.issubdtype(a.dtype, np.integer) else a / b


def _constant(_inputs: Arrays, settings: Dict[str, Any], _: int) -> Arrays:
    from onnx import numpy_helper

    ((name, value),) = settings.items()
    return [numpy_helper.to_array(value) if name == "value" else np.array(value)]


def _constant_of_shape(inputs: Arrays, settings: Dict[str, Any], _: int) -> Arrays:
    from onnx import numpy_helper

    value = numpy_helper.to_array(settings["value"]) if "value" in settings else np.zeros(1, np.float32)
    return [np.full(inputs[0].tolist(), value[0], value.dtype)]


def _cast(inputs: Arrays, settings: Dict[str, Any], _: int) -> Arrays:
    from onnx import TensorProto

    types = {TensorProto.INT64: np.int64, TensorProto.INT32: np.int32, TensorProto.BOOL: bool}
    return [inputs[0].astype(types.get(settings["to"], np.float32))]


def _axes(inputs: Arrays, settings: Dict[str, Any]) -> List[int]:
    """Of the attribute, or of the second input (operator sets from 13 on)."""
    return list(settings["axes"] if "axes" in settings else inputs[1].tolist())


def _unsqueezed(inputs: Arrays, settings: Dict[str, Any], _: int) -> Arrays:
    axes = _axes(inputs, settings)
    rank = inputs[0].ndim + len(axes)
    sides = iter(inputs[0].shape)
    added = {axis % rank for axis in axes}
    return [inputs[0].reshape([1 if axis in added else next(sides) for axis in range(rank)])]


def _squeezed(inputs: Arrays, settings: Dict[str, Any], _: int) -> Arrays:
    return [np.squeeze(inputs[0], tuple(_axes(inputs, settings)))]


def _reshaped(inputs: Arrays, _settings: Dict[str, Any], _: int) -> Arrays:
    sides = [side or inputs[0].shape[i] for i, side in enumerate(inputs[1].tolist())]
    return [inputs[0].reshape(sides)]


def _sliced(inputs: Arrays, settings: Dict[str, Any], _: int) -> Arrays:
    if "starts" in settings:  # operator sets before 10
        inputs = [inputs[0], *(np.array(settings[name]) for name in ("starts", "ends"))]
        inputs += [np.array(settings["axes"])] if "axes" in settings else []
    starts, ends = inputs[1].tolist(), inputs[2].tolist()
    axes = inputs[3].tolist() if len(inputs) > 3 and inputs[3] is not None else range(len(starts))
    steps = inputs[4].tolist() if len(inputs) > 4 else [1] * len(starts)
    window = [slice(None)] * inputs[0].ndim
    for start, end, axis, step in zip(starts, ends, axes, steps):
        window[axis] = slice(start, end, step)
    return [inputs[0][tuple(window)]]


def _split(inputs: Arrays, settings: Dict[str, Any], count: int) -> Arrays:
    axis = settings.get("axis", 0)
    given = settings.get("split", inputs[1].tolist() if len(inputs) > 1 else None)
    if given is None:
        given = [-(-inputs[0].shape[axis] // count)] * (count - 1)
    return np.split(inputs[0], np.cumsum(given)[: count - 1], axis)


def _convolved(inputs: Arrays, settings: Dict[str, Any], _: int) -> Arrays:
    filters = inputs[1].shape
    return [_windows(inputs[0].shape, filters[2:], settings, filters[0])]


def _pooled(inputs: Arrays, settings: Dict[str, Any], _: int) -> Arrays:
    return [_windows(inputs[0].shape, settings["kernel_shape"], settings, inputs[0].shape[1])]


def _windows(shape: Sequence[int], kernel: Sequence[int], settings: Dict[str, Any], channels: int):
    """Output of a convolution or pooling of images."""
    if settings.get("auto_pad", b"NOTSET") != b"NOTSET":
        raise ValueError("auto_pad is not supported")
    pads, strides = settings.get("pads", [0] * 4), settings.get("strides", [1, 1])
    dilations, up = settings.get("dilations", [1, 1]), settings.get("ceil_mode", 0)
    sides = []
    for i in range(2):
        room = shape[2 + i] + pads[i] + pads[2 + i] - dilations[i] * (kernel[i] - 1) - 1
        sides.append((-(-room // strides[i]) if up else room // strides[i]) + 1)
    return _unknown([shape[0], channels, *sides])


def _deconvolved(inputs: Arrays, settings: Dict[str, Any], _: int) -> Arrays:
    filters, pads = inputs[1].shape, settings.get("pads", [0] * 4)
    strides, extra = settings.get("strides", [1, 1]), settings.get("output_padding", [0, 0])
    sides = [
        (inputs[0].shape[2 + i] - 1) * strides[i] - pads[i] - pads[2 + i] + filters[2 + i] + extra[i]
        for i in range(2)
    ]
    return [_unknown([inputs[0].shape[0], filters[1] * settings.get("group", 1), *sides])]


def _resized(inputs: Arrays, _settings: Dict[str, Any], _: int) -> Arrays:
    if len(inputs) > 3 and inputs[3] is not None:
        return [_unknown(inputs[3].tolist())]
    scales = inputs[2] if len(inputs) > 2 else inputs[1]
    return [_unknown([int(side * scale) for side, scale in zip(inputs[0].shape, scales.tolist())])]


def _multiplied(inputs: Arrays, _settings: Dict[str, Any], _: int) -> Arrays:
    a, b = (each.shape for each in inputs)
    batch = np.broadcast(_unknown(a[:-2]), _unknown(b[:-2])).shape if max(len(a), len(b)) > 2 else ()
    return [_unknown([*batch, a[-2], b[-1]])]


def _reduced(inputs: Arrays, settings: Dict[str, Any], _: int) -> Arrays:
    axes = tuple(_axes(inputs, settings))
    return [np.mean(inputs[0], axes, keepdims=bool(settings.get("keepdims", 1)))]


def _padded(inputs: Arrays, settings: Dict[str, Any], _: int) -> Arrays:
    pads = np.reshape(settings["pads"] if "pads" in settings else inputs[1], (2, -1)).T
    return [_unknown([side + sum(more) for side, more in zip(inputs[0].shape, pads.tolist())])]


# Whose outputs are only right in their shape
SHAPE_ONLY = {
    "Sigmoid", "Relu", "LeakyRelu", "HardSigmoid", "Softmax", "Elu", "Clip", "Exp", "Tanh", "Erf", "Softplus",
    "BatchNormalization", "PRelu", "Conv", "ConvTranspose", "MaxPool", "AveragePool", "GlobalAveragePool",
    "Resize", "Upsample", "MatMul", "ReduceMean", "ReduceSum", "ReduceMax", "Pad",
}  # fmt: skip
OPERATORS: Dict[str, Callable[[Arrays, Dict[str, Any], int], Arrays]] = {
    **dict.fromkeys(
        ["Sigmoid", "Relu", "LeakyRelu", "HardSigmoid", "Softmax", "Identity", "Elu", "Clip", "Exp", "Tanh",
         "Erf", "Softplus", "BatchNormalization", "PRelu"],
        _same_shape,
    ),
    "Add": _elementwise(np.add), "Sub": _elementwise(np.subtract), "Mul": _elementwise(np.multiply),
    "Div": _elementwise(_divided), "Pow": _elementwise(np.power), "Sqrt": _elementwise(np.sqrt),
    "Floor": _elementwise(np.floor), "Neg": _elementwise(np.negative), "Mod": _elementwise(np.mod),
    "Equal": _elementwise(np.equal), "Where": _elementwise(np.where), "Max": _elementwise(np.maximum),
    "Min": _elementwise(np.minimum), "Range": _elementwise(np.arange),
    "Constant": _constant, "ConstantOfShape": _constant_of_shape, "Cast": _cast,
    "Shape": lambda inputs, settings, _: [
        np.array(inputs[0].shape[settings.get("start", 0) : settings.get("end")], np.int64)],
    "Gather": lambda inputs, settings, _: [np.take(inputs[0], inputs[1], settings.get("axis", 0))],
    "Concat": lambda inputs, settings, _: [np.concatenate(inputs, settings["axis"])],
    "Transpose": lambda inputs, settings, _: [np.transpose(inputs[0], settings.get("perm"))],
    "Expand": lambda inputs, settings, _: [inputs[0] * np.ones(inputs[1].tolist(), inputs[0].dtype)],
    "Flatten": lambda inputs, settings, _: [inputs[0].reshape(
        int(np.prod(inputs[0].shape[: settings.get("axis", 1)])), -1)],
    "Unsqueeze": _unsqueezed, "Squeeze": _squeezed, "Reshape": _reshaped, "Slice": _sliced, "Split": _split,
    "Conv": _convolved, "ConvTranspose": _deconvolved, "MaxPool": _pooled, "AveragePool": _pooled,
    "GlobalAveragePool": lambda inputs, settings, _: [_unknown([*inputs[0].shape[:2], 1, 1])],
    "Resize": _resized, "Upsample": _resized, "MatMul": _multiplied,
    "ReduceMean": _reduced, "ReduceSum": _reduced, "ReduceMax": _reduced, "Pad": _padded,
}  # fmt: skip
