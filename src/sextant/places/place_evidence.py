# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Converts the scores of a map's photos to log likelihood ratios.

The ratio compares the hypotheses that an image was taken at the photo's place and at an unknown place.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.special import logsumexp

from sextant.base.strict_params import StrictParams, param, within

MAD_TO_DEVIATION = 1.4826  # standard deviation over median absolute deviation (MAD), normal distribution
REFERENCE = 100  # number of best photos; their scores represent those of wrong photos
ROUNDING = 1e-6  # of the largest score; smaller differences are rounding in single precision
MIN_DEVIATION = 0.3  # minimum deviation of UnknownPlaces: that of few photos is not reliable
FEW_PLACES = (1.0, 0.5)  # UnknownPlaces of a map without photos to compare; those of a few spots of a campus
UNRELATED = 8.0  # score of unrelated photos in a map of one place, for each kind of keypoints
MAX_Z = 6.0  # maximum z-score in relative evidence, for robustness against one wrong image


@dataclass(frozen=True)
class EvidenceParams(StrictParams):
    """Weights of the evidence; `benchmark/places.py --only calibration` fits them.

    The log odds that an image was taken at a place of the map are margin * m + excess * z - offset: m is the
    highest score minus that of the best photo elsewhere, z is the excess over the scores of unknown places,
    see image_features(). Among the photos, the likelihood is exp(slope * score).
    """

    slope: float = param(1.2, "logarithm of the likelihood ratio of two photos per score", within(0, 100))
    margin: float = param(0.5, "weight of m", within(0, 100))
    excess: float = param(0.5, "weight of z", within(0, 100))
    offset: float = param(1.5, "subtracted from the sum", within(-100, 100))
    limit: float = param(12.0, "maximum absolute log odds of one image, not fitted", within(1e-6, 100))


class UnknownPlaces(NamedTuple):
    """Distribution of the highest score minus the median of all, for images of unknown places."""

    mean: float  # over images
    deviation: float  # standard deviation over images

    @classmethod
    def of_map(cls, scores: np.ndarray, is_near: np.ndarray) -> "UnknownPlaces":
        """Estimates it from photos of the map, each compared with those that are not near it.

        In a map of look-alike places these scores are high.

        :param scores: (m, n) of n photos for m of them; nan: the photo itself
        :param is_near: bool (m, n) whether each photo is near the other, or is the same
        """
        highest = np.max(scores, axis=1, where=~(is_near | np.isnan(scores)), initial=-np.inf)
        compared = np.isfinite(highest)
        if not compared.any():
            return cls(*FEW_PLACES)
        excess = highest[compared] - np.nanmedian(scores[compared], axis=1)
        return cls(float(excess.mean()), max(float(excess.std()), MIN_DEVIATION))


def image_features(
    scores: np.ndarray, is_near: np.ndarray, unknown: UnknownPlaces, kinds: int = 1
) -> np.ndarray:
    """Features (2,) of EvidenceParams, m and z, of an image.

    :param scores: (n,) of the photos
    :param is_near: bool (n,) whether each photo is near the best one, or is the same
    :param kinds: number of kinds of keypoints in the scores
    """
    elsewhere = middle = UNRELATED * kinds
    if not is_near.all():
        elsewhere, middle = scores[~is_near].max(), np.median(scores)
    highest = scores.max()
    return np.array([highest - elsewhere, (highest - middle - unknown.mean) / unknown.deviation])


def absolute_log_ratios(
    scores: np.ndarray, features: np.ndarray, shares: np.ndarray, params: EvidenceParams
) -> np.ndarray:
    """Log likelihood ratios (n,) of photos against an unknown place.

    Their weighted mean is the odds that the image was taken at a place of the map.

    :param scores: (n,) of the photos
    :param features: (2,) see image_features()
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
