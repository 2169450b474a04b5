# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parts of a park in place of exact positions."""

import numpy as np
import pytest

from sextant.place_maps.place_clusters import clustered, clustered_by_size
from sextant.place_maps.place_map import Overview, Photo, PlaceMap

CORNERS = ((10.0, 10.0), (90.0, 10.0), (10.0, 90.0), (90.0, 90.0))


def park(seed=1):
    """Ten places around each of four corners, in random order, with two photos of every place."""
    rng = np.random.default_rng(seed)
    xy = np.concatenate([corner + rng.uniform(-5, 5, (10, 2)) for corner in CORNERS])
    photos = []
    for season in (0, 1):
        for i in rng.permutation(40):
            photos.append(Photo(100 * season + int(i), f"{season}_{i}.jpg", *map(float, xy[i]), 0.1 * i))
    return PlaceMap("", Overview("park.png", 100, 100), tuple(photos))


def corner_of(photo):
    return photo.id % 100 // 10


@pytest.mark.parametrize("merge", [lambda made: clustered(made, 4), lambda made: clustered_by_size(made, 15)])
def test_neighbours_share_the_position_of_one_of_them(merge):
    place_map = park()
    made = merge(place_map)
    assert len(made.places()) == 4
    for place in made.places():
        (corner,) = {corner_of(photo) for photo in place}
        assert len(place) == 20
        members = {(p.x, p.y) for p in place_map.photos if corner_of(p) == corner}
        assert (place[0].x, place[0].y) in members
        middle = np.mean(list(members), axis=0)
        assert np.linalg.norm(middle - (place[0].x, place[0].y)) < 3


def test_nothing_but_positions_changes():
    made = clustered(park(), 3)
    assert [(p.id, p.image, p.yaw) for p in made.photos] == [(p.id, p.image, p.yaw) for p in park().photos]
    assert clustered(park(), 40) == clustered_by_size(park(), 0) == park()


@pytest.mark.parametrize("count", range(1, 8))
def test_of_places_in_a_row_there_are_as_many_parts_as_wanted(count):
    """Equal distances are ties."""
    photos = tuple(Photo(i, f"{i}.jpg", 10.0 * i, 5.0) for i in range(7))
    assert len(clustered(PlaceMap("", Overview("a.png", 100, 100), photos), count).places()) == count


def test_no_part_is_wider_than_wanted_in_metres():
    place_map = park()
    for scale in ((1.0, 1.0), (0.5, 2.0)):
        made = clustered_by_size(place_map, 4.0, scale)
        before = {photo.id: (photo.x, photo.y) for photo in place_map.photos}
        for place in made.places():
            xy = np.array([before[photo.id] for photo in place]) * scale
            assert np.linalg.norm(xy[:, None] - xy[None], axis=2).max() <= 4.0
        assert 4 < len(made.places()) < 40


@pytest.mark.parametrize("count", [0, 41])
def test_as_many_parts_as_there_are_places_at_most(count):
    with pytest.raises(ValueError, match=f"40 places cannot be divided into {count} clusters"):
        clustered(park(), count)


@pytest.mark.parametrize("size", [-1.0, np.inf, np.nan])
def test_a_size_is_a_length(size):
    with pytest.raises(ValueError, match="size of a cluster"):
        clustered_by_size(park(), size)


def test_one_place_is_one_part():
    one = park()._replace(photos=park().photos[:1])
    assert clustered(one, 1) == clustered_by_size(one, 5.0) == one
