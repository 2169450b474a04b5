# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Converts the scores of a map's photos to log likelihood ratios.

The ratio compares the hypotheses that an image was taken at the photo's place and at an unknown place.
"""

from dataclasses import dataclass
from typing import Callable, NamedTuple, Optional, Tuple

import numpy as np
from scipy.special import logsumexp

from sextant.base.strict_params import StrictParams, param, within

MAD_TO_DEVIATION = 1.4826  # standard deviation over median absolute deviation (MAD), normal distribution
REFERENCE = 100  # number of best photos; their scores represent those of wrong photos
ROUNDING = 1e-6  # of the largest score; smaller differences are rounding in single precision
MIN_DEVIATIONS = (0.15, 0.3)  # of UnknownPlaces: those of few photos are not reliable
MIN_COMPARED = 10  # photos from which UnknownPlaces is estimated
UNRELATED = 8.0  # score of unrelated photos in a map of one place, for each kind of keypoints
MAX_Z = 6.0  # maximum z-score in relative evidence, for robustness against one wrong image

Near = Callable[[np.ndarray], np.ndarray]  # see UnknownPlaces.of_map()


@dataclass(frozen=True)
class EvidenceParams(StrictParams):
    """Weights of the evidence; `benchmark/places.py --only calibration` fits them.

    The log odds that an image was taken at a place of the map are margin * m + excess * e - offset, see
    UnknownPlaces.features(). Among the photos, the likelihood is exp(slope * score).
    """

    slope: float = param(1.88, "logarithm of the likelihood ratio of two photos per score", within(0, 100))
    margin: float = param(1.16, "weight of m", within(0, 100))
    excess: float = param(0.63, "weight of e", within(0, 100))
    offset: float = param(0.94, "subtracted from the sum", within(-100, 100))
    limit: float = param(12.0, "maximum absolute log odds of one image, not fitted", within(1e-6, 100))


def score_differences(scores: np.ndarray, is_near: np.ndarray) -> np.ndarray:
    """Margin and excess (2,) of the highest score: over the best photo elsewhere, and over the median.

    :param scores: (n,) of the photos
    :param is_near: bool (n,) whether each photo is near the best one, or is the same; not all of them
    """
    highest = scores.max()
    return np.array([highest - scores[~is_near].max(), highest - np.median(scores)])


class UnknownPlaces(NamedTuple):
    """Distribution of score_differences() for images of unknown places.

    In a map of places that look alike they are large, on a campus they are small.
    """

    mean: Tuple[float, float] = (1.0, 1.0)  # over images; defaults: of maps of a few places
    deviation: Tuple[float, float] = (0.5, 0.5)  # standard deviation over images

    @classmethod
    def of_map(cls, scores: np.ndarray, numbers: np.ndarray, near: Near) -> Optional["UnknownPlaces"]:
        """Estimates it from photos of the map, each compared with those that are not near it.

        Returns None for less than MIN_COMPARED of them.

        :param scores: (m, n) of n photos for m of them; nan: the photo itself
        :param numbers: int (m,) of these m photos
        :param near: whether photos (n,) are near each of some numbers (k,): bool (k, n)
        """
        differences = []
        for row, is_near in zip(scores, near(numbers)):
            others = np.flatnonzero(~(is_near | np.isnan(row)))
            if len(others):
                beside = near(others[[row[others].argmax()]])[0, others]
                if not beside.all():
                    differences.append(score_differences(row[others], beside))
        if len(differences) < MIN_COMPARED:
            return None
        deviation = np.maximum(np.std(differences, axis=0), MIN_DEVIATIONS)
        return cls(tuple(np.mean(differences, axis=0)), tuple(deviation))

    def features(self, scores: np.ndarray, is_near: np.ndarray, kinds: int = 1) -> np.ndarray:
        """Features (2,) of EvidenceParams of an image, m and e: `sign(z) ln(1 + |z|)` of standard scores z.

        :param scores: (n,) of the photos
        :param is_near: bool (n,) whether each photo is near the best one, or is the same
        :param kinds: number of kinds of keypoints in the scores
        """
        if is_near.all():
            scores, is_near = np.append(scores, UNRELATED * kinds), np.append(is_near, False)
        z = (score_differences(scores, is_near) - self.mean) / np.array(self.deviation)
        return np.sign(z) * np.log1p(np.abs(z))


def absolute_log_ratios(
    scores: np.ndarray, features: np.ndarray, shares: np.ndarray, params: EvidenceParams
) -> np.ndarray:
    """Log likelihood ratios (n,) of photos against an unknown place.

    Their weighted mean is the odds that the image was taken at a place of the map.

    :param scores: (n,) of the photos
    :param features: (2,) see UnknownPlaces.features()
    :param shares: (n,) weights of the photos; they sum to 1
    """
    odds = features @ (params.margin, params.excess) - params.offset
    return np.clip(odds, -params.limit, params.limit) + _normalized(params.slope * scores, shares)


def deviations(scores: np.ndarray) -> np.ndarray:
    """Robust z-scores (n,): (score - median) / (1.4826 * median absolute deviation); 0 if all are equal.

    Median and deviation are those of the REFERENCE best photos. The deviation ignores scores that are equal
    to the median: otherwise it would be 0 if most photos were equally similar.
    """
    reference = -np.sort(-scores)[:REFERENCE]
    centre = np.median(reference)
    residuals = np.abs(reference - centre)
    distinct = residuals[residuals > ROUNDING * np.abs(reference).max()]
    if not len(distinct):
        return np.zeros(len(scores))
    return (scores - centre) / (MAD_TO_DEVIATION * np.median(distinct))


def relative_log_ratios(scores: np.ndarray, shift: float, shares: np.ndarray) -> np.ndarray:
    """Log likelihood ratios (n,) that compare photos with each other, but not with an unknown place.

    Assumes that scores are normally distributed, with a mean that is `shift` deviations higher for a correct
    photo. The mean likelihood ratio over the map is 1, so the evidence neither supports nor contradicts an
    unknown place.

    :param shares: (n,) weights of the photos in the mean; they sum to 1
    """
    return _normalized(shift * np.clip(deviations(scores), -MAX_Z, MAX_Z), shares)


def _normalized(logs: np.ndarray, shares: np.ndarray) -> np.ndarray:
    """Logarithms whose exponentials have the weighted mean 1."""
    return logs - logsumexp(logs, b=shares)
