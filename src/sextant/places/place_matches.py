# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A picture's matches with the photos of a map, by the photos' numbers in the order of the map's places."""

from typing import Dict, List, NamedTuple

import numpy as np

from sextant.place_maps.place_map import Photo, PlaceMap
from sextant.places.place_index import UNIT, IndexedPhoto, PlaceIndex


class Matches(NamedTuple):
    """Neighbours of a picture's n descriptors; (n, k) but for picture_xy."""

    picture_xy: np.ndarray  # (n, 2) in longer sides of the picture
    numbers: np.ndarray  # of photos; -1: none
    rows: np.ndarray  # which of its photo's keypoints
    weights: np.ndarray  # 0: it does not count


class MatchedPhoto(NamedTuple):
    """What a picture has in common with a photo of the map."""

    photo: Photo
    picture_xy: np.ndarray  # (m, 2) keypoints, in longer sides of the picture
    photo_xy: np.ndarray  # (m, 2) their counterparts, in longer sides of the photo
    weights: np.ndarray  # (m,)


class MapPhotos:
    """The photos of a map with their part of the index."""

    def __init__(self, place_map: PlaceMap, index: PlaceIndex):
        """:raises ValueError: a photo that is not in the index"""
        places = place_map.places()
        self.photos = [photo for place in places for photo in place]
        self.place_of = np.repeat(np.arange(len(places)), [len(place) for place in places])
        in_place = np.bincount(self.place_of)
        self.shares = 1 / (len(places) * in_place[self.place_of])  # all places have the same; they sum to 1
        indexed = _indexed(self.photos, index)
        self.counts = np.array([photo.count for photo in indexed])  # of keypoints
        row_of = {photo.owner: row for row, photo in enumerate(index.photos)}
        self.rows = np.array([row_of[photo.owner] for photo in indexed])  # in PlaceIndex.photos and .vectors
        self._keypoints, self._first = index.keypoints, np.array([photo.first for photo in indexed])
        self._number_of_owner = np.full(2 + max(row_of), -1)  # the last one: of no owner
        self._number_of_owner[[photo.owner for photo in indexed]] = np.arange(len(indexed))

    def numbers(self, owners: np.ndarray) -> np.ndarray:
        """Of the photos that descriptors belong to; -1: of none."""
        return self._number_of_owner[owners]

    def xy(self, numbers: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """(m, 2) keypoints by the number of their photo and their row in it, in longer sides of the photo."""
        return self._keypoints[self._first[numbers] + rows] / UNIT

    def match(self, matches: Matches, number: int) -> MatchedPhoto:
        """What counts of a picture's matches with one photo."""
        at, neighbour = np.nonzero((matches.numbers == number) & (matches.weights > 0))
        photo_xy = self.xy(np.full(len(at), number), matches.rows[at, neighbour])
        weights = matches.weights[at, neighbour]
        return MatchedPhoto(self.photos[number], matches.picture_xy[at], photo_xy, weights)


def _indexed(photos: List[Photo], index: PlaceIndex) -> List[IndexedPhoto]:
    by_image: Dict[str, IndexedPhoto] = {photo.image: photo for photo in index.photos}
    lacking = [photo.image for photo in photos if photo.image not in by_image]
    if lacking:
        raise ValueError(f"{lacking[0]}: is not in the index")
    return [by_image[photo.image] for photo in photos]
