# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Matches between an image and the photos of a map, which are numbered in the order of the map's places."""

from typing import Any, Dict, List, NamedTuple, Optional

import numpy as np

import sextant
from sextant.place_maps.place_map import Photo, PlaceMap
from sextant.places.place_index import UNIT, IndexedPhoto, PlaceIndex


class Neighbours(NamedTuple):
    """The k nearest neighbours of the n descriptors of an image, nearest first."""

    query_xy: np.ndarray  # (n, 2) keypoints of the image, as fractions of its longer side
    distances: np.ndarray  # (n, k)
    numbers: np.ndarray  # (n, k) photo of each neighbour; -1: no neighbour, or its photo is not in the map
    rows: np.ndarray  # (n, k) index of each neighbour among the keypoints of its photo


class MatchedPhoto(NamedTuple):
    """Matches between an image and one photo of the map."""

    photo: Photo  # of the map
    query_xy: np.ndarray  # (m, 2) keypoints of the image, as fractions of its longer side
    photo_xy: np.ndarray  # (m, 2) matched keypoints of the photo, as fractions of its longer side
    weights: np.ndarray  # (m,) larger is better


class MapPhotos:
    """The photos of a map with their features in the index. Not thread-safe."""

    photos: List[Photo]  # by number
    place_of: np.ndarray  # int (photos,) index of each photo's place
    shares: np.ndarray  # (photos,) weights that sum to 1, equal for all places
    counts: np.ndarray  # int (photos,) numbers of keypoints
    rows: np.ndarray  # int (photos,) index of each photo in PlaceIndex.photos and .vectors

    def __init__(self, place_map: PlaceMap, index: PlaceIndex, extractor: Optional[Any] = None):
        """:param extractor: replaces the sextant.FeatureExtractor of the index
        :raises ValueError: a photo that is not in the index
        """
        places = place_map.places()
        self.photos = [photo for place in places for photo in place]
        self.place_of = np.repeat(np.arange(len(places)), [len(place) for place in places])
        in_place = np.bincount(self.place_of)
        self.shares = 1 / (len(places) * in_place[self.place_of])
        indexed = _indexed(self.photos, index)
        self.counts = np.array([photo.count for photo in indexed])
        row_of = {photo.image_id: row for row, photo in enumerate(index.photos)}
        self.rows = np.array([row_of[photo.image_id] for photo in indexed])
        self._keypoints, self._first = index.keypoints, np.array([photo.first for photo in indexed])
        self._number_of_image_id = np.full(2 + max(row_of), -1)  # last element: image_id -1, no neighbour
        self._number_of_image_id[[photo.image_id for photo in indexed]] = np.arange(len(indexed))
        self._extractor = extractor or sextant.FeatureExtractor(index.params.feature_params())
        self._descriptors = index.descriptors

    def neighbours(self, image: np.ndarray, count: int) -> Neighbours:
        """Finds the nearest neighbours of each descriptor of an image.

        :param image: uint8, (height, width) grey or (height, width, 3) BGR
        :param count: neighbours per descriptor
        """
        features = self._extractor.extract(image)
        distances, image_ids, rows = self._descriptors.search(features.descriptors, count)
        query_xy = features.keypoints[:, :2] / max(features.size)
        return Neighbours(query_xy, distances, self._number_of_image_id[image_ids], rows)

    def xy(self, numbers: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Keypoints (m, 2) by photo number and row, as fractions of the photo's longer side."""
        return self._keypoints[self._first[numbers] + rows] / UNIT

    def match(self, neighbours: Neighbours, weights: np.ndarray, number: int) -> MatchedPhoto:
        """The matches with one photo.

        :param weights: (n, k) of the neighbours; neighbours of weight 0 are left out
        :param number: the photo
        """
        keypoint, neighbour = np.nonzero((neighbours.numbers == number) & (weights > 0))
        query_xy, weights = neighbours.query_xy[keypoint], weights[keypoint, neighbour]
        photo_xy = self.xy(np.full(len(keypoint), number), neighbours.rows[keypoint, neighbour])
        return MatchedPhoto(self.photos[number], query_xy, photo_xy, weights)


def _indexed(photos: List[Photo], index: PlaceIndex) -> List[IndexedPhoto]:
    by_image: Dict[str, IndexedPhoto] = {photo.image: photo for photo in index.photos}
    missing = [photo.image for photo in photos if photo.image not in by_image]
    if missing:
        raise ValueError(f"{missing[0]}: is not in the index")
    return [by_image[photo.image] for photo in photos]
