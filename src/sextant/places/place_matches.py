# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Matches between an image and the photos of a map."""

from typing import Dict, List, NamedTuple, Optional

import numpy as np

import sextant
from sextant.place_maps.place_map import Photo, PlaceMap
from sextant.places.photo_keypoints import UNIT, CodedKeypoints, PhotoKeypoints
from sextant.places.place_estimate import scale_of
from sextant.places.place_index import PlaceIndex
from sextant.places.place_spacing import neighbour_radius
from sextant.places.rough_pose import RoughPose, log_weights


class MatchedPhoto(NamedTuple):
    """Matches between an image and one photo of the map."""

    photo: Photo  # of the map
    query_xy: np.ndarray  # (m, 2) keypoints of the image, as fractions of its longer side
    photo_xy: np.ndarray  # (m, 2) matched keypoints of the photo, as fractions of its longer side
    weights: np.ndarray  # (m,) larger is better


class MapPhotos:
    """The photos of a map with their places, and where they are in the index."""

    photos: List[Photo]  # by number
    place_of: np.ndarray  # int (photos,) index of each photo's place
    shares: np.ndarray  # (photos,) weights that sum to 1, equal for all places
    rows: np.ndarray  # int (photos,) index of each photo in the index's photos, keypoints and vectors

    def __init__(self, place_map: PlaceMap, index: PlaceIndex):
        """:raises ValueError: a photo that is not in the index"""
        places = place_map.places()
        self.photos = [photo for place in places for photo in place]
        self.place_of = np.repeat(np.arange(len(places)), [len(place) for place in places])
        in_place = np.bincount(self.place_of)
        self.shares = 1 / (len(places) * in_place[self.place_of])
        self.rows = _rows(self.photos, index)
        self._yaws = np.array([photo.yaw for photo in self.photos], float)  # nan: unknown
        self._pixels = place_map.positions()[self.place_of]
        self._positions = self._pixels * (scale_of(place_map) or (1.0, 1.0))
        self._radius = neighbour_radius(self._positions)

    def log_weights(self, rough: Optional[RoughPose]) -> np.ndarray:
        """Log weights (photos,) by a rough pose; None: all are 0."""
        if rough is None:
            return np.zeros(len(self.photos))
        return log_weights(rough, self._pixels, self._yaws)

    def of_best(self, log_weights: np.ndarray) -> np.ndarray:
        """Log weights (places,): of each place's photo with the highest weight."""
        highest = np.full(1 + self.place_of.max(), -np.inf)
        np.maximum.at(highest, self.place_of, log_weights)
        return highest

    def weighted_shares(self, log_weights: np.ndarray) -> np.ndarray:
        """Weights (photos,) that sum to 1: of_best() of the places, divided among the photos of each."""
        weights = np.exp(log_weights)
        of_place = np.exp(self.of_best(log_weights)) / np.bincount(self.place_of, weights)
        shares = weights * of_place[self.place_of]
        return shares / shares.sum()

    def near(self, numbers: np.ndarray) -> np.ndarray:
        """Whether each photo shows about the same place as some photos: bool (m, photos).

        :param numbers: int (m,)
        """
        offsets = self._positions[numbers][:, np.newaxis] - self._positions
        return np.linalg.norm(offsets, axis=2) <= self._radius


def matched_photo(
    photo: Photo, image: CodedKeypoints, keypoints: PhotoKeypoints, row: int, background: np.ndarray
) -> MatchedPhoto:
    """The mutual matches with one photo.

    :param keypoints: of all photos, of the same kind as the image's
    :param row: of the photo among them
    :param background: (n,) see KeypointScores; matches beyond it are left out
    """
    there = keypoints.of(row)
    distances, rows, is_mutual = sextant.photo_matches(*image, *there)
    weights = 1 - distances / np.maximum(background, np.finfo(np.float32).tiny)
    kept = is_mutual & (weights > 0)
    return MatchedPhoto(
        photo, image.positions[kept] / UNIT, there.positions[rows[kept]] / UNIT, weights[kept]
    )


def _rows(photos: List[Photo], index: PlaceIndex) -> np.ndarray:
    row_of: Dict[str, int] = {photo.image: row for row, photo in enumerate(index.photos)}
    missing = [photo.image for photo in photos if photo.image not in row_of]
    if missing:
        raise ValueError(f"{missing[0]}: is not in the index")
    return np.array([row_of[photo.image] for photo in photos])
