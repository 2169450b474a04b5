# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What scores of a map's photos are worth as evidence: logs of likelihood ratios.

The ratio is between a picture that was taken where the photo was, and one taken where the map knows nothing.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp

from sextant.base.strict_params import StrictParams, param, within

MAD_TO_DEVIATION = 1.4826  # of a normal distribution
REFERENCE = 100  # best photos that tell how much the scores of wrong ones differ
FEW = 4  # photos that fewer count as: they have no deviations to speak of, and take votes that others would
ROUNDING = 1e-6  # of the largest score: what single precision leaves
LEAST_DEVIATION = 0.1  # of the median, in absolute evidence
LEAST_SCORE = 1e-6
HIGHEST = 30.0  # deviations, in absolute evidence; more say no more
HIGHEST_RELATIVE = 6.0  # in relative evidence, which has to bear that one picture is wrong


@dataclass(frozen=True)
class EvidenceParams(StrictParams):
    """How scores by votes become evidence; `benchmark/places.py --only calibration` fits the first four.

    log ratio = deviation * z + score * ln(s) + size * ln(n) - offset; score s, its deviations() z, n photos
    """

    deviation: float = param(0.313, within(0, 100))
    score: float = param(3.33, within(0, 100))
    size: float = param(3.40, within(0, 100))
    offset: float = param(11.9, within(-100, 100))
    limit: float = param(12.0, within(1e-6, 100))  # of a log ratio: more is never believed of one picture


def deviations(scores: np.ndarray, least: float = 0.0) -> np.ndarray:
    """(n,) how far each score is above the median, in 1.4826 median absolute deviations; 0: all are the same.

    Of a large map only the best photos tell what a wrong one scores. Those that equal the median do not count
    in the deviation: with most photos out of reach of any vote it would be 0.

    :param least: deviation, as part of the median: what few photos say by chance is not trusted beyond it
    """
    best = -np.sort(-scores)[:REFERENCE]
    centre = np.median(best)
    away = np.abs(best - centre)
    apart = away[away > ROUNDING * np.abs(best).max()]
    if not len(apart):
        return np.zeros(len(scores))
    deviation = max(MAD_TO_DEVIATION * np.median(apart), least * centre)
    return (scores - centre) / deviation


def score_features(scores: np.ndarray) -> np.ndarray:
    """(n, 3) z, ln(s) and ln(n) of EvidenceParams, within what can be trusted."""
    z = np.minimum(deviations(scores, LEAST_DEVIATION), HIGHEST)
    logs = np.log(np.maximum(scores, LEAST_SCORE))
    count = np.clip(len(scores), FEW, REFERENCE)
    return np.stack([z, logs, np.full(len(scores), np.log(count))], axis=1)


def absolute_log_ratios(scores: np.ndarray, params: EvidenceParams) -> np.ndarray:
    """(n,) of the scores by votes. A picture can speak against all photos."""
    ratios = score_features(scores) @ (params.deviation, params.score, params.size) - params.offset
    excess = max(ratios.max() - params.limit, 0.0)  # so that good photos differ still
    return np.maximum(ratios - excess, -params.limit)


def relative_log_ratios(scores: np.ndarray, shift: float, shares: np.ndarray) -> np.ndarray:
    """(n,) of scores of which a right photo's is `shift` deviations higher, with normal noise.

    A picture says which photos are likelier than others, and nothing of whether it is any of them: nowhere it
    is as likely as it is in the map on the mean, which is 1.

    :param shares: (n,) of the photos in the mean; they sum to 1
    """
    z = np.clip(deviations(scores), -HIGHEST_RELATIVE, HIGHEST_RELATIVE)
    return shift * z - logsumexp(shift * z, b=shares)
