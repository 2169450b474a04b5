# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a detector finds in a picture, and which of several finds is told."""

from typing import Dict, List, NamedTuple, Protocol, Sequence

import cv2
import numpy as np


class Detections(NamedTuple):
    """Boxes of one picture, the surest first."""

    boxes: np.ndarray  # (n, 4) left, top, right, bottom, pixels; (0, 0) is the corner of the first pixel
    scores: np.ndarray  # (n,) [0, 1]
    classes: np.ndarray  # (n,) indices of the classes

    def of(self, which: np.ndarray) -> "Detections":
        """:param which: indices or a mask"""
        return Detections(self.boxes[which], self.scores[which], self.classes[which])


class Detector(Protocol):
    """What finds objects: YoloDetector, ColourDetector."""

    classes: List[str]
    seconds: Dict[str, float]  # of each stage of the last picture

    def detect(self, image: np.ndarray) -> Detections:
        """:param image: uint8 (height, width, 3), red first"""


NOTHING = Detections(np.zeros((0, 4)), np.zeros(0), np.zeros(0, int))


def check_picture(image: np.ndarray) -> None:
    """:raises ValueError: it is not uint8 (height, width, 3)"""
    if image.dtype != np.uint8 or image.ndim != 3 or image.shape[2] != 3 or not image.size:
        raise ValueError(f"a picture is {image.dtype} {image.shape}, it must be uint8 (height, width, 3)")


def suppressed(found: Detections, overlap: float, class_agnostic: bool, most: int) -> Detections:
    """Without those that overlap a surer one (greedy non-maximum suppression).

    :param overlap: intersection over union from which on two are one
    :param class_agnostic: also two of different classes
    """
    if not len(found.scores):
        return NOTHING
    apart = 0.0 if class_agnostic else float(np.ptp(found.boxes)) + 1.0  # no two classes overlap then
    boxes = found.boxes + apart * found.classes[:, np.newaxis]
    sizes = np.hstack([boxes[:, :2], boxes[:, 2:] - boxes[:, :2]])
    kept = cv2.dnn.NMSBoxes(sizes.tolist(), found.scores.tolist(), 0.0, overlap)
    return found.of(np.ravel(kept).astype(int)[:most])


def names_of(classes: np.ndarray, names: Sequence[str]) -> List[str]:
    """Names of the classes of detections."""
    return [names[each] for each in classes]
