# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Detections in an image, and the interface of detectors."""

from typing import Dict, List, NamedTuple, Protocol

import numpy as np


class Detections(NamedTuple):
    """Boxes in one image, in descending order of the score."""

    boxes: np.ndarray  # (n, 4) left, top, right, bottom, pixels; (0, 0) is the corner of the first pixel
    scores: np.ndarray  # (n,) [0, 1]
    classes: np.ndarray  # (n,) indices of the classes

    def of(self, which: np.ndarray) -> "Detections":
        """Select detections. :param which: indices or a mask"""
        return Detections(self.boxes[which], self.scores[which], self.classes[which])


class Detector(Protocol):
    """Interface of YoloDetector and ColourDetector."""

    classes: List[str]
    notes: List[str]  # on the detector, for the user
    seconds: Dict[str, float]  # processing time of each stage, last image

    def detect(self, image: np.ndarray) -> Detections:
        """Detect objects. :param image: uint8 (height, width, 3), RGB"""


NO_DETECTIONS = Detections(np.zeros((0, 4)), np.zeros(0), np.zeros(0, int))


def check_image(image: np.ndarray) -> None:
    """:raises ValueError: the image is not uint8 (height, width, 3)"""
    if image.dtype != np.uint8 or image.ndim != 3 or image.shape[2] != 3 or not image.size:
        raise ValueError(f"the image is {image.dtype} {image.shape}, it must be uint8 (height, width, 3)")
