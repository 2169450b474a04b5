# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The photos of a map by place, and matches of keypoints that are laid out by hand."""

import numpy as np
import pytest
from made_photos import index_of, written_photos

from sextant.place_maps.place_map import Photo
from sextant.places.descriptor_codes import DescriptorCodes
from sextant.places.photo_keypoints import UNIT, CodedKeypoints, PhotoKeypoints
from sextant.places.place_matches import MapPhotos, matched_photo


@pytest.fixture(scope="module")
def place_map(tmp_path_factory):
    return written_photos(tmp_path_factory.mktemp("map"), 6)


@pytest.fixture(scope="module")
def index(place_map):
    return index_of(place_map)


def test_photos_are_numbered_place_by_place(place_map, index):
    """The third and the first photo lie in one place: it comes first, with both."""
    first, second, third, *others = place_map.photos
    moved = place_map._replace(photos=(first, second, third._replace(x=first.x, y=first.y), *others))
    photos = MapPhotos(moved, index)
    assert [photo.id for photo in photos.photos] == [0, 2, 1, 3, 4, 5]
    assert photos.place_of.tolist() == [0, 0, 1, 2, 3, 4]
    assert photos.rows.tolist() == [0, 2, 1, 3, 4, 5]
    assert photos.shares == pytest.approx([0.1, 0.1, 0.2, 0.2, 0.2, 0.2])


def test_photos_are_near_within_some_spacings_and_a_share_of_the_map(place_map, index):
    assert MapPhotos(place_map, index).near(np.array([2]))[0].tolist() == [0, 1, 1, 1, 0, 0]
    far = place_map.photos[5]._replace(x=1e4)
    photos = MapPhotos(place_map._replace(photos=(*place_map.photos[:5], far)), index)
    assert photos.near(np.array([0, 5])).tolist() == [[1, 1, 1, 1, 1, 0], [0, 0, 0, 0, 0, 1]]


def test_a_photo_that_is_not_indexed_is_refused(place_map, index):
    with pytest.raises(ValueError, match="other.png: is not in the index"):
        MapPhotos(place_map._replace(photos=(Photo(9, "other.png", 1, 1),)), index)


def test_matches_are_mutual_and_nearer_than_the_background():
    codes = np.array([[0], [50], [0], [10], [100]], np.int8)  # the last three: of the second photo
    positions = np.array([[0, 1], [2, 3], [4, 5], [6, 7], [8, 9]], np.uint16)
    coder = DescriptorCodes(np.zeros(1, np.float32), np.ones((1, 1), np.float32))
    keypoints = PhotoKeypoints(coder, positions, codes, [2, 3])
    here = np.array([[11, 12], [13, 14], [15, 16], [17, 18]], np.uint16)
    image = CodedKeypoints(here, np.array([[1], [2], [12], [80]], np.int8))
    found = matched_photo(Photo(7, "b.png", 0, 0), image, keypoints, 1, np.array([4.0, 4.0, 4.0, 16.0]))
    assert found.photo.id == 7
    assert (found.query_xy * UNIT).tolist() == [[11, 12], [15, 16]]  # the last one is beyond its background
    assert (found.photo_xy * UNIT).tolist() == [[4, 5], [6, 7]]
    assert found.weights == pytest.approx([0.75, 0.5])
