# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Votes of an image's descriptors for the photos of a map.

The k nearest neighbours of n descriptors are passed as distances and image_ids, each (n, k), nearest first.
An image_id is the number of a photo as in PlaceIndex.numbers(), or -1 if there is none.
"""

from typing import NamedTuple, Tuple

import numpy as np


class MatchStatistics(NamedTuple):
    """Statistics of the nearest neighbours."""

    keypoints: int  # number in the image
    matches: int  # keypoints whose nearest neighbour is in the map
    kept: int  # matches whose distance is at most the mean
    minimum: float  # distance
    mean: float  # distance
    maximum: float  # distance
    total: float  # sum of the distances


def match_statistics(distances: np.ndarray, is_match: np.ndarray) -> MatchStatistics:
    """Statistics of the nearest neighbours; all distances are 0 if there is no match.

    :param distances: (n,) from the nearest neighbour
    :param is_match: bool (n,) whether there is one, in the map
    """
    found = distances[is_match]
    if not len(found):
        return MatchStatistics(len(distances), 0, 0, 0.0, 0.0, 0.0, 0.0)
    mean = _mean(found)
    total, kept = float(found.sum()), int(np.sum(found <= mean))
    return MatchStatistics(
        len(distances), len(found), kept, float(found.min()), mean, float(found.max()), total
    )


def kept_matches(distances: np.ndarray, image_ids: np.ndarray) -> np.ndarray:
    """Mask (n, k) of the nearest neighbours within their mean distance."""
    valid = image_ids >= 0
    valid[:, 1:] = False
    return valid & (distances <= _mean(distances[valid])) if valid.any() else valid


def _mean(distances: np.ndarray) -> float:
    """The mean in double precision: in single precision that of equal values can be smaller than each."""
    return float(np.mean(distances, dtype=np.float64))


def count_votes(
    distances: np.ndarray, image_ids: np.ndarray, min_matches: int, max_photos: int
) -> Tuple[np.ndarray, np.ndarray]:
    """Each descriptor votes for the photo of its nearest neighbour if their distance is at most the mean.

    :param min_matches: minimum number of votes; with fewer votes the result is empty
    :param max_photos: maximum number of photos returned
    :returns: photos, int (m,), and their shares of the votes (m,), in descending order
    """
    votes = image_ids[kept_matches(distances, image_ids)]
    if len(votes) < min_matches:
        return np.zeros(0, int), np.zeros(0)
    photos, counts = np.unique(votes, return_counts=True)
    best = np.argsort(-counts, kind="stable")[:max_photos]
    return photos[best], counts[best] / len(votes)


def lnbnn_weights(distances: np.ndarray, image_ids: np.ndarray) -> np.ndarray:
    """Local naive Bayes nearest neighbour weights (n, k): S. McCann, D. Lowe, CVPR 2012.

    The weight is 1 - distance / distance of the last neighbour, which represents the background. Of several
    neighbours in one photo only the nearest counts.
    """
    valid = image_ids >= 0
    background = np.max(distances, axis=1, where=valid, initial=0.0, keepdims=True)
    tiny = np.finfo(np.float32).tiny
    ratios = np.divide(distances, np.maximum(background, tiny), np.ones_like(distances), where=valid)
    weights = 1 - ratios
    rows = np.repeat(np.arange(len(image_ids)), image_ids.shape[1])
    pairs = rows * (int(image_ids.max(initial=0)) + 2) + image_ids.ravel() + 1
    _, first = np.unique(pairs, return_index=True)  # the nearest neighbour of each descriptor and photo
    nearest = np.zeros(image_ids.size, bool)
    nearest[first] = True
    return np.where(nearest.reshape(image_ids.shape), weights, 0.0)


def lnbnn_scores(weights: np.ndarray, image_ids: np.ndarray, photos: int) -> np.ndarray:
    """Score (photos,) of each photo: the sum of its lnbnn_weights()."""
    valid = image_ids >= 0
    return np.bincount(image_ids[valid], weights[valid], minlength=photos)
