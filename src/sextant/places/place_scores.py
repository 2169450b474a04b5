# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Scores of all photos of a map for one image: with each photo, or with candidates of a large map."""

from typing import NamedTuple, Optional, Sequence

import numpy as np

from sextant.places.photo_keypoints import CodedKeypoints
from sextant.places.place_index import SEARCHED, ComparedPhotos, PlaceIndex
from sextant.places.place_votes import lnbnn_scores, lnbnn_weights

CANDIDATES = 400  # photos of a large map with which an image is compared
VOTES = 16  # nearest neighbours per keypoint that vote for candidates
COMPARED = 40  # photos of a map that are compared with the others
SEED = 1  # of their choice


class ScoresByPhoto(NamedTuple):
    """Scores of photos for one image."""

    logs: np.ndarray  # (kinds, photos) see KeypointScores.logs, summed over the first kinds of keypoints
    nearest: np.ndarray  # (n,) see KeypointScores, of the first kind of keypoints
    background: np.ndarray  # (n,) see KeypointScores, of the first kind of keypoints

    @property
    def total(self) -> np.ndarray:
        """Scores (photos,) of all kinds of keypoints that the image has."""
        return self.logs[-1]


def photo_scores(
    index: PlaceIndex,
    rows: np.ndarray,
    kinds: Sequence[CodedKeypoints],
    region: Optional[np.ndarray] = None,
) -> ScoresByPhoto:
    """Compares an image with photos; kinds of which it has no keypoints are left out.

    :param rows: int (photos,) of the photos in the index
    :param kinds: keypoints of the image, for each kind of the index
    :param region: int (m,) indices in rows of photos among which there are candidates of their own
    """
    numbers = np.arange(len(rows))
    if index.descriptors is not None:
        numbers = _candidates(index, rows, kinds[0], region)
    there = [number for number, each in enumerate(kinds) if not number or len(each.codes)]
    scored = [index.keypoints[number].scores(kinds[number], rows[numbers]) for number in there]
    of_candidates = np.cumsum([each.logs for each in scored], axis=0)
    is_empty = index.keypoints[0].counts[rows[numbers]] == 0
    least = of_candidates.min(axis=1, keepdims=True)
    logs = np.repeat(least, len(rows), axis=1)  # of photos that are no candidates, or have no keypoints
    logs[:, numbers] = np.where(is_empty, least, of_candidates)
    return ScoresByPhoto(logs, scored[0].nearest, scored[0].background)


def _candidates(
    index: PlaceIndex, rows: np.ndarray, image: CodedKeypoints, region: Optional[np.ndarray]
) -> np.ndarray:
    """Indices in rows of the photos with most votes of nearest neighbours, relative to their keypoints."""
    distances, image_ids, _ = index.descriptors.search(image.codes.astype(np.float32), VOTES)
    numbers = index.numbers(rows)[image_ids]
    votes = lnbnn_scores(lnbnn_weights(distances, numbers), numbers, len(rows))
    keypoints = np.clip(index.keypoints[0].counts[rows], 1, SEARCHED)
    order = np.argsort(-votes / np.sqrt(keypoints), kind="stable")
    best = order[:CANDIDATES]
    if region is not None:
        best = np.union1d(best, order[np.isin(order, region)][:CANDIDATES])
    return np.sort(best)


def compared_photos(index: PlaceIndex) -> ComparedPhotos:
    """Compares some photos of an index, with keypoints of all kinds if there are such, with all others."""
    count, kinds = len(index.photos), index.keypoints
    is_complete = np.all([kind.counts > 0 for kind in kinds], axis=0)
    complete = np.flatnonzero(is_complete if is_complete.any() else kinds[0].counts > 0)
    chosen = np.sort(np.random.default_rng(SEED).permutation(complete)[:COMPARED])
    scores = np.full((len(kinds), len(chosen), count), np.nan, np.float32)
    for number, row in enumerate(chosen):
        others = np.delete(np.arange(count), row)
        if len(others):
            logs = photo_scores(index, others, [kind.of(row) for kind in kinds]).logs
            scores[: len(logs), number, others] = logs
    return ComparedPhotos(chosen, scores)
