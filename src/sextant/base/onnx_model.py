# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Neural networks in ONNX files with one image as input, run by onnxruntime or by OpenCV's dnn."""

import importlib.util
import re
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence

import cv2
import numpy as np

INSTALL = "install onnxruntime: python3 -m pip install --user --break-system-packages onnxruntime"

# float32 (1, channels, height, width) to the model's outputs
Network = Callable[[np.ndarray], List[np.ndarray]]


class ImageInput(NamedTuple):
    """Shape of a model's input image; 0: any."""

    channels: int  # 1 or 3
    height: int  # pixels
    width: int  # pixels


class ModelInfo(NamedTuple):
    """Input, outputs and metadata of a model."""

    input: ImageInput  # its shape and type
    outputs: List[str]  # names
    metadata: Dict[str, str]  # metadata_props of the file, by name


def read_model(path: str) -> ModelInfo:
    """Reads input, outputs and metadata of a model.

    :raises OSError, ValueError: see load_model() and model_info()
    """
    return model_info(path, load_model(path))


def load_model(path: str) -> Any:
    """Reads an onnx.ModelProto.

    :raises OSError: the file cannot be read
    :raises ValueError: not an ONNX file, or weights or inputs of nodes are missing
    """
    import onnx  # imported here: it is slow, and few place maps have a model
    from google.protobuf.message import DecodeError

    try:
        model = onnx.load(path, load_external_data=False)
    except DecodeError:
        raise ValueError(f"{path}: is no ONNX file") from None
    graph = model.graph
    if not graph.node:
        raise ValueError(f"{path}: is no ONNX file, or there is no network in it")
    if any(each.data_location == onnx.TensorProto.EXTERNAL for each in graph.initializer):
        raise ValueError(f"{path}: its weights are in another file; save both as one by onnx.save()")
    _check_weights(path, graph)
    _sort_nodes(path, graph)
    return model


def model_info(path: str, model: Any, may_be_half: bool = False) -> ModelInfo:
    """Input, outputs and metadata of an onnx.ModelProto.

    :param may_be_half: whether the input may have half precision
    :raises ValueError: not a model with one image as input
    """
    from onnx import TensorProto

    types = (TensorProto.FLOAT, TensorProto.FLOAT16)[: 1 + may_be_half]
    tensor = only(path, "input", _inputs_of(model.graph)).type.tensor_type
    image_input = _image_input(path, tensor, tensor.elem_type in types)
    metadata = {each.key: each.value for each in model.metadata_props}
    return ModelInfo(image_input, [each.name for each in model.graph.output], metadata)


def only(path: str, what: str, found: Sequence[Any]) -> Any:
    """Returns the only input or output.

    :param what: "input" or "output", for the error
    :raises ValueError: there is none, or more than one
    """
    if len(found) != 1:
        names = ", ".join(getattr(each, "name", each) for each in found)
        raise ValueError(f"{path}: has {len(found)} {what}s ({names}); it must have one")
    return found[0]


def _check_weights(path: str, graph: Any) -> None:
    """:raises ValueError: weights are missing; OpenCV would read out of bounds or crash"""
    from onnx import numpy_helper

    for each in graph.initializer:
        try:
            numpy_helper.to_array(each)
        except (ValueError, TypeError, KeyError) as error:
            raise ValueError(f"{path}: its weights {each.name} cannot be read ({error})") from None


def _image_input(path: str, tensor: Any, is_float: bool) -> ImageInput:
    sizes = [each.dim_value for each in tensor.shape.dim]
    if not is_float or len(sizes) != 4 or sizes[0] not in (0, 1) or sizes[1] not in (0, 1, 3):
        shape = "×".join(str(size or "any") for size in sizes)
        raise ValueError(f"{path}: takes {shape}; it must take 1×(1 or 3)×height×width, float32")
    return ImageInput(*sizes[1:])


def _inputs_of(graph: Any) -> List[Any]:
    weights = {each.name for each in graph.initializer}
    return [each for each in graph.input if each.name not in weights]  # old files list weights as inputs


def _sort_nodes(path: str, graph: Any) -> None:
    """Puts each node behind those that it depends on: converters to half precision do not.

    :raises ValueError: a node lacks an input; OpenCV would crash
    """
    known = {"", *(each.name for each in graph.initializer), *(each.name for each in graph.input)}
    waiting, ordered = list(graph.node), []  # "" is an omitted optional input
    while waiting:
        left = []
        for node in waiting:
            is_ready = known.issuperset(node.input)
            (ordered if is_ready else left).append(node)
            known.update(node.output if is_ready else ())
        if len(left) == len(waiting):
            node = left[0]
            lacking = sorted(set(node.input) - known)[0]
            raise ValueError(f"{path}: its {node.op_type} works on {lacking}, which is not there")
        waiting = left
    if ordered != list(graph.node):
        copies = [type(node).FromString(node.SerializeToString()) for node in ordered]
        del graph.node[:]
        graph.node.extend(copies)


def open_network(path: str, backend: str, threads: int, content: Optional[bytes] = None) -> Network:
    """Returns the model as a function, which is not thread-safe.

    :param backend: a name in BACKENDS, or auto: onnxruntime if it is installed, else opencv
    :param threads: number of threads of onnxruntime; OpenCV ignores it
    :param content: replaces that of the file, which is only named in errors
    :raises OSError: the file cannot be read
    :raises ValueError: the model cannot be run; the text explains what to do
    """
    if backend == "auto":
        backend = "onnxruntime" if importlib.util.find_spec("onnxruntime") else "opencv"
    return BACKENDS[backend](path, threads, content)


def _by_onnxruntime(path: str, threads: int, content: Optional[bytes]) -> Network:
    try:
        import onnxruntime  # optional, and not in Debian
    except ImportError as error:
        raise ValueError(f"backend is onnxruntime: {error}; {INSTALL}, or set opencv") from None
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = threads
    options.log_severity_level = 3  # errors
    try:
        session = onnxruntime.InferenceSession(content or path, options, providers=["CPUExecutionProvider"])
    except Exception as error:  # onnxruntime's exceptions have no other base class
        raise _cannot(path, "onnxruntime", error) from None
    name = session.get_inputs()[0].name

    def run(blob: np.ndarray) -> List[np.ndarray]:
        try:
            return session.run(None, {name: blob})
        except Exception as error:
            raise _cannot(path, "onnxruntime", error) from None

    return run


def _by_opencv(path: str, _threads: int, content: Optional[bytes]) -> Network:
    try:
        net = cv2.dnn.readNetFromONNX(np.frombuffer(content, np.uint8) if content else path)
    except cv2.error as error:
        lacking = re.search(r"Can't create layer .* of type \"(\w+)\"", str(error))
        if lacking:
            reason = f"{path}: OpenCV's dnn lacks the operator {lacking.group(1)}"
            raise ValueError(f"{reason}; {INSTALL}") from None
        raise _cannot(path, "OpenCV's dnn", error, INSTALL) from None

    last = net.getUnconnectedOutLayersNames()

    def run(blob: np.ndarray) -> List[np.ndarray]:
        try:
            net.setInput(blob)
            return list(net.forward(last))
        except cv2.error as error:
            raise _cannot(path, "OpenCV's dnn", error, INSTALL) from None

    return run


def _cannot(path: str, who: str, error: Exception, instead: str = "") -> ValueError:
    reason = " ".join(str(error).split())
    return ValueError(f"{path}: {who} cannot run it ({reason})" + (f"; {instead}" if instead else ""))


BACKENDS = {"onnxruntime": _by_onnxruntime, "opencv": _by_opencv}
