# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Votes for photos of which the image is made."""

import numpy as np
import pytest
from made_photos import index_of, picture, shifted, written_photos

from sextant.places.index_params import IndexParams, plain_features
from sextant.places.photo_features import extract_all
from sextant.places.place_index import PlaceIndex
from sextant.places.vote_shares import VoteCounter

PLAIN = IndexParams(plain_features("SIFT", "SIFT"), "BruteForce")


@pytest.fixture(scope="module")
def place_map(tmp_path_factory):
    return written_photos(tmp_path_factory.mktemp("map"), 6)


@pytest.fixture(scope="module")
def index(place_map):
    images = [photo.image for photo in place_map.photos]
    return PlaceIndex.built(PLAIN, images, extract_all(PLAIN, [place_map.folder / each for each in images]))


def votes_of(image, place_map, index, min_matches=10, max_photos=5):
    return VoteCounter(place_map, index, min_matches, max_photos).count(image)


def test_a_photo_of_the_map_votes_for_itself_alone(place_map, index):
    """Its descriptors are in the map: every distance is 0, none is beyond the mean."""
    votes = votes_of(picture(3), place_map, index)
    assert [(photo.id, share) for photo, share in zip(votes.photos, votes.shares)] == [(3, 1.0)]
    assert votes.statistics.maximum == 0 and votes.statistics.kept == votes.statistics.keypoints
    assert votes.match.query_xy == pytest.approx(votes.match.photo_xy, abs=1e-3)


def test_shares_are_of_all_votes_also_of_those_left_out(place_map, index):
    image = np.where(np.arange(320) < 190, picture(1), shifted(picture(5), 0, 0))
    all_of_them, best = (votes_of(image, place_map, index, max_photos=count) for count in (6, 1))
    assert sum(all_of_them.shares) == pytest.approx(1)
    assert {photo.id for photo in all_of_them.photos[:2]} == {1, 5}
    assert [photo.id for photo in best.photos] == [1]
    assert best.shares == [pytest.approx(all_of_them.shares[0])]


def test_too_few_votes_are_none(place_map, index):
    votes = votes_of(picture(3), place_map, index, min_matches=10**6)
    assert votes.photos == [] and votes.shares == []
    assert votes.statistics.kept > 10


def test_an_index_without_a_matcher_is_refused(place_map):
    with pytest.raises(ValueError, match="matcher"):
        VoteCounter(place_map, index_of(place_map), 10, 5)
