# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Average precision, recall and confusion matrix of a detector on images with ground truth."""

from dataclasses import dataclass
from typing import List, NamedTuple, Sequence, Tuple

import numpy as np

from sextant.objects.detections import Detections

MIN_OVERLAP = 0.5  # minimum intersection over union of a box that matches an object
OVERLAPS = np.arange(0.5, 0.96, 0.05)  # minimum overlaps of COCO's mAP50-95


class TrueObjects(NamedTuple):
    """Ground truth of one image."""

    boxes: np.ndarray  # (n, 4) left, top, right, bottom, pixels
    classes: np.ndarray  # (n,) indices of the classes
    is_counted: np.ndarray  # (n,) bool; the other objects are neither hits nor misses


@dataclass(frozen=True)
class DetectorScore:
    """Scores over all images; the last row and column of the table are background."""

    precision: np.ndarray  # (classes,) average precision; NaN: no object of the class
    table: np.ndarray  # (classes + 1, classes + 1) true class by detected class, at the threshold
    threshold: float  # minimum score of the detections in the table

    @property
    def mean(self) -> float:
        """Mean average precision at an overlap of 0.5 (mAP50)."""
        return mean_precision(self.precision)


def detector_score(
    found: Sequence[Detections],
    known: Sequence[TrueObjects],
    classes: int,
    threshold: float,
) -> DetectorScore:
    """Scores the detections of a detector.

    :param found: detections in each image, also those with scores far below the threshold
    :param known: ground truth of each image
    :param classes: number of classes
    :param threshold: minimum score of the detections in the table
    """
    precision = average_precisions(found, known, classes, MIN_OVERLAP)
    table = np.zeros((classes + 1, classes + 1), int)
    for detections, objects in zip(found, known):
        _count(table, detections.of(detections.scores >= threshold), objects)
    return DetectorScore(precision, table, threshold)


def average_precisions(
    found: Sequence[Detections], known: Sequence[TrueObjects], classes: int, min_overlap: float
) -> np.ndarray:
    """Average precision (classes,) as in detector_score(); NaN: no object of the class."""
    each_class = range(classes)
    return np.array([_average_precision(found, known, each, min_overlap) for each in each_class])


def mean_precision(precision: np.ndarray) -> float:
    """Mean of average precisions (classes,), without classes that have no object; NaN: no class has any."""
    known = precision[np.isfinite(precision)]
    return float(known.mean()) if len(known) else float("nan")


def overlaps(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Intersection over union (n, m) of boxes (n, 4) and (m, 4)."""
    low = np.maximum(first[:, np.newaxis, :2], second[:, :2])
    high = np.minimum(first[:, np.newaxis, 2:], second[:, 2:])
    common = np.clip(high - low, 0.0, None).prod(axis=-1)
    areas = [np.clip(each[:, 2:] - each[:, :2], 0.0, None).prod(axis=-1) for each in (first, second)]
    return common / np.maximum(areas[0][:, np.newaxis] + areas[1] - common, 1e-9)


def _average_precision(
    found: Sequence[Detections], known: Sequence[TrueObjects], class_index: int, min_overlap: float
) -> float:
    """Area under the monotone precision-recall curve (Everingham et al. 2010, "PASCAL VOC")."""
    scores: List[float] = []
    hits: List[bool] = []
    total = 0
    for detections, objects in zip(found, known):
        detected = detections.of(detections.classes == class_index)
        is_of_class = objects.classes == class_index
        is_counted = objects.is_counted[is_of_class]
        matches = matched_objects(detected.boxes, objects.boxes[is_of_class], is_counted, min_overlap)
        for score, match in zip(detected.scores, matches):
            if match < 0 or is_counted[match]:
                scores.append(score)
                hits.append(match >= 0)
        total += int(np.count_nonzero(is_counted))
    if not total:
        return float("nan")
    order = np.argsort(-np.array(scores), kind="stable")
    true = np.cumsum(np.array(hits, bool)[order])
    recall, precision = true / total, true / np.arange(1, len(true) + 1)
    falling = np.maximum.accumulate(precision[::-1])[::-1]
    return float(np.sum(np.diff(recall, prepend=0.0) * falling))


def matched_objects(
    boxes: np.ndarray, true: np.ndarray, once: np.ndarray, min_overlap: float = MIN_OVERLAP
) -> List[int]:
    """Index of the object that each box matches; -1: none.

    :param boxes: (n, 4), the box with the highest score first
    :param true: (objects, 4) boxes
    :param once: (objects,) bool, whether only one box may match the object
    """
    remaining, matches = overlaps(boxes, true), []
    for row in remaining:
        best = int(np.argmax(row)) if len(true) else -1
        matches.append(best if best >= 0 and row[best] >= min_overlap else -1)
        if matches[-1] >= 0 and once[best]:
            remaining[:, best] = -1.0
    return matches


def _count(table: np.ndarray, found: Detections, objects: TrueObjects) -> None:
    """Counts each object with the box of the highest score that matches it, whatever its class."""
    background = len(table) - 1
    detected_as = np.full(len(objects.boxes), background)
    for detected, match in zip(
        found.classes, matched_objects(found.boxes, objects.boxes, np.ones(len(detected_as), bool))
    ):
        if match < 0:
            table[background, detected] += 1
        else:
            detected_as[match] = detected
    for true, detected, is_counted in zip(objects.classes, detected_as, objects.is_counted):
        if is_counted or detected != background:
            table[true, detected] += 1


def recall_and_precision(table: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Recall and precision (classes,) from a DetectorScore's table."""
    correct = np.diag(table)[:-1].astype(float)
    with np.errstate(invalid="ignore"):
        return correct / table[:-1].sum(axis=1), correct / table[:, :-1].sum(axis=0)
