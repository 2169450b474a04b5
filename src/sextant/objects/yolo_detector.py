# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Finds objects by a network of the YOLOv8 or YOLO11 family in an ONNX file."""

import ast
import time
from dataclasses import dataclass
from typing import Dict, List, Tuple

import cv2
import numpy as np

from sextant.base.onnx_model import BACKENDS, ModelFacts, open_network, read_model
from sextant.base.strict_params import StrictParams, one_of, param, within
from sextant.objects.detection import Detections, check_picture, suppressed
from sextant.objects.letter_box import GREY, blob_of, letter_box
from sextant.objects.yolo_output import decoded

MULTIPLE = 32  # pixels: an input that is asked for as 240 is exported as 256


@dataclass(frozen=True)
class YoloParams(StrictParams):
    """Which network, and what of its finds is told."""

    model: str = ""  # ONNX file
    backend: str = param("auto", one_of("auto", *BACKENDS))  # auto: onnxruntime where it is installed
    classes: Tuple[str, ...] = ()  # names in the network's order; empty: as the model says
    size: int = param(0, within(0, 4096))  # pixels a side, if the model takes any; rounded up to 32s
    confidence: float = param(0.4, within(0.01, 0.99))  # least score
    overlap: float = param(0.5, within(0.01, 1))  # intersection over union from which on two boxes are one
    class_agnostic: bool = False  # boxes of different classes may be one, too
    most: int = param(100, within(1, 10000))  # that are told of a picture


class YoloDetector:
    """Finds objects in colour pictures. Not thread-safe."""

    def __init__(self, params: YoloParams, threads: int = 0):
        """:param threads: 0: as many as OpenCV has

        :raises OSError: the model cannot be read
        :raises ValueError: a setting out of range, or no such model, and what to do
        """
        if not params.model:
            raise ValueError("model is empty, it must be an ONNX file")
        self._params = params
        facts = read_model(params.model)
        self.classes = _classes(params, facts)
        self.size = _size(params, facts)  # width and height of the input, pixels
        self._network = open_network(params.model, params.backend, threads or cv2.getNumThreads())
        self.seconds: Dict[str, float] = {}  # of each stage of the last picture
        grey = np.full((1, 3, self.size[1], self.size[0]), GREY / 255.0, np.float32)
        self._decoded(self._network(grey))  # refuses what cannot be used

    def detect(self, image: np.ndarray) -> Detections:
        """:param image: uint8 (height, width, 3), red first

        :raises ValueError: it is not, or the model cannot be run on it
        """
        check_picture(image)
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
        found = suppressed(found, params.overlap, params.class_agnostic, params.most)
        stages = {"letter box": prepared - begin, "network": run - prepared}
        self.seconds = {**stages, "decoding": time.perf_counter() - run}
        return found

    def _decoded(self, outputs: List[np.ndarray]) -> Detections:
        try:
            return decoded(outputs, self.size, len(self.classes), self._params.confidence)
        except ValueError as error:
            raise ValueError(f"{self._params.model}: {error}") from None


def _classes(params: YoloParams, facts: ModelFacts) -> List[str]:
    """Names, of the settings or of the model."""
    written = facts.notes.get("names", "")
    try:
        names = ast.literal_eval(written) if written else {}
        told = [str(names[i]) for i in range(len(names))]
    except (ValueError, SyntaxError, KeyError, TypeError):
        raise ValueError(f"{params.model}: its names of classes cannot be read: {written[:80]}") from None
    if params.classes and told and len(params.classes) != len(told):
        asked, known = len(params.classes), ", ".join(told)
        raise ValueError(f"classes are {asked} names, but {params.model} has {len(told)}: {known}")
    classes = list(params.classes) or told
    if not classes:
        raise ValueError(f"{params.model}: does not name its classes: set classes")
    return classes


def _size(params: YoloParams, facts: ModelFacts) -> Tuple[int, int]:
    """Width and height of what the model takes."""
    taken = facts.input
    if taken.channels not in (0, 3):
        raise ValueError(
            f"{params.model}: takes {taken.channels} channel; it must take red, green and blue"
        )
    return _side(params, "width", taken.width), _side(params, "height", taken.height)


def _side(params: YoloParams, name: str, fixed: int) -> int:
    """:param fixed: pixels that the model takes, 0: any"""
    asked = -(-params.size // MULTIPLE) * MULTIPLE
    if fixed % MULTIPLE:
        raise ValueError(f"{params.model}: takes a {name} of {fixed}; it must be a multiple of {MULTIPLE}")
    if fixed and asked not in (0, fixed):
        raise ValueError(f"size is {params.size}, but {params.model} takes a {name} of {fixed}")
    if not fixed and not asked:
        raise ValueError(f"size must be set: {params.model} takes any {name}")
    return fixed or asked
