# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Converts the scores of a map's photos to log likelihood ratios.

The ratio compares the hypotheses that an image was taken at the photo's place and at an unknown place.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp

from sextant.base.strict_params import StrictParams, param, within

MAD_TO_DEVIATION = 1.4826  # standard deviation over median absolute deviation (MAD), normal distribution
REFERENCE = 100  # number of best photos; their scores represent those of wrong photos
MIN_PHOTOS = 4  # smaller maps are treated as this size: their scores have no reliable deviation
ROUNDING = 1e-6  # of the largest score; smaller differences are rounding in single precision
MIN_DEVIATION = 0.1  # minimum deviation as a fraction of the median, in absolute evidence
MIN_SCORE = 1e-6  # lower scores are raised to it before the logarithm
MAX_Z = 30.0  # maximum z-score in absolute evidence
MAX_RELATIVE_Z = 6.0  # maximum z-score in relative evidence, for robustness against one wrong image


@dataclass(frozen=True)
class EvidenceParams(StrictParams):
    """Weights of the log likelihood ratio of a photo; `benchmark/places.py --only calibration` fits them.

    log ratio = deviation * z + score * ln(s) + size * ln(n) - offset, where s is the photo's score by votes,
    z is its deviations(), and n is the number of photos
    """

    deviation: float = param(0.313, "weight of z", within(0, 100))
    score: float = param(3.33, "weight of ln(s)", within(0, 100))
    size: float = param(3.40, "weight of ln(n)", within(0, 100))
    offset: float = param(11.9, "subtracted from the sum", within(-100, 100))
    limit: float = param(12.0, "maximum absolute log ratio of one image, not fitted", within(1e-6, 100))


def deviations(scores: np.ndarray, least: float = 0.0) -> np.ndarray:
    """Robust z-scores (n,): (score - median) / (1.4826 * median absolute deviation); 0 if all are equal.

    Median and deviation are those of the REFERENCE best photos. The deviation ignores scores that are equal
    to the median: otherwise it would be 0 if most photos had no votes.

    :param least: minimum deviation as a fraction of the median, for maps of few photos
    """
    reference = -np.sort(-scores)[:REFERENCE]
    centre = np.median(reference)
    residuals = np.abs(reference - centre)
    distinct = residuals[residuals > ROUNDING * np.abs(reference).max()]
    if not len(distinct):
        return np.zeros(len(scores))
    deviation = max(MAD_TO_DEVIATION * np.median(distinct), least * centre)
    return (scores - centre) / deviation


def score_features(scores: np.ndarray) -> np.ndarray:
    """Features (n, 3) of EvidenceParams: z, ln(s) and ln(n), each limited to its reliable range."""
    z = np.minimum(deviations(scores, MIN_DEVIATION), MAX_Z)
    logs = np.log(np.maximum(scores, MIN_SCORE))
    count = np.clip(len(scores), MIN_PHOTOS, REFERENCE)
    return np.stack([z, logs, np.full(len(scores), np.log(count))], axis=1)


def absolute_log_ratios(scores: np.ndarray, params: EvidenceParams) -> np.ndarray:
    """Log likelihood ratios (n,) of scores by votes; all are negative if no photo matches."""
    ratios = score_features(scores) @ (params.deviation, params.score, params.size) - params.offset
    excess = max(ratios.max() - params.limit, 0.0)  # shifts instead of clipping, to keep the differences
    return np.maximum(ratios - excess, -params.limit)


def relative_log_ratios(scores: np.ndarray, shift: float, shares: np.ndarray) -> np.ndarray:
    """Log likelihood ratios (n,) that compare photos with each other, but not with an unknown place.

    Assumes that scores are normally distributed, with a mean that is `shift` deviations higher for a correct
    photo. The mean likelihood ratio over the map is 1, so the evidence neither supports nor contradicts an
    unknown place.

    :param shares: (n,) weights of the photos in the mean; they sum to 1
    """
    z = np.clip(deviations(scores), -MAX_RELATIVE_Z, MAX_RELATIVE_Z)
    return shift * z - logsumexp(shift * z, b=shares)
