# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The mode `votes`: nearest neighbours not farther than their mean are counted, photo by photo."""

from typing import List, NamedTuple

import numpy as np

import sextant
from sextant.place_maps.place_map import Photo, PlaceMap
from sextant.places.place_index import PlaceIndex
from sextant.places.place_matches import MapPhotos, MatchedPhoto, Matches
from sextant.places.place_votes import MatchStatistics, count_votes, kept_matches, match_statistics


class Votes(NamedTuple):
    """Photos with their shares of the votes, most first; none: there were too few votes."""

    photos: List[Photo]
    probabilities: List[float]
    statistics: MatchStatistics
    match: MatchedPhoto  # of the photo with most votes


class PlaceVoter:
    """Counts votes of pictures. Not thread-safe."""

    def __init__(self, place_map: PlaceMap, index: PlaceIndex, min_matches: int, max_photos: int):
        """:raises ValueError: a photo that is not in the index"""
        self._index = index
        self._min_matches, self._max_photos = min_matches, max_photos
        self._photos = MapPhotos(place_map, index)
        self._extractor = sextant.FeatureExtractor(index.params.feature_params())

    def vote(self, image: np.ndarray) -> Votes:
        """:param image: uint8, (height, width) grey or (height, width, 3) BGR"""
        features = self._extractor.extract(image)
        distances, owners, rows = self._index.descriptors.search(features.descriptors, 1)
        numbers = self._photos.numbers(owners)
        counted = count_votes(distances, numbers, self._min_matches, self._max_photos)
        picture_xy = features.keypoints[:, :2] / max(features.size)
        weights = kept_matches(distances, numbers).astype(float)
        winner = counted.photos[0] if len(counted.photos) else 0
        match = self._photos.match(Matches(picture_xy, numbers, rows, weights), winner)
        photos = [self._photos.photos[number] for number in counted.photos]
        return Votes(photos, counted.probabilities.tolist(), match_statistics(distances, numbers), match)
