# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Recognizes the place of an image: comparison with the photos of a map, and its evidence."""

from dataclasses import dataclass
from typing import Any, List, NamedTuple, Optional

import cv2
import numpy as np

from sextant.base.strict_params import StrictParams, nested, param, within
from sextant.place_maps.place_map import Photo, PlaceMap
from sextant.places.global_descriptor import GlobalDescriptor
from sextant.places.photo_features import KeypointExtractor
from sextant.places.photo_keypoints import CodedKeypoints
from sextant.places.place_evidence import (
    EvidenceParams,
    UnknownPlaces,
    absolute_log_ratios,
    relative_log_ratios,
)
from sextant.places.place_index import PlaceIndex
from sextant.places.place_matches import MapPhotos, MatchedPhoto, matched_photo
from sextant.places.place_scores import ScoresByPhoto, compared_photos, photo_scores
from sextant.places.place_votes import MatchStatistics, match_statistics
from sextant.places.rough_pose import LEAST, RoughPose

CELLS = 8  # number of cells along each side of the image, see contrast()
MAX_DIFFERENCE = 500.0  # log ratios farther below the largest are raised to this: no exponential is 0


@dataclass(frozen=True)
class RecognitionParams(StrictParams):
    """Parameters of the scores and their evidence."""

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

    scores: np.ndarray  # (places,) score of the most likely photo; at least 0, larger is better
    log_ratios: np.ndarray  # (places,) log likelihood ratio of each place against an unknown place
    best_photos: List[Photo]  # (places,) most likely photo of each place
    usable: bool  # whether there is any evidence
    is_absolute: bool  # whether there are enough keypoints; otherwise log_ratios only compare places
    statistics: MatchStatistics  # of the image's keypoints
    match: MatchedPhoto  # of the most likely photo
    log_weights: Optional[np.ndarray] = None  # (places,) by the rough pose; None: there was none


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
        """:param index: without a matcher

        :param extractor: replaces the KeypointExtractor of the index
        :raises ValueError: a photo that is not in the index, or an index with a matcher
        """
        if index.params.matcher:
            raise ValueError(f"matcher {index.params.matcher} is for mode votes only")
        self._params, self._index = params or RecognitionParams(), index
        self._photos = MapPhotos(place_map, index)
        everywhere = self._unknown_places(np.arange(len(self._photos.rows)))
        self._unknown = [unknown or UnknownPlaces() for unknown in everywhere]
        self._extractor = extractor or KeypointExtractor(index.params)
        network = index.params.global_descriptor
        self._descriptor = GlobalDescriptor(network) if network and self._params.network_weight else None

    def recognize(self, image: np.ndarray, rough: Optional[RoughPose] = None) -> Recognition:
        """Computes the evidence of an image.

        :param image: uint8, (height, width) grey or (height, width, 3) BGR
        :param rough: of the camera
        """
        kinds = self._index.encode(self._extractor.extract(image))
        weights = self._photos.log_weights(rough)
        region = _region(weights)
        scores = photo_scores(self._index, self._photos.rows, kinds, region)
        total, is_absolute = scores.total, len(kinds[0].positions) >= self._params.min_keypoints
        shares = self._photos.shares if rough is None else self._photos.weighted_shares(weights)
        ratios = np.zeros(len(total))
        if is_absolute:
            ratios = self._absolute_log_ratios(total, len(scores.logs), shares, region)
        has_descriptor = self._descriptor is not None and contrast(image) >= self._params.min_contrast
        if has_descriptor:
            ratios = ratios + self._network_log_ratios(image, shares)
        order = np.lexsort((total, ratios + weights))
        best = self._best(order)
        return Recognition(
            total[best], self._of_places(ratios + weights) - self._of_places(weights),
            [self._photos.photos[number] for number in best],
            is_absolute or has_descriptor, is_absolute,
            match_statistics(scores.nearest, np.isfinite(scores.nearest)),
            self._match(int(order[-1]), kinds[0], scores.background),
            None if rough is None else self._photos.of_best(weights),
        )  # fmt: skip

    def scores(self, image: np.ndarray) -> ScoresByPhoto:
        """Scores of the photos, in the order of the places, for an image."""
        kinds = self._index.encode(self._extractor.extract(image))
        return photo_scores(self._index, self._photos.rows, kinds)

    def features(self, scores: np.ndarray, kinds: int, numbers: Optional[np.ndarray] = None) -> np.ndarray:
        """Features (2,) of the evidence of an image, see UnknownPlaces.features().

        :param scores: (photos,) of all kinds of keypoints that the image has
        :param kinds: number of these kinds
        :param numbers: int (m,) of the photos where the robot may be; None: all
        """
        unknown = self._unknown[kinds - 1]
        if numbers is None:
            numbers = np.arange(len(scores))
        else:
            unknown = self._unknown_places(numbers)[kinds - 1] or unknown
        best = np.zeros(len(scores), bool)
        best[numbers[scores[numbers].argmax()]] = True
        return unknown.features(scores[numbers], self.near(best)[numbers], kinds)

    def near(self, which: np.ndarray) -> np.ndarray:
        """Whether each photo is near one of these.

        :param which: bool (photos,)
        :returns: bool (photos,)
        """
        return self._photos.near(np.flatnonzero(which)).any(axis=0)

    def _unknown_places(self, numbers: np.ndarray) -> List[Optional[UnknownPlaces]]:
        """For images with one kind of keypoints, with two, ...; None if too few photos were compared.

        :param numbers: int (m,) of the photos where the robot may be
        """
        index, rows = self._index, self._photos.rows[numbers]
        number_of_row = np.full(len(index.photos), -1)
        number_of_row[rows] = np.arange(len(numbers))
        compared = index.compared or compared_photos(index)
        in_map = number_of_row[compared.rows] >= 0
        given = number_of_row[compared.rows[in_map]]

        def near(which: np.ndarray) -> np.ndarray:
            return self._photos.near(numbers[which])[:, numbers]

        return [UnknownPlaces.of_map(scores[in_map][:, rows], given, near) for scores in compared.scores]

    def _absolute_log_ratios(
        self, scores: np.ndarray, kinds: int, shares: np.ndarray, region: Optional[np.ndarray]
    ) -> np.ndarray:
        """Log likelihood ratios (photos,): the higher ones of all photos and of the region's alone.

        Photos of a small region are all similar, but those elsewhere may be of places that look the same.
        """
        of_all = self.features(scores, kinds)
        features = [of_all] if region is None else [of_all, self.features(scores, kinds, region)]
        evidence = self._params.evidence
        return max((absolute_log_ratios(scores, each, shares, evidence) for each in features), key=np.max)

    def _match(self, number: int, image: CodedKeypoints, background: np.ndarray) -> MatchedPhoto:
        photo, row = self._photos.photos[number], self._photos.rows[number]
        return matched_photo(photo, image, self._index.keypoints[0], row, background)

    def _network_log_ratios(self, image: np.ndarray, shares: np.ndarray) -> np.ndarray:
        """Log likelihood ratios (photos,) by global descriptors."""
        similarities = (self._index.vectors @ self._descriptor.describe(image))[self._photos.rows]
        return relative_log_ratios(similarities, self._params.network_weight, shares)

    def _best(self, order: np.ndarray) -> np.ndarray:
        """Numbers (places,) of photos: for each place, its photo that comes last in the order."""
        best = np.zeros(1 + self._photos.place_of.max(), int)
        best[self._photos.place_of[order]] = order  # the last assignment remains
        return best

    def _of_places(self, ratios: np.ndarray) -> np.ndarray:
        """Log (places,) of the mean likelihood ratio of each place's photos."""
        highest = ratios.max()
        parts = np.exp(np.maximum(ratios - highest, -MAX_DIFFERENCE), dtype=float)
        sums = np.bincount(self._photos.place_of, parts)
        return highest + np.log(sums / np.bincount(self._photos.place_of))


def _region(log_weights: np.ndarray) -> Optional[np.ndarray]:
    """Indices (m,) of photos that a rough pose does not exclude; None: all."""
    there = np.flatnonzero(log_weights > LEAST)
    return there if 0 < len(there) < len(log_weights) else None
