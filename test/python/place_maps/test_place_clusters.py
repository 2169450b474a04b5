# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parts of a way in place of exact positions."""

import pytest

from sextant.place_maps.place_clusters import clustered
from sextant.place_maps.place_map import Overview, Photo, PlaceMap

# two photos of every place, as of two seasons
PHOTOS = tuple(
    Photo(100 * season + i, f"{season}_{i}.jpg", 10.0 * i, 5.0 * i, 0.1 * i)
    for season in (0, 1)
    for i in range(7)
)
MAP = PlaceMap("", Overview("park.png", 100, 100), PHOTOS)


def test_successive_places_share_the_position_of_the_middle_one():
    made = clustered(MAP, 2)  # of 7 places: 0-3 and 4-6
    assert {photo.x for photo in made.photos if photo.id % 100 < 4} == {20.0}
    assert {(photo.x, photo.y) for photo in made.photos if photo.id % 100 >= 4} == {(50.0, 25.0)}
    assert len(made.places()) == 2


def test_nothing_but_positions_changes():
    made = clustered(MAP, 3)
    assert [(p.id, p.image, p.yaw) for p in made.photos] == [(p.id, p.image, p.yaw) for p in PHOTOS]
    assert clustered(MAP, 7) == MAP


@pytest.mark.parametrize("count", [0, 8])
def test_as_many_parts_as_there_are_places_at_most(count):
    with pytest.raises(ValueError, match=f"7 places cannot be divided into {count} clusters"):
        clustered(MAP, count)
