# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""How good a recognition is: recall, precision, and whether its probabilities mean what they say."""

from typing import List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

BINS, RESAMPLES = 10, 2000
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


def precision_recall(
    confidence: Sequence[float], right: Sequence[bool], findable: Optional[int] = None
) -> PrecisionRecall:
    """Of the best answer of each query. Equal confidences are let through together.

    The area is that below the curve from recall 0 to the last recall reached: never above recall@1.

    :param confidence: of one answer or more
    :param findable: queries that have a right answer, above 0; by default all that were answered
    """
    order = np.argsort(-np.asarray(confidence, float), kind="stable")
    sorted_confidence = np.asarray(confidence, float)[order]
    found = np.cumsum(np.asarray(right, bool)[order])
    last_of_tie = np.append(np.nonzero(np.diff(sorted_confidence))[0], len(order) - 1)
    precision = found[last_of_tie] / (last_of_tie + 1)
    recall = found[last_of_tie] / (findable or len(order))
    area = np.trapz(np.append(precision[0], precision), np.append(0.0, recall))
    return PrecisionRecall(precision, recall, float(area))


def reliability(probabilities: Sequence[float], right: Sequence[bool]) -> List[ReliabilityBin]:
    """BINS of equal mass: as many queries in each, up to one."""
    order = np.argsort(np.asarray(probabilities, float), kind="stable")
    parts = [part for part in np.array_split(order, BINS) if len(part)]
    p, y = np.asarray(probabilities, float), np.asarray(right, float)
    return [ReliabilityBin(float(p[part].mean()), float(y[part].mean()), len(part)) for part in parts]


def calibration_error(probabilities: Sequence[float], right: Sequence[bool]) -> float:
    """Expected calibration error over bins of equal mass (Nguyen, O'Connor 2015)."""
    found = reliability(probabilities, right)
    total = sum(each.count for each in found)
    return sum(each.count / total * abs(each.probability - each.frequency) for each in found)


def perfect_calibration_error(probabilities: Sequence[float]) -> float:
    """What calibration_error() would be at most, in 95 % of cases, if the probabilities were true.

    Even then it is not 0: a finite number of answers is right now more, now less often than it should.
    """
    frequencies = _perfect_frequencies(probabilities)
    said = reliability(probabilities, np.zeros(len(probabilities)))
    weights = np.array([each.count for each in said]) / len(probabilities)
    errors = np.abs(frequencies - [each.probability for each in said]) @ weights
    return float(np.quantile(errors, 0.95))


def perfect_frequencies(probabilities: Sequence[float]) -> Tuple[np.ndarray, np.ndarray]:
    """Between which frequencies, low and high, each bin of reliability() lies in 95 % of cases, if the
    probabilities were true.
    """
    low, high = np.quantile(_perfect_frequencies(probabilities), [(1 - 0.95) / 2, (1 + 0.95) / 2], axis=0)
    return low, high


def _perfect_frequencies(probabilities: Sequence[float]) -> np.ndarray:
    """(RESAMPLES, bins of reliability()): of answers that are right as often as their probabilities say."""
    rng = np.random.default_rng(SEED)
    p = np.sort(np.asarray(probabilities, float))
    parts = [part for part in np.array_split(p, BINS) if len(part)]
    return np.column_stack([(rng.random((RESAMPLES, len(part))) < part).mean(axis=1) for part in parts])
