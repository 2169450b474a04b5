# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which places of a map a picture may show: votes of descriptors, their arrangement, what both are worth."""

from dataclasses import dataclass
from typing import List, NamedTuple, Optional

import cv2
import numpy as np

import sextant
from sextant.base.strict_params import StrictParams, nested, param, within
from sextant.place_maps.place_map import Photo, PlaceMap
from sextant.places.global_descriptor import GlobalDescriptor
from sextant.places.place_evidence import EvidenceParams, absolute_log_ratios, relative_log_ratios
from sextant.places.place_index import PlaceIndex
from sextant.places.place_matches import MapPhotos, MatchedPhoto, Matches
from sextant.places.place_verification import displacement_support
from sextant.places.place_votes import MatchStatistics, lnbnn_scores, lnbnn_weights, match_statistics

CELLS = 8  # a side, of contrast()
LEAST = 500.0  # below the largest log ratio: that its exponential is not 0


@dataclass(frozen=True)
class RecognitionParams(StrictParams):
    """How votes become scores, and scores evidence."""

    neighbours: int = param(16, within(2, 128))  # of a descriptor; the last stands for everywhere else
    hub_exponent: float = param(0.5, within(0, 1))  # of the descriptors' number that votes are divided by
    arrangement: float = param(2.0, within(0, 100))  # weight of the votes that agree in their displacement
    min_keypoints: int = param(10, within(1, 100000))  # a picture with fewer says nothing by votes
    min_contrast: float = param(0.5, within(0, 128))  # of contrast(); with less the vector is not used
    evidence: EvidenceParams = nested(EvidenceParams)
    network_weight: float = param(1.0, within(0, 100))  # deviations that a right photo is nearer; 0: unused


class Recognition(NamedTuple):
    """Of one picture, place by place in the order of PlaceMap.places()."""

    scores: np.ndarray  # (places,) by votes; above 0, larger is better
    log_ratios: np.ndarray  # (places,) log of how much likelier there than where nothing is known
    best_photos: List[Photo]  # (places,) which photo of each place is likeliest
    usable: bool  # whether the picture shows enough to say anything
    voted: bool  # whether it has votes; else it can only tell places apart
    statistics: MatchStatistics
    match: MatchedPhoto  # of the likeliest photo of all


def contrast(image: np.ndarray) -> float:
    """How much a picture's parts differ: the standard deviation of the means of 8x8 cells, in grey levels.

    A camera's noise vanishes in the means; what makes a scene does not, in the dark, in fog, or out of focus.

    :param image: uint8, (height, width) grey or (height, width, 3) BGR; the channel with most of it counts
    """
    cells = cv2.resize(image.astype(np.float32), (CELLS, CELLS), interpolation=cv2.INTER_AREA)
    return float(cells.reshape(CELLS * CELLS, -1).std(axis=0).max())


class PlaceRecognizer:
    """Recognizes pictures with a map and the index of its photos. Not thread-safe."""

    def __init__(self, place_map: PlaceMap, index: PlaceIndex, params: Optional[RecognitionParams] = None):
        """:raises ValueError: a parameter out of range, or a photo that is not in the index"""
        self._params, self._index = params or RecognitionParams(), index
        self._extractor = sextant.FeatureExtractor(index.params.feature_params())
        self._photos = MapPhotos(place_map, index)
        network = index.params.global_descriptor
        self._descriptor = GlobalDescriptor(network) if network and self._params.network_weight else None

    def recognize(self, image: np.ndarray) -> Recognition:
        """:param image: uint8, (height, width) grey or (height, width, 3) BGR"""
        features = self._extractor.extract(image)
        search = self._index.descriptors.search
        distances, owners, rows = search(features.descriptors, self._params.neighbours)
        numbers = self._photos.numbers(owners)
        picture_xy = features.keypoints[:, :2] / max(features.size)
        matches = Matches(picture_xy, numbers, rows, lnbnn_weights(distances, numbers))
        scores, voted = self._scores(matches), len(picture_xy) >= self._params.min_keypoints
        ratios = absolute_log_ratios(scores, self._params.evidence) if voted else np.zeros(len(scores))
        described = self._descriptor is not None and contrast(image) >= self._params.min_contrast
        if described:
            ratios = ratios + self._told_apart(image)
        order = np.lexsort((scores, ratios))
        best = self._best(order)
        return Recognition(
            scores[best], self._of_places(ratios), [self._photos.photos[number] for number in best],
            voted or described, voted, match_statistics(distances, numbers),
            self._photos.match(matches, int(order[-1])),
        )  # fmt: skip

    def _told_apart(self, image: np.ndarray) -> np.ndarray:
        """(photos,) log ratios by vectors of whole pictures."""
        similarities = (self._index.vectors @ self._descriptor.describe(image))[self._photos.rows]
        return relative_log_ratios(similarities, self._params.network_weight, self._photos.shares)

    def _scores(self, matches: Matches) -> np.ndarray:
        """(photos,) by votes, and by those that agree in their displacement."""
        exponent, counts = self._params.hub_exponent, self._photos.counts
        scores = lnbnn_scores(matches.weights, matches.numbers, counts, exponent)
        at, neighbour = np.nonzero(matches.weights > 0)
        numbers, weights = matches.numbers[at, neighbour], matches.weights[at, neighbour]
        photo_xy = self._photos.xy(numbers, matches.rows[at, neighbour])
        support = displacement_support(matches.picture_xy[at], photo_xy, weights, numbers, len(scores))
        return scores + self._params.arrangement * support / np.maximum(counts, 1) ** exponent

    def _best(self, order: np.ndarray) -> np.ndarray:
        """(places,) the photo of each that comes last."""
        best = np.zeros(1 + self._photos.place_of.max(), int)
        best[self._photos.place_of[order]] = order  # the last one stays
        return best

    def _of_places(self, ratios: np.ndarray) -> np.ndarray:
        """A picture of a place is as likely as it is on the mean of the place's photos."""
        top = ratios.max()
        sums = np.bincount(self._photos.place_of, np.exp(np.maximum(ratios - top, -LEAST)))
        return top + np.log(sums / np.bincount(self._photos.place_of))
