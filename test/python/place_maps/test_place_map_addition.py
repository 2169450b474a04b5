# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Photos that come to a map."""

from pathlib import Path

import numpy as np
import pytest

from sextant.place_maps.place_map import Overview, Photo, PlaceMap
from sextant.place_maps.place_map_addition import NewPhoto, add_photos

OVERVIEW = Overview("park.png", 100, 50)
BEGUN = PlaceMap(Path("maps"), OVERVIEW, (Photo(4, "a.jpg", 10, 10), Photo(2, "b.jpg", 30, 10, 1.0)))


def test_ids_go_on_after_the_largest():
    made, left_out = add_photos(BEGUN, [NewPhoto("c.jpg", 50, 10), NewPhoto("d.jpg", 60, 10, -1.5)])
    assert made.photos == (*BEGUN.photos, Photo(5, "c.jpg", 50, 10), Photo(6, "d.jpg", 60, 10, -1.5))
    assert left_out == {} and made.overview == OVERVIEW


def test_a_new_map_counts_from_nought():
    made, _ = add_photos(PlaceMap(Path("maps"), OVERVIEW), [NewPhoto("c.jpg", 50, 10)])
    assert [photo.id for photo in made.photos] == [0]


def test_photos_near_a_place_are_more_images_of_it():
    new = [NewPhoto("c.jpg", 13, 14), NewPhoto("d.jpg", 26, 10, 3.0), NewPhoto("e.jpg", 14, 14)]
    made, _ = add_photos(BEGUN, new, merge=5)
    assert [[photo.image for photo in place] for place in made.places()] == [
        *(["a.jpg", "c.jpg"], ["b.jpg", "d.jpg"], ["e.jpg"])
    ]
    assert [photo.yaw for photo in made.photos] == [None, 1.0, None, 3.0, None]


def test_places_do_not_wander():
    """Each photo is near the one before, but only some are near the first."""
    made, _ = add_photos(PlaceMap(Path("maps"), OVERVIEW), [NewPhoto(f"{x}", x, 5) for x in range(10)], 3)
    assert [place[0].x for place in made.places()] == [0, 4, 8]
    assert [len(place) for place in made.places()] == [4, 4, 2]


def test_what_cannot_be_in_it_is_named():
    new = [NewPhoto("a.jpg", 50, 10), NewPhoto("c.jpg", 101, 10), NewPhoto("../d.jpg", 1, 1)]
    made, left_out = add_photos(BEGUN, new)
    assert made == BEGUN and set(left_out) == {"a.jpg", "c.jpg", "../d.jpg"}
    assert left_out["a.jpg"] == "is already in the map"
    assert "x is 101, outside the overview (0 to 100)" in left_out["c.jpg"]


@pytest.mark.parametrize("merge", [0.0, 0.01, 1.0, 2.5, 7.07, 200.0])
def test_of_many_places_the_nearest_is_found(merge):
    """As by comparing with every place that was there before; whole pixels, so that many are equally near."""
    positions = np.random.default_rng(1).integers(0, 50, (400, 2)).astype(float)
    made, _ = add_photos(BEGUN, [NewPhoto(f"{i}", *each) for i, each in enumerate(positions)], merge)
    places = [(photo.x, photo.y) for photo in BEGUN.photos]
    for photo, position in zip(made.photos[2:], positions):
        distances = np.linalg.norm(np.array(places) - position, axis=1)
        nearest = int(np.argmin(distances))
        is_near = merge > 0 and distances[nearest] <= merge
        assert (photo.x, photo.y) == (places[nearest] if is_near else tuple(position))
        places.append((photo.x, photo.y))


@pytest.mark.parametrize("x", [float("nan"), float("inf")])
def test_what_is_not_finite_is_an_unknown_place(x):
    made, left_out = add_photos(BEGUN, [NewPhoto("c.jpg", x, 10)], merge=5)
    assert made == BEGUN and "outside" in left_out["c.jpg"]
