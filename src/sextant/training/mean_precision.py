# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""How good a detector is, by pictures whose objects are known."""

from dataclasses import dataclass
from typing import List, NamedTuple, Sequence, Tuple

import numpy as np

from sextant.objects.detection import Detections

SAME = 0.5  # intersection over union from which on a box is of an object


class KnownObjects(NamedTuple):
    """What is in one picture."""

    boxes: np.ndarray  # (n, 4) left, top, right, bottom, pixels
    classes: np.ndarray  # (n,) indices
    counts: np.ndarray  # (n,) bool; of what does not it is no matter whether it is found


@dataclass(frozen=True)
class DetectorScore:
    """Over all pictures; the last row and column of the table are of nothing."""

    precision: np.ndarray  # (classes,) average precision, NaN: there is none of it
    table: np.ndarray  # (classes + 1, classes + 1) what there is by what was found, at the threshold
    threshold: float

    @property
    def mean(self) -> float:
        """mAP50"""
        return float(np.nanmean(self.precision))


def detector_score(
    found: Sequence[Detections], known: Sequence[KnownObjects], classes: int, threshold: float
) -> DetectorScore:
    """:param found: of each picture, with scores far below the threshold, too. :param known: of each"""
    precision = np.array([_average_precision(found, known, each) for each in range(classes)])
    table = np.zeros((classes + 1, classes + 1), int)
    for detections, objects in zip(found, known):
        _count(table, detections.of(detections.scores >= threshold), objects)
    return DetectorScore(precision, table, threshold)


def overlaps(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """(n, m) intersection over union of boxes (n, 4) and (m, 4)."""
    low = np.maximum(first[:, np.newaxis, :2], second[:, :2])
    high = np.minimum(first[:, np.newaxis, 2:], second[:, 2:])
    common = np.clip(high - low, 0.0, None).prod(axis=-1)
    areas = [np.clip(each[:, 2:] - each[:, :2], 0.0, None).prod(axis=-1) for each in (first, second)]
    return common / np.maximum(areas[0][:, np.newaxis] + areas[1] - common, 1e-9)


def _average_precision(found: Sequence[Detections], known: Sequence[KnownObjects], which: int) -> float:
    """Area under precision over recall, precision made falling (Everingham et al. 2010, "PASCAL VOC")."""
    scores: List[float] = []
    hits: List[bool] = []
    total = 0
    for detections, objects in zip(found, known):
        mine = detections.of(detections.classes == which)
        is_one = objects.classes == which
        judged = _judged(mine.boxes, objects.boxes[is_one], objects.counts[is_one])
        scores += [score for score, hit in zip(mine.scores, judged) if hit is not None]
        hits += [hit for hit in judged if hit is not None]
        total += int(np.count_nonzero(objects.counts[is_one]))
    if not total:
        return float("nan")
    order = np.argsort(-np.array(scores), kind="stable")
    true = np.cumsum(np.array(hits, bool)[order])
    recall, precision = true / total, true / np.arange(1, len(true) + 1)
    falling = np.maximum.accumulate(precision[::-1])[::-1]
    return float(np.sum(np.diff(recall, prepend=0.0) * falling))


def _judged(boxes: np.ndarray, true: np.ndarray, counts: np.ndarray) -> List:
    """Whether each box, the surest first, is of an object that none before was; None: it does not count."""
    left, judged = overlaps(boxes, true), []
    for row in range(len(boxes)):
        best = int(np.argmax(left[row])) if len(true) else -1
        if best < 0 or left[row, best] < SAME:
            judged.append(False)
        else:
            left[:, best] = np.where(counts[best], -1.0, left[:, best])
            judged.append(True if counts[best] else None)
    return judged


def _count(table: np.ndarray, found: Detections, objects: KnownObjects) -> None:
    """Every object with the surest box on it, whatever class that says."""
    left, nothing = overlaps(found.boxes, objects.boxes), len(table) - 1
    owner = np.full(len(objects.boxes), nothing)
    for row in range(len(found.boxes)):
        best = int(np.argmax(left[row])) if len(objects.boxes) else -1
        if best < 0 or left[row, best] < SAME:
            table[nothing, found.classes[row]] += 1
            continue
        owner[best], left[:, best] = found.classes[row], -1.0
    for true, said, counts in zip(objects.classes, owner, objects.counts):
        if counts or said != nothing:
            table[true, said] += 1


def recall_and_precision(table: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """(classes,) each, of a DetectorScore's table."""
    right = np.diag(table)[:-1].astype(float)
    with np.errstate(invalid="ignore"):
        return right / table[:-1].sum(axis=1), right / table[:, :-1].sum(axis=0)
