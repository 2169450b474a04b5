# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which photos of a map the neighbours of a picture's descriptors speak for.

Neighbours come from sextant.DescriptorIndex: distances and owners, each (n, k), nearest first; an owner is a
photo's place in the list of all, -1 where there is no neighbour; its distance is infinite then.
"""

from typing import NamedTuple

import numpy as np


class MatchStatistics(NamedTuple):
    """Of the nearest neighbours, as the mode `votes` prunes them."""

    keypoints: int
    matches: int  # with a neighbour
    kept: int  # not farther than the mean
    minimum: float  # distances
    mean: float
    maximum: float
    total: float


class VoteCount(NamedTuple):
    """Photos with their shares of the votes, best first."""

    photos: np.ndarray  # int (m,); empty: there were too few votes
    probabilities: np.ndarray  # (m,)


def match_statistics(distances: np.ndarray, owners: np.ndarray) -> MatchStatistics:
    """Of the first neighbours; all distances are 0 where there is none at all."""
    found = distances[owners[:, 0] >= 0, 0] if len(distances) else np.zeros(0)
    if not len(found):
        return MatchStatistics(len(distances), 0, 0, 0.0, 0.0, 0.0, 0.0)
    mean = _mean(found)
    return MatchStatistics(
        len(distances),
        len(found),
        int(np.sum(found <= mean)),
        float(found.min()),
        mean,
        float(found.max()),
        float(found.sum()),
    )


def kept_matches(distances: np.ndarray, owners: np.ndarray) -> np.ndarray:
    """bool (n, k): nearest neighbours that are not farther than their mean."""
    there = owners >= 0
    there[:, 1:] = False
    return there & (distances <= _mean(distances[there])) if there.any() else there


def _mean(distances: np.ndarray) -> float:
    """In single precision that of equal ones can be less than each of them."""
    return float(np.mean(distances, dtype=np.float64))


def count_votes(distances: np.ndarray, owners: np.ndarray, min_matches: int, max_photos: int) -> VoteCount:
    """One vote a descriptor, for the owner of its nearest neighbour, if that is not farther than the mean.

    :param min_matches: with fewer votes, none counts
    """
    votes = owners[kept_matches(distances, owners)]
    if len(votes) < min_matches:
        return VoteCount(np.zeros(0, int), np.zeros(0))
    photos, counts = np.unique(votes, return_counts=True)
    best = np.argsort(-counts, kind="stable")[:max_photos]
    return VoteCount(photos[best], counts[best] / len(votes))


def lnbnn_weights(distances: np.ndarray, owners: np.ndarray) -> np.ndarray:
    """By what part each neighbour is nearer than the last one, which stands for everywhere else; (n, k).

    Local naive Bayes nearest neighbour: S. McCann, D. Lowe, CVPR 2012. Of several neighbours of one owner
    only the nearest counts.
    """
    there = owners >= 0
    last = np.max(distances, axis=1, where=there, initial=0.0, keepdims=True)
    weights = np.where(there, 1 - distances / np.maximum(last, np.finfo(np.float32).tiny), 0.0)
    rows = np.repeat(np.arange(len(owners)), owners.shape[1])
    pairs = rows * (int(owners.max(initial=0)) + 2) + owners.ravel() + 1
    _, first = np.unique(pairs, return_index=True)
    nearest = np.zeros(owners.size, bool)
    nearest[first] = True
    return np.where(nearest.reshape(owners.shape), weights, 0.0)


def lnbnn_scores(
    weights: np.ndarray, owners: np.ndarray, descriptor_counts: np.ndarray, exponent: float
) -> np.ndarray:
    """A score of every photo; the sum of its lnbnn_weights() over a power of its number of descriptors.

    :param descriptor_counts: (photos,): photos rich in keypoints attract neighbours of everything
    :param exponent: 0: they may; 0.5 is the usual cure
    """
    there = owners >= 0
    sums = np.bincount(owners[there], weights[there], minlength=len(descriptor_counts))
    return sums / np.maximum(descriptor_counts, 1) ** exponent
