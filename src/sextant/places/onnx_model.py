# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A network in an ONNX file with one image in and one vector out, run by onnxruntime or by OpenCV's dnn."""

import importlib.util
import re
from typing import Any, Callable, List, NamedTuple, Sequence

import cv2
import numpy as np

INSTALL = "install onnxruntime: pip install onnxruntime"

Network = Callable[[np.ndarray], np.ndarray]  # float32 (1, channels, height, width) to what the model makes


class ImageInput(NamedTuple):
    """What a model takes; 0: any."""

    channels: int
    height: int  # pixels
    width: int


def read_input(path: str) -> ImageInput:
    """What the file says that the model takes.

    :raises OSError: it cannot be read
    :raises ValueError: it is no ONNX file, or no model of one image to one output
    """
    import onnx  # here: few maps have a model, and it takes time
    from google.protobuf.message import DecodeError

    try:
        graph = onnx.load(path, load_external_data=False).graph
    except DecodeError:
        raise ValueError(f"{path}: is no ONNX file") from None
    if not graph.node:
        raise ValueError(f"{path}: is no ONNX file, or there is no network in it")
    if any(each.data_location == onnx.TensorProto.EXTERNAL for each in graph.initializer):
        raise ValueError(f"{path}: its weights are in another file; save both as one by onnx.save()")
    _only(path, "output", graph.output)
    tensor = _only(path, "input", _inputs_of(path, graph)).type.tensor_type
    return _image_input(path, tensor, tensor.elem_type == onnx.TensorProto.FLOAT)


def _only(path: str, what: str, found: Sequence[Any]) -> Any:
    if len(found) != 1:
        names = ", ".join(each.name for each in found)
        raise ValueError(f"{path}: has {len(found)} {what}s ({names}); it must have one")
    return found[0]


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

    def run(blob: np.ndarray) -> np.ndarray:
        try:
            return session.run(None, {name: blob})[0]
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

    def run(blob: np.ndarray) -> np.ndarray:
        try:
            net.setInput(blob)
            return net.forward()
        except cv2.error as error:
            raise _cannot(path, "OpenCV's dnn", error, INSTALL) from None

    return run


def _cannot(path: str, who: str, error: Exception, instead: str = "") -> ValueError:
    reason = " ".join(str(error).split())
    return ValueError(f"{path}: {who} cannot run it ({reason})" + (f"; {instead}" if instead else ""))


BACKENDS = {"onnxruntime": _by_onnxruntime, "opencv": _by_opencv}
