# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which places of a map a picture may show: votes of descriptors, their arrangement, what both are worth."""

from dataclasses import dataclass
from typing import Dict, List, NamedTuple, Optional, Tuple

import numpy as np

import sextant
from sextant.places.global_descriptor import GlobalDescriptor
from sextant.places.place_fusion import fused_scores
from sextant.places.place_index import UNIT, IndexedPhoto, PlaceIndex
from sextant.places.place_map import Photo, PlaceMap
from sextant.places.place_verification import displacement_support
from sextant.places.place_votes import MatchStatistics, lnbnn_scores, lnbnn_weights, match_statistics

MAD_TO_DEVIATION = 1.4826  # of a normal distribution


@dataclass(frozen=True)
class RecognitionParams:
    """How votes become scores, and scores evidence."""

    neighbours: int = 16  # [2, 128]; of a descriptor; the last stands for everywhere else
    hub_exponent: float = 0.5  # [0, 1]; of a photo's number of descriptors, which its votes are divided by
    arrangement: float = 2.0  # [0, 100]; weight of the votes that agree in their displacement
    candidates: int = 50  # [1, 1000]; best photos whose arrangement is looked at
    global_weight: float = 1.0  # [0, 100]; of the index's global descriptor; 0: it is not used
    evidence_slope: float = 1.0  # (0, 100]; log of a likelihood ratio a deviation of the score
    evidence_offset: float = 6.0  # [0, 100]; deviations at which a picture speaks for no side
    evidence_limit: float = 12.0  # (0, 100]; of the log of a likelihood ratio

    def validate(self) -> None:
        """:raises ValueError: names the first field out of range"""
        ranges = {
            "neighbours": (2, 128),
            "hub_exponent": (0, 1),
            "arrangement": (0, 100),
            "candidates": (1, 1000),
            "global_weight": (0, 100),
            "evidence_slope": (1e-6, 100),
            "evidence_offset": (0, 100),
            "evidence_limit": (1e-6, 100),
        }
        for name, (low, high) in ranges.items():
            value = getattr(self, name)
            if not low <= value <= high:
                raise ValueError(f"{name} is {value}, allowed is [{low:g}, {high:g}]")


class MatchedPhoto(NamedTuple):
    """What a picture has in common with a photo of the map."""

    photo: Photo
    picture_xy: np.ndarray  # (m, 2) keypoints, in longer sides of the picture
    photo_xy: np.ndarray  # (m, 2) their counterparts, in longer sides of the photo
    weights: np.ndarray  # (m,)


class Recognition(NamedTuple):
    """Of one picture, place by place in the order of PlaceMap.places()."""

    scores: np.ndarray  # (places,); larger is better; above 0 without a global descriptor
    log_ratios: (
        np.ndarray
    )  # (places,) how much likelier the picture is there than where the map knows nothing
    best_photos: List[Photo]  # (places,) which photo of each place scores most
    statistics: MatchStatistics
    match: MatchedPhoto  # of the best photo of all


class PlaceRecognizer:
    """Recognizes pictures with a map and the index of its photos. Not thread-safe."""

    def __init__(
        self, place_map: PlaceMap, index: PlaceIndex, params: Optional[RecognitionParams] = None
    ):
        """:raises OSError: the global descriptor's model cannot be read
        :raises ValueError: a parameter out of range, or a photo that is not in the index
        """
        self._params, self._index = params or RecognitionParams(), index
        self._params.validate()
        self._extractor = sextant.FeatureExtractor(index.settings.feature_params())
        self._photos, self._indexed, self._place_of = _arranged(place_map, index)
        self._counts = np.array([photo.count for photo in self._indexed])
        self._xy = [index.keypoints_of(photo)[:, :2] / UNIT for photo in self._indexed]
        rows = {photo.owner: row for row, photo in enumerate(index.photos)}
        self._rows = [rows[photo.owner] for photo in self._indexed]
        self._descriptor = self._global_descriptor()
        owners = 1 + max(photo.owner for photo in index.photos)
        self._number_of_owner = np.full(owners + 1, -1)  # the last one: of no owner
        for number, photo in enumerate(self._indexed):
            self._number_of_owner[photo.owner] = number

    def recognize(self, image: np.ndarray) -> Recognition:
        """:param image: uint8, (height, width) grey or (height, width, 3) BGR"""
        features = self._extractor.extract(image)
        distances, owners, rows = self._index.descriptors.search(
            features.descriptors, self._params.neighbours
        )
        numbers = self._number_of_owner[owners]
        weights = lnbnn_weights(distances, numbers)
        scores = lnbnn_scores(weights, numbers, self._counts, self._params.hub_exponent)
        picture_xy = features.keypoints[:, :2] / max(features.size)
        scores += self._params.arrangement * self._agreement(picture_xy, weights, numbers, rows, scores)
        scores = self._fused(image, scores)
        return self._by_place(
            scores, picture_xy, weights, numbers, rows, match_statistics(distances, numbers)
        )

    def _global_descriptor(self) -> Optional[GlobalDescriptor]:
        settings = self._index.settings.global_descriptor
        return GlobalDescriptor(settings) if settings and self._params.global_weight else None

    def _fused(self, image: np.ndarray, scores: np.ndarray) -> np.ndarray:
        if self._descriptor is None:
            return scores
        similarities = (self._index.vectors @ self._descriptor.describe(image))[self._rows]
        return fused_scores(scores, similarities, self._params.global_weight)

    def _agreement(
        self,
        picture_xy: np.ndarray,
        weights: np.ndarray,
        numbers: np.ndarray,
        rows: np.ndarray,
        scores: np.ndarray,
    ) -> np.ndarray:
        """(photos,) the score of the matches that agree in their displacement, of the best photos."""
        candidates = np.argsort(-scores, kind="stable")[: self._params.candidates]
        group = np.full(len(scores) + 1, -1)
        group[candidates] = np.arange(len(candidates))
        at, neighbour = np.nonzero((weights > 0) & (group[numbers] >= 0))
        mine = numbers[at, neighbour]
        photo_xy = np.array([self._xy[n][r] for n, r in zip(mine, rows[at, neighbour])]).reshape(-1, 2)
        support = displacement_support(
            picture_xy[at], photo_xy, weights[at, neighbour], group[mine], len(candidates)
        )
        agreement = np.zeros(len(scores))
        agreement[candidates] = support / np.maximum(self._counts[candidates], 1) ** self._params.hub_exponent
        return agreement

    def _by_place(
        self,
        scores: np.ndarray,
        picture_xy: np.ndarray,
        weights: np.ndarray,
        numbers: np.ndarray,
        rows: np.ndarray,
        statistics: MatchStatistics,
    ) -> Recognition:
        places = 1 + max(self._place_of)
        best = np.full(places, -1)
        for number in np.argsort(scores, kind="stable"):
            best[self._place_of[number]] = number
        place_scores = scores[best]
        at, neighbour = np.nonzero((numbers == scores.argmax()) & (weights > 0))
        match = MatchedPhoto(
            self._photos[int(scores.argmax())],
            picture_xy[at],
            self._xy[int(scores.argmax())][rows[at, neighbour]],
            weights[at, neighbour],
        )
        return Recognition(
            place_scores,
            self._log_ratios(place_scores),
            [self._photos[number] for number in best],
            statistics,
            match,
        )

    def _log_ratios(self, scores: np.ndarray) -> np.ndarray:
        """Deviations of the scores from those of most places, which are wrong, as evidence."""
        centre = np.median(scores)
        deviation = MAD_TO_DEVIATION * np.median(np.abs(scores - centre))
        if not deviation > 0:
            return np.zeros(len(scores))
        evidence = self._params.evidence_slope * (
            (scores - centre) / deviation - self._params.evidence_offset
        )
        return np.clip(evidence, -self._params.evidence_limit, self._params.evidence_limit)


def _arranged(place_map: PlaceMap, index: PlaceIndex) -> Tuple[List[Photo], List[IndexedPhoto], List[int]]:
    """The map's photos, their part of the index, and their places."""
    by_image: Dict[str, IndexedPhoto] = {photo.image: photo for photo in index.photos}
    photos, indexed, place_of = [], [], []
    for number, place in enumerate(place_map.places()):
        for photo in place:
            if photo.image not in by_image:
                raise ValueError(f"{photo.image}: is not in the index")
            photos.append(photo)
            indexed.append(by_image[photo.image])
            place_of.append(number)
    return photos, indexed, place_of
