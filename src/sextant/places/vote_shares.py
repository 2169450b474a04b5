# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Mode `votes`: counts the nearest neighbours in each photo, up to the mean of their distances."""

from typing import List, NamedTuple

import numpy as np

from sextant.place_maps.place_map import Photo
from sextant.places.place_matches import MapPhotos, MatchedPhoto
from sextant.places.place_votes import MatchStatistics, count_votes, kept_matches, match_statistics


class VoteShares(NamedTuple):
    """Photos with their shares of the votes, in descending order; empty if there are too few votes."""

    photos: List[Photo]  # of the map
    shares: List[float]  # fractions of all votes
    statistics: MatchStatistics  # of the image's keypoints
    match: MatchedPhoto  # of the photo with most votes


def vote_shares(image: np.ndarray, photos: MapPhotos, min_matches: int, max_photos: int) -> VoteShares:
    """Counts the votes of an image.

    :param image: uint8, (height, width) grey or (height, width, 3) BGR
    :param min_matches: minimum number of votes
    :param max_photos: maximum number of photos returned
    """
    neighbours = photos.neighbours(image, 1)
    numbers, shares = count_votes(neighbours.distances, neighbours.numbers, min_matches, max_photos)
    weights = kept_matches(neighbours.distances, neighbours.numbers).astype(float)
    match = photos.match(neighbours, weights, numbers[0] if len(numbers) else 0)
    statistics = match_statistics(neighbours.distances, neighbours.numbers)
    return VoteShares([photos.photos[number] for number in numbers], shares.tolist(), statistics, match)
