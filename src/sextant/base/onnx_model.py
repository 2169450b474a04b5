# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A network in an ONNX file that takes one image, run by onnxruntime or by OpenCV's dnn."""

import importlib.util
import re
from typing import Any, Callable, Dict, List, NamedTuple, Sequence

import cv2
import numpy as np

INSTALL = "install onnxruntime: pip install onnxruntime"

# float32 (1, channels, height, width) to what the model makes
Network = Callable[[np.ndarray], List[np.ndarray]]


class ImageInput(NamedTuple):
    """What a model takes; 0: any."""

    channels: int
    height: int  # pixels
    width: int


class ModelFacts(NamedTuple):
    """What a file says of its model."""

    input: ImageInput
    outputs: List[str]  # names
    notes: Dict[str, str]  # that its maker wrote into it, by name


def read_model(path: str) -> ModelFacts:
    """
    :raises OSError: it cannot be read
    :raises ValueError: it is no ONNX file, or no model of one image
    """
    import onnx  # here: few maps have a model, and it takes time
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
    tensor = only(path, "input", _inputs_of(path, graph)).type.tensor_type
    taken = _image_input(path, tensor, tensor.elem_type == onnx.TensorProto.FLOAT)
    notes = {each.key: each.value for each in model.metadata_props}
    return ModelFacts(taken, [each.name for each in graph.output], notes)


def only(path: str, what: str, found: Sequence[Any]) -> Any:
    """:raises ValueError: there are more inputs or outputs than one, or none"""
    if len(found) != 1:
        names = ", ".join(getattr(each, "name", each) for each in found)
        raise ValueError(f"{path}: has {len(found)} {what}s ({names}); it must have one")
    return found[0]


def _check_weights(path: str, graph: Any) -> None:
    """:raises ValueError: some are not there; OpenCV would read beyond them, or crash"""
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


def _inputs_of(path: str, graph: Any) -> List[Any]:
    """:raises ValueError: a node lacks what it works on; OpenCV would crash"""
    weights = {each.name for each in graph.initializer}
    inputs = [each for each in graph.input if each.name not in weights]  # old files name weights there, too
    known = {"", *weights, *(each.name for each in inputs)}  # "": an option that is left out
    for node in graph.node:
        lacking = set(node.input) - known
        if lacking:
            raise ValueError(f"{path}: its {node.op_type} works on {lacking.pop()}, which is not there")
        known.update(node.output)
    return inputs


def open_network(path: str, backend: str, threads: int) -> Network:
    """The model as a function; it is not thread-safe.

    :param backend: of BACKENDS, or auto: onnxruntime where it is installed
    :raises OSError: it cannot be read
    :raises ValueError: it cannot be run, and what to do
    """
    if backend == "auto":
        backend = "onnxruntime" if importlib.util.find_spec("onnxruntime") else "opencv"
    return BACKENDS[backend](path, threads)


def _by_onnxruntime(path: str, threads: int) -> Network:
    try:
        import onnxruntime  # optional, and not in Debian
    except ImportError as error:
        raise ValueError(f"backend is onnxruntime: {error}; {INSTALL}, or take opencv") from None
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = threads
    options.log_severity_level = 3  # errors
    try:
        session = onnxruntime.InferenceSession(path, options, providers=["CPUExecutionProvider"])
    except Exception as error:  # its exceptions have no other base
        raise _cannot(path, "onnxruntime", error) from None
    name = session.get_inputs()[0].name

    def run(blob: np.ndarray) -> List[np.ndarray]:
        try:
            return session.run(None, {name: blob})
        except Exception as error:
            raise _cannot(path, "onnxruntime", error) from None

    return run


def _by_opencv(path: str, _threads: int) -> Network:
    try:
        net = cv2.dnn.readNetFromONNX(path)
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
