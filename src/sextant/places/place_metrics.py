# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Metrics of place recognition: precision, recall, and calibration of the probabilities."""

from typing import List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

BINS = 10  # of the reliability diagram
RESAMPLES, SEED = 2000, 1  # of frequencies under perfect calibration


class PrecisionRecall(NamedTuple):
    """Precision-recall curve over falling confidence thresholds."""

    precision: np.ndarray  # (n,) fraction of correct predictions above the threshold
    recall: np.ndarray  # (n,) correct predictions above the threshold over all queries that are in the map
    area: float  # below the curve


class ReliabilityBin(NamedTuple):
    """A bin of the reliability diagram."""

    probability: float  # mean predicted probability
    frequency: float  # fraction of correct predictions
    count: int  # predictions


def precision_recall(
    confidence: Sequence[float], correct: Sequence[bool], findable: Optional[int] = None
) -> PrecisionRecall:
    """Precision-recall curve of the best prediction of each query; equal confidences make one point.

    The area extends from recall 0 to the highest recall reached, so it is at most recall@1.

    :param confidence: of each prediction, at least one
    :param correct: whether each prediction is correct
    :param findable: number of queries that are in the map, above 0; default: the number of predictions
    """
    order = np.argsort(-np.asarray(confidence, float), kind="stable")
    sorted_confidence = np.asarray(confidence, float)[order]
    true_positives = np.cumsum(np.asarray(correct, bool)[order])
    last_of_tie = np.append(np.nonzero(np.diff(sorted_confidence))[0], len(order) - 1)
    precision = true_positives[last_of_tie] / (last_of_tie + 1)
    recall = true_positives[last_of_tie] / (findable or len(order))
    area = np.trapz(np.append(precision[0], precision), np.append(0.0, recall))
    return PrecisionRecall(precision, recall, float(area))


def reliability(probabilities: Sequence[float], correct: Sequence[bool]) -> List[ReliabilityBin]:
    """Reliability diagram of up to BINS bins of equal mass: their counts differ by at most one."""
    order = np.argsort(np.asarray(probabilities, float), kind="stable")
    parts = [part for part in np.array_split(order, BINS) if len(part)]
    p, y = np.asarray(probabilities, float), np.asarray(correct, float)
    return [ReliabilityBin(float(p[part].mean()), float(y[part].mean()), len(part)) for part in parts]


def calibration_error(probabilities: Sequence[float], correct: Sequence[bool]) -> float:
    """Expected calibration error over bins of equal mass (Nguyen, O'Connor 2015)."""
    bins = reliability(probabilities, correct)
    total = sum(each.count for each in bins)
    return sum(each.count / total * abs(each.probability - each.frequency) for each in bins)


def perfect_calibration_error(probabilities: Sequence[float]) -> float:
    """95 % quantile of calibration_error() if the probabilities were perfectly calibrated.

    It is above 0 because the number of predictions is finite.
    """
    frequencies = _perfect_frequencies(probabilities)
    bins = reliability(probabilities, np.zeros(len(probabilities)))
    weights = np.array([each.count for each in bins]) / len(probabilities)
    errors = np.abs(frequencies - [each.probability for each in bins]) @ weights
    return float(np.quantile(errors, 0.95))


def perfect_frequencies(probabilities: Sequence[float]) -> Tuple[np.ndarray, np.ndarray]:
    """Low and high end (bins,) of the 95 % interval of each bin's frequency under perfect calibration."""
    low, high = np.quantile(_perfect_frequencies(probabilities), [(1 - 0.95) / 2, (1 + 0.95) / 2], axis=0)
    return low, high


def _perfect_frequencies(probabilities: Sequence[float]) -> np.ndarray:
    """(RESAMPLES, bins) frequencies drawn from perfectly calibrated probabilities."""
    rng = np.random.default_rng(SEED)
    p = np.sort(np.asarray(probabilities, float))
    parts = [part for part in np.array_split(p, BINS) if len(part)]
    return np.column_stack([(rng.random((RESAMPLES, len(part))) < part).mean(axis=1) for part in parts])
