# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Object detection by a YOLO network in an ONNX file."""

import time
from dataclasses import dataclass
from typing import Dict, Tuple

import cv2
import numpy as np

from sextant.base.onnx_model import BACKENDS
from sextant.base.strict_params import Check, StrictParams, one_of, param, within
from sextant.objects.detections import Detections, check_image
from sextant.objects.letter_box import GREY, blob_of, letter_box
from sextant.objects.non_maximum_suppression import non_maximum_suppression
from sextant.objects.yolo_model import YoloModel


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
    confidence: float = param(0.5, "minimum score of a detection", within(0.01, 0.99))
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
        threads = threads or cv2.getNumThreads()
        model = YoloModel(params.model, params.backend, params.classes, params.size, threads)
        self._model, self.classes, self.notes = model, model.classes, model.notes
        self.size = model.size  # width and height of the input, pixels
        self.seconds: Dict[str, float] = {}  # processing time of each stage, last image
        grey = np.full((1, 3, self.size[1], self.size[0]), GREY / 255.0, np.float32)
        model.decoded(model.run(grey), params.confidence)  # raises if the outputs do not fit

    def detect(self, image: np.ndarray) -> Detections:
        """Detect objects.

        :param image: uint8 (height, width, 3), RGB
        :raises ValueError: another shape or type, or the model cannot be run
        """
        check_image(image)
        begin = time.perf_counter()
        size = image.shape[1], image.shape[0]
        box = letter_box(size, self.size)
        blob = blob_of(image, box, self.size, self._model.is_interpolated)
        prepared = time.perf_counter()
        outputs = self._model.run(blob)
        run = time.perf_counter()
        params = self._params
        found = self._model.decoded(outputs, params.confidence)
        overlap = 1.0 if self._model.is_end_to_end else params.max_overlap
        # Before they are clipped at the image's borders: then they may overlap more.
        found = non_maximum_suppression(found, overlap, params.class_agnostic, params.max_objects)
        found = found._replace(boxes=box.to_image(found.boxes, size))
        stages = {"letter box": prepared - begin, "network": run - prepared}
        self.seconds = {**stages, "decoding": time.perf_counter() - run}
        return found
