# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Mode `votes`: counts the nearest neighbours in each photo, up to the mean of their distances."""

from typing import List, NamedTuple

import numpy as np

from sextant.place_maps.place_map import Photo, PlaceMap
from sextant.places.photo_features import KeypointExtractor
from sextant.places.photo_keypoints import UNIT
from sextant.places.place_index import PlaceIndex
from sextant.places.place_matches import MapPhotos, MatchedPhoto
from sextant.places.place_votes import MatchStatistics, count_votes, kept_matches, match_statistics


class VoteShares(NamedTuple):
    """Photos with their shares of the votes, in descending order; empty if there are too few votes."""

    photos: List[Photo]  # of the map
    shares: List[float]  # fractions of all votes
    statistics: MatchStatistics  # of the image's keypoints
    match: MatchedPhoto  # of the photo with most votes


class VoteCounter:
    """Counts the votes of images for the photos of a map. Not thread-safe."""

    def __init__(self, place_map: PlaceMap, index: PlaceIndex, min_matches: int, max_photos: int):
        """:param index: with a matcher

        :param min_matches: minimum number of votes
        :param max_photos: maximum number of photos returned
        :raises ValueError: a photo that is not in the index, or an index without a matcher
        """
        if not index.params.matcher:
            raise ValueError("mode votes needs a matcher")
        self._photos, self._index = MapPhotos(place_map, index), index
        self._numbers = index.numbers(self._photos.rows)  # by image_id
        self._min_matches, self._max_photos = min_matches, max_photos
        self._extractor = KeypointExtractor(index.params)

    def count(self, image: np.ndarray) -> VoteShares:
        """Counts the votes of an image.

        :param image: uint8, (height, width) grey or (height, width, 3) BGR
        """
        keypoints = self._extractor.extract(image)[0]
        distances, image_ids, rows = self._index.descriptors.search(self._index.searched(keypoints), 1)
        numbers = self._numbers[image_ids]
        best, shares = count_votes(distances, numbers, self._min_matches, self._max_photos)
        number = int(best[0]) if len(best) else 0
        kept = (numbers[:, 0] == number) & kept_matches(distances, numbers)[:, 0]
        there = self._index.keypoints[0].of(self._photos.rows[number]).positions
        match = MatchedPhoto(
            self._photos.photos[number], keypoints.positions[kept] / UNIT,
            there[rows[kept, 0]] / UNIT, np.ones(int(kept.sum())),
        )  # fmt: skip
        statistics = match_statistics(distances[:, 0], numbers[:, 0] >= 0)
        return VoteShares([self._photos.photos[each] for each in best], shares.tolist(), statistics, match)
