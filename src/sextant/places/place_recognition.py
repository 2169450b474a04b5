# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Recognizes the place of an image: descriptor votes, geometric verification, and their evidence."""

from dataclasses import dataclass
from typing import Any, List, NamedTuple, Optional

import cv2
import numpy as np

from sextant.base.strict_params import StrictParams, nested, param, within
from sextant.place_maps.place_map import Photo, PlaceMap
from sextant.places.global_descriptor import GlobalDescriptor
from sextant.places.place_evidence import EvidenceParams, absolute_log_ratios, relative_log_ratios
from sextant.places.place_index import PlaceIndex
from sextant.places.place_matches import MapPhotos, MatchedPhoto, Neighbours
from sextant.places.place_verification import displacement_support
from sextant.places.place_votes import MatchStatistics, lnbnn_scores, lnbnn_weights, match_statistics

CELLS = 8  # number of cells along each side of the image, see contrast()
MAX_DIFFERENCE = 500.0  # log ratios farther below the largest are raised to this: no exponential is 0


@dataclass(frozen=True)
class RecognitionParams(StrictParams):
    """Parameters of the scores and their evidence."""

    neighbours: int = param(
        16, "nearest neighbours per descriptor; the last one represents the background", within(2, 128)
    )
    hub_exponent: float = param(
        0.5, "a photo's score is divided by its number of descriptors to this power", within(0, 1)
    )
    displacement_weight: float = param(2.0, "weight of votes with consistent displacement", within(0, 100))
    min_keypoints: int = param(
        10,
        "minimum number of keypoints of a usable image, without a "
        "[network](../how_to/place_networks.md#fusion)",
        within(1, 100000),
    )
    min_contrast: float = param(
        0.5, "minimum contrast() for evidence by the global descriptor", within(0, 128), "grey levels"
    )
    evidence: EvidenceParams = nested(EvidenceParams)
    network_weight: float = param(1.0, "weight of the network relative to the keypoints", within(0, 100))


class Recognition(NamedTuple):
    """Evidence of one image for the places in the order of PlaceMap.places()."""

    scores: np.ndarray  # (places,) score by votes of the most likely photo; at least 0, larger is better
    log_ratios: np.ndarray  # (places,) log likelihood ratio of each place against an unknown place
    best_photos: List[Photo]  # (places,) most likely photo of each place
    usable: bool  # whether there is any evidence
    is_absolute: bool  # whether there are votes; otherwise log_ratios only compare places with each other
    statistics: MatchStatistics  # of the image's keypoints
    match: MatchedPhoto  # of the most likely photo


def contrast(image: np.ndarray) -> float:
    """Standard deviation of the means of 8x8 equal cells, grey levels; the highest of all channels.

    Image noise averages out in the means; a scene does not, even in the dark, in fog or out of focus.

    :param image: uint8, (height, width) grey or (height, width, 3) BGR
    """
    cells = cv2.resize(image.astype(np.float32), (CELLS, CELLS), interpolation=cv2.INTER_AREA)
    return float(cells.reshape(CELLS * CELLS, -1).std(axis=0).max())


class PlaceRecognizer:
    """Recognizes the places of images with the index of a map's photos. Not thread-safe."""

    def __init__(
        self,
        place_map: PlaceMap,
        index: PlaceIndex,
        params: Optional[RecognitionParams] = None,
        extractor: Optional[Any] = None,
    ):
        """:param extractor: replaces the sextant.FeatureExtractor of the index
        :raises ValueError: a parameter out of range, or a photo that is not in the index
        """
        self._params, self._index = params or RecognitionParams(), index
        self._photos = MapPhotos(place_map, index, extractor)
        network = index.params.global_descriptor
        self._descriptor = GlobalDescriptor(network) if network and self._params.network_weight else None

    def recognize(self, image: np.ndarray) -> Recognition:
        """Computes the evidence of an image.

        :param image: uint8, (height, width) grey or (height, width, 3) BGR
        """
        neighbours = self._photos.neighbours(image, self._params.neighbours)
        weights = lnbnn_weights(neighbours.distances, neighbours.numbers)
        scores = self._scores(neighbours, weights)
        is_absolute = len(neighbours.query_xy) >= self._params.min_keypoints
        ratios = absolute_log_ratios(scores, self._params.evidence) if is_absolute else np.zeros(len(scores))
        has_descriptor = self._descriptor is not None and contrast(image) >= self._params.min_contrast
        if has_descriptor:
            ratios = ratios + self._network_log_ratios(image)
        order = np.lexsort((scores, ratios))
        best = self._best(order)
        statistics = match_statistics(neighbours.distances, neighbours.numbers)
        return Recognition(
            scores[best], self._of_places(ratios), [self._photos.photos[number] for number in best],
            is_absolute or has_descriptor, is_absolute, statistics,
            self._photos.match(neighbours, weights, int(order[-1])),
        )  # fmt: skip

    def _network_log_ratios(self, image: np.ndarray) -> np.ndarray:
        """Log likelihood ratios (photos,) by global descriptors."""
        similarities = (self._index.vectors @ self._descriptor.describe(image))[self._photos.rows]
        return relative_log_ratios(similarities, self._params.network_weight, self._photos.shares)

    def _scores(self, neighbours: Neighbours, weights: np.ndarray) -> np.ndarray:
        """Scores (photos,): votes, and additional weight for those with consistent displacement."""
        exponent, counts = self._params.hub_exponent, self._photos.counts
        scores = lnbnn_scores(weights, neighbours.numbers, counts, exponent)
        keypoint, neighbour = np.nonzero(weights > 0)
        numbers, weights = neighbours.numbers[keypoint, neighbour], weights[keypoint, neighbour]
        photo_xy = self._photos.xy(numbers, neighbours.rows[keypoint, neighbour])
        support = displacement_support(neighbours.query_xy[keypoint], photo_xy, weights, numbers, len(scores))
        return scores + self._params.displacement_weight * support / np.maximum(counts, 1) ** exponent

    def _best(self, order: np.ndarray) -> np.ndarray:
        """Numbers (places,) of photos: for each place, its photo that comes last in the order."""
        best = np.zeros(1 + self._photos.place_of.max(), int)
        best[self._photos.place_of[order]] = order  # the last assignment remains
        return best

    def _of_places(self, ratios: np.ndarray) -> np.ndarray:
        """Log (places,) of the mean likelihood ratio of each place's photos."""
        highest = ratios.max()
        sums = np.bincount(self._photos.place_of, np.exp(np.maximum(ratios - highest, -MAX_DIFFERENCE)))
        return highest + np.log(sums / np.bincount(self._photos.place_of))
