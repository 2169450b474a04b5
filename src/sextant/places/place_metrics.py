# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""How good a recognition is: recall, precision, and whether its probabilities mean what they say."""

from typing import List, NamedTuple, Sequence

import numpy as np

RESAMPLES = 2000
SEED = 1


class PrecisionRecall(NamedTuple):
    """Of answers in the order of their confidence: how many are right, and how many of all are found."""

    precision: np.ndarray
    recall: np.ndarray  # of all queries that have a right answer
    area: float


class ReliabilityBin(NamedTuple):
    probability: float  # mean of what was said
    frequency: float  # of what was right
    count: int


def recall_at(n: int, ranks: Sequence[float]) -> float:
    """Share of queries whose first right answer is among the n best.

    :param ranks: of the first right answer of each query, from 1 on; inf: there is none
    """
    return float(np.mean(np.asarray(ranks) <= n))


def precision_recall(confidence: Sequence[float], right: Sequence[bool]) -> PrecisionRecall:
    """Of the best answer of each query. Equal confidences are let through together.

    The area is that below the curve from recall 0 to the last recall reached: never above recall@1.
    """
    order = np.argsort(-np.asarray(confidence, float), kind="stable")
    sorted_confidence = np.asarray(confidence, float)[order]
    found = np.cumsum(np.asarray(right, bool)[order])
    last_of_tie = np.append(np.nonzero(np.diff(sorted_confidence))[0], len(order) - 1)
    precision = found[last_of_tie] / (last_of_tie + 1)
    recall = found[last_of_tie] / len(order)
    area = np.trapz(np.append(precision[0], precision), np.append(0.0, recall))
    return PrecisionRecall(precision, recall, float(area))


def reliability(
    probabilities: Sequence[float], right: Sequence[bool], bins: int = 10
) -> List[ReliabilityBin]:
    """Bins of equal mass: as many queries in each, up to one."""
    order = np.argsort(np.asarray(probabilities, float), kind="stable")
    parts = [part for part in np.array_split(order, bins) if len(part)]
    p, y = np.asarray(probabilities, float), np.asarray(right, float)
    return [ReliabilityBin(float(p[part].mean()), float(y[part].mean()), len(part)) for part in parts]


def calibration_error(probabilities: Sequence[float], right: Sequence[bool], bins: int = 10) -> float:
    """Expected calibration error over bins of equal mass (Nguyen, O'Connor 2015)."""
    found = reliability(probabilities, right, bins)
    total = sum(each.count for each in found)
    return sum(each.count / total * abs(each.probability - each.frequency) for each in found)


def perfect_calibration_error(
    probabilities: Sequence[float], bins: int = 10, quantile: float = 0.95
) -> float:
    """What calibration_error() would be at most, in that share of cases, if the probabilities were true.

    Even then it is not 0: a finite number of answers is right now more, now less often than it should.
    """
    p = np.asarray(probabilities, float)
    rng = np.random.default_rng(SEED)
    errors = [calibration_error(p, rng.random(len(p)) < p, bins) for _ in range(RESAMPLES)]
    return float(np.quantile(errors, quantile))
