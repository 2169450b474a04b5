# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""VoteShares and matches of photos, against keypoints and neighbours that are laid out by hand."""

import numpy as np
import pytest
from made_photos import picture, shifted, written_photos

from sextant.place_maps.place_map import Photo
from sextant.places.place_index import IndexParams, PlaceIndex, extract_all, plain_features
from sextant.places.place_matches import MapPhotos, Neighbours
from sextant.places.vote_shares import vote_shares

PLAIN = IndexParams(plain_features("SIFT", "SIFT"), "BruteForce")


@pytest.fixture(scope="module")
def place_map(tmp_path_factory):
    return written_photos(tmp_path_factory.mktemp("map"), 6)


@pytest.fixture(scope="module")
def index(place_map):
    images = [photo.image for photo in place_map.photos]
    return PlaceIndex.built(PLAIN, images, extract_all(PLAIN, [place_map.folder / each for each in images]))


def test_photos_are_numbered_place_by_place(place_map, index):
    """The third and the first photo lie in one place: it comes first, with both."""
    first, second, third, *others = place_map.photos
    moved = place_map._replace(photos=(first, second, third._replace(x=first.x, y=first.y), *others))
    photos = MapPhotos(moved, index)
    assert [photo.id for photo in photos.photos] == [0, 2, 1, 3, 4, 5]
    assert photos.place_of.tolist() == [0, 0, 1, 2, 3, 4]
    for seed, number in enumerate([0, 2, 1, 3, 4, 5]):
        found = photos.neighbours(picture(seed), 1)
        assert (found.numbers == number).all() and (found.distances == 0).all()


def test_a_photos_matches_are_those_that_count(place_map, index):
    photos = MapPhotos(place_map, index)
    numbers = np.array([[4, 2], [2, 4], [-1, 4], [4, 1]])
    weights = np.array([[0.9, 0.1], [0.8, 0.0], [0.0, 0.3], [0.7, 0.2]])
    xy = np.array([[0.1, 0.2], [0.3, 0.4], [0.5, 0.6], [0.7, 0.8]])
    rows = np.array([[3, 0], [1, 7], [0, 5], [2, 1]])
    match = photos.match(Neighbours(xy, weights, numbers, rows), weights, 4)
    assert match.photo.id == 4
    assert match.weights.tolist() == [0.9, 0.3, 0.7]
    assert match.query_xy == pytest.approx(xy[[0, 2, 3]])
    assert match.photo_xy == pytest.approx(photos.xy(np.full(3, 4), np.array([3, 5, 2])))


def test_a_photo_that_is_not_indexed_is_refused(place_map, index):
    with pytest.raises(ValueError, match="other.png: is not in the index"):
        MapPhotos(place_map._replace(photos=(Photo(9, "other.png", 1, 1),)), index)


def test_a_photo_of_the_map_votes_for_itself_alone(place_map, index):
    """Its descriptors are in the map: every distance is 0, none is beyond the mean."""
    votes = vote_shares(picture(3), MapPhotos(place_map, index), 10, 5)
    assert [(photo.id, share) for photo, share in zip(votes.photos, votes.shares)] == [(3, 1.0)]
    assert votes.statistics.maximum == 0 and votes.statistics.kept == votes.statistics.keypoints
    assert votes.match.query_xy == pytest.approx(votes.match.photo_xy, abs=1e-3)


def test_shares_are_of_all_votes_also_of_those_left_out(place_map, index):
    image = np.where(np.arange(320) < 190, picture(1), shifted(picture(5), 0, 0))
    all_of_them, best = (vote_shares(image, MapPhotos(place_map, index), 10, count) for count in (6, 1))
    assert sum(all_of_them.shares) == pytest.approx(1)
    assert {photo.id for photo in all_of_them.photos[:2]} == {1, 5}
    assert [photo.id for photo in best.photos] == [1]
    assert best.shares == [pytest.approx(all_of_them.shares[0])]


def test_too_few_votes_are_none(place_map, index):
    votes = vote_shares(picture(3), MapPhotos(place_map, index), 10**6, 5)
    assert votes.photos == [] and votes.shares == []
    assert votes.statistics.kept > 10
