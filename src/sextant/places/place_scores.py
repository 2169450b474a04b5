# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Scores of all photos of a map for one image: with each photo, or with candidates of a large map."""

from typing import NamedTuple, Sequence

import numpy as np

from sextant.places.photo_keypoints import CodedKeypoints
from sextant.places.place_index import ComparedPhotos, PlaceIndex
from sextant.places.place_votes import lnbnn_scores, lnbnn_weights

CANDIDATES = 400  # photos of a large map with which an image is compared
NEIGHBOURS = 16  # nearest neighbours per descriptor that vote for candidates
COMPARED = 40  # photos of a map that are compared with the others
SEED = 1  # of their choice


class PhotoScores(NamedTuple):
    """Scores of photos for one image."""

    logs: np.ndarray  # (photos,) at least 0, sum of KeypointScores.logs; of no candidate: the least of them
    nearest: np.ndarray  # (n,) see KeypointScores, of the first kind of keypoints
    background: np.ndarray  # (n,) see KeypointScores, of the first kind of keypoints


def photo_scores(index: PlaceIndex, rows: np.ndarray, kinds: Sequence[CodedKeypoints]) -> PhotoScores:
    """Compares an image with photos.

    :param rows: int (photos,) of the photos in the index
    :param kinds: keypoints of the image, for each kind of the index
    """
    numbers = _candidates(index, rows, kinds[0]) if index.descriptors is not None else np.arange(len(rows))
    scored = [all_of.scores(image, rows[numbers]) for all_of, image in zip(index.keypoints, kinds)]
    of_candidates = np.sum([each.logs for each in scored], axis=0)
    logs = np.full(len(rows), of_candidates.min())
    logs[numbers] = of_candidates
    return PhotoScores(logs, scored[0].nearest, scored[0].background)


def _candidates(index: PlaceIndex, rows: np.ndarray, image: CodedKeypoints) -> np.ndarray:
    """Indices in rows of the photos with most votes of nearest neighbours, relative to their keypoints."""
    distances, image_ids, _ = index.descriptors.search(image.codes.astype(np.float32), NEIGHBOURS)
    numbers = index.numbers(rows)[image_ids]
    votes = lnbnn_scores(lnbnn_weights(distances, numbers), numbers, len(rows))
    keypoints = np.maximum(index.keypoints[0].counts[rows], 1)
    return np.sort(np.argsort(-votes / np.sqrt(keypoints), kind="stable")[:CANDIDATES])


def compared_photos(index: PlaceIndex) -> ComparedPhotos:
    """Compares some photos of an index with all others."""
    count = len(index.photos)
    chosen = np.sort(np.random.default_rng(SEED).permutation(count)[:COMPARED])
    scores = np.full((len(chosen), count), np.nan, np.float32)
    for number, row in enumerate(chosen):
        others = np.delete(np.arange(count), row)
        if len(others):
            kinds = [kind.of(row) for kind in index.keypoints]
            scores[number, others] = photo_scores(index, others, kinds).logs
    return ComparedPhotos(chosen, scores)
