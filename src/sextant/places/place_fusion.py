# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What votes of keypoints and a global descriptor say together of the photos of a map.

Both are brought to one scale, in which most photos, which are wrong, have the mean 0 and the deviation 1.
There, with noise that is independent, evidence adds up.
"""

import numpy as np

MAD_TO_DEVIATION = 1.4826  # of a normal distribution
ROUNDING = 1e-6  # of the largest score: what single precision leaves


def deviations(scores: np.ndarray) -> np.ndarray:
    """(n,) how far each score is above the median, in 1.4826 median absolute deviations; 0: all are the same.

    Scores that equal the median do not count in the deviation: with most photos of a large map out of reach
    of any vote it would be 0, and how far the others differ among themselves is what can be known.
    """
    away = scores - np.median(scores)
    apart = np.abs(away)[np.abs(away) > ROUNDING * np.abs(scores).max()]
    if not len(apart):
        return np.zeros(len(scores))
    return away / (MAD_TO_DEVIATION * np.median(apart))


def fused_scores(votes: np.ndarray, similarities: np.ndarray, weight: float) -> np.ndarray:
    """(n,) sums of deviations. Who says the same of all photos says nothing, and the other decides alone.

    :param votes: (n,) scores by keypoints; larger is better, as in the others
    :param similarities: (n,) cosines
    :param weight: of the similarities
    """
    return deviations(votes) + weight * deviations(similarities)
