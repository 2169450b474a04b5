# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Object detection by a network of the YOLOv8 or YOLO11 family in an ONNX file."""

import ast
import time
from dataclasses import dataclass
from typing import Dict, List, Tuple

import cv2
import numpy as np

from sextant.base.onnx_model import BACKENDS, ModelInfo, open_network, read_model
from sextant.base.strict_params import Check, StrictParams, one_of, param, within
from sextant.objects.detections import Detections, check_image
from sextant.objects.letter_box import GREY, blob_of, letter_box
from sextant.objects.non_maximum_suppression import non_maximum_suppression
from sextant.objects.yolo_output import decoded

MULTIPLE = 32  # pixels; exporters round the input size up: 240 is exported as 256


@dataclass(frozen=True)
class YoloParams(StrictParams):
    """The network, and thresholds for its detections."""

    model: str = param("", "ONNX file of the network; empty: the one that comes with Sextant")
    backend: str = param(
        "auto",
        "runtime of the network; auto: onnxruntime if installed, else OpenCV",
        one_of("auto", *BACKENDS),
    )
    classes: Tuple[str, ...] = param(
        (), "class names in the network's order; empty: from the model", Check("as many as the network has")
    )
    size: int = param(
        0,
        "side of the network's input, rounded up to a multiple of 32; required if the model leaves it "
        "open, else 0 or the model's own",
        within(0, 4096),
        "px",
    )
    confidence: float = param(0.4, "minimum score of a detection", within(0.01, 0.99))
    max_overlap: float = param(
        0.5, "intersection over union above which only the box with the higher score is kept", within(0.01, 1)
    )
    class_agnostic: bool = param(False, "apply `max_overlap` also to boxes of different classes")
    max_objects: int = param(100, "maximum number of detections in an image", within(1, 10000))


class YoloDetector:
    """Detects objects in colour images. Not thread-safe."""

    def __init__(self, params: YoloParams, threads: int = 0):
        """:param threads: of the network; 0: as many as OpenCV uses

        :raises OSError: the model cannot be read
        :raises ValueError: a parameter out of range, or a model that does not fit, and what to do
        """
        if not params.model:
            raise ValueError("model is empty, it must be an ONNX file")
        self._params = params
        facts = read_model(params.model)
        self.classes = _classes(params, facts)
        self.size = _size(params, facts)  # width and height of the input, pixels
        self._network = open_network(params.model, params.backend, threads or cv2.getNumThreads())
        self.seconds: Dict[str, float] = {}  # processing time of each stage, last image
        grey = np.full((1, 3, self.size[1], self.size[0]), GREY / 255.0, np.float32)
        self._decoded(self._network(grey))  # raises if the outputs do not fit

    def detect(self, image: np.ndarray) -> Detections:
        """Detect objects.

        :param image: uint8 (height, width, 3), RGB
        :raises ValueError: another shape or type, or the model cannot be run
        """
        check_image(image)
        begin = time.perf_counter()
        size = image.shape[1], image.shape[0]
        box = letter_box(size, self.size)
        blob = blob_of(image, box, self.size)
        prepared = time.perf_counter()
        outputs = self._network(blob)
        run = time.perf_counter()
        params = self._params
        found = self._decoded(outputs)
        found = found._replace(boxes=box.to_image(found.boxes, size))
        found = non_maximum_suppression(found, params.max_overlap, params.class_agnostic, params.max_objects)
        stages = {"letter box": prepared - begin, "network": run - prepared}
        self.seconds = {**stages, "decoding": time.perf_counter() - run}
        return found

    def _decoded(self, outputs: List[np.ndarray]) -> Detections:
        try:
            return decoded(outputs, self.size, len(self.classes), self._params.confidence)
        except ValueError as error:
            raise ValueError(f"{self._params.model}: {error}") from None


def _classes(params: YoloParams, facts: ModelInfo) -> List[str]:
    """Class names from the parameters or the model."""
    written = facts.metadata.get("names", "")
    try:
        names = ast.literal_eval(written) if written else {}
        known = [str(names[i]) for i in range(len(names))]
    except (ValueError, SyntaxError, KeyError, TypeError):
        raise ValueError(f"{params.model}: its class names cannot be read: {written[:80]}") from None
    if params.classes and known and len(params.classes) != len(known):
        given, names = len(params.classes), ", ".join(known)
        raise ValueError(f"classes are {given} names, but {params.model} has {len(known)}: {names}")
    classes = list(params.classes) or known
    if not classes:
        raise ValueError(f"{params.model}: contains no class names: set classes")
    return classes


def _size(params: YoloParams, facts: ModelInfo) -> Tuple[int, int]:
    """Width and height of the model's input."""
    taken = facts.input
    if taken.channels not in (0, 3):
        raise ValueError(f"{params.model}: takes {taken.channels} channel; it must take red, green and blue")
    return _side(params, "width", taken.width), _side(params, "height", taken.height)


def _side(params: YoloParams, name: str, fixed: int) -> int:
    """One side of the input. :param fixed: pixels in the model, 0: any"""
    asked = -(-params.size // MULTIPLE) * MULTIPLE
    if fixed % MULTIPLE:
        raise ValueError(f"{params.model}: takes a {name} of {fixed}; it must be a multiple of {MULTIPLE}")
    if fixed and asked not in (0, fixed):
        raise ValueError(f"size is {params.size}, but {params.model} takes a {name} of {fixed}")
    if not fixed and not asked:
        raise ValueError(f"size must be set: {params.model} takes any {name}")
    return fixed or asked
