# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The experience map: positions in pixels, metres and degrees, and what cannot be one."""

import math
from pathlib import Path

import pytest

from sextant.place_maps.place_map import GeoCorners, MetricFrame, Overview, Photo, PlaceMap

OVERVIEW = Overview("park.png", 400, 200)
PHOTOS = (Photo(0, "a.jpg", 10, 20), Photo(3, "b.jpg", 10, 20, 1.0), Photo(2, "c/d.jpg", 400, 200))
# Malmö's 13th meridian, a box of 0.01 by 0.02 degrees
CORNERS = GeoCorners((55.61, 13.00), (55.60, 13.02))


def place_map(**changed):
    return PlaceMap(Path("/maps"), OVERVIEW, PHOTOS)._replace(**changed)


def test_photos_at_one_spot_are_one_place():
    assert [[photo.id for photo in place] for place in place_map().places()] == [[0, 3], [2]]


def test_images_are_relative_to_the_map():
    assert place_map().path(PHOTOS[2]) == Path("/maps/c/d.jpg")


def test_the_origin_is_the_lower_left_corner_as_with_map_server():
    frame = MetricFrame("map", 0.05, (-1.0, 2.0, 0.0))
    assert frame.position(OVERVIEW, 0, 200) == pytest.approx((-1.0, 2.0))
    assert frame.position(OVERVIEW, 400, 0) == pytest.approx((-1.0 + 20.0, 2.0 + 10.0))


def test_a_turned_frame_turns_counterclockwise():
    frame = MetricFrame("map", 0.1, (5.0, 0.0, math.pi / 2))
    assert frame.position(OVERVIEW, 100, 200) == pytest.approx((5.0, 10.0))  # right is the frame's +y
    assert frame.position(OVERVIEW, 0, 100) == pytest.approx((-5.0, 0.0))  # up is its -x
    assert frame.yaw(math.pi / 4) == pytest.approx(3 * math.pi / 4)
    assert frame.yaw(math.pi) == pytest.approx(-math.pi / 2)
    assert -math.pi < frame.yaw(math.pi / 2) <= math.pi


@pytest.mark.parametrize("x, y", [(0, 0), (123.5, 67.25), (400, 200)])
def test_there_and_back(x, y):
    frame = MetricFrame("map", 0.05, (-1.0, 2.0, 0.7))
    assert frame.pixel(OVERVIEW, *frame.position(OVERVIEW, x, y)) == pytest.approx((x, y))
    assert CORNERS.pixel(OVERVIEW, *CORNERS.coordinates(OVERVIEW, x, y)) == pytest.approx((x, y))


def test_corners_are_the_images():
    assert CORNERS.coordinates(OVERVIEW, 0, 0) == pytest.approx((55.61, 13.00))
    assert CORNERS.coordinates(OVERVIEW, 400, 200) == pytest.approx((55.60, 13.02))
    assert CORNERS.coordinates(OVERVIEW, 100, 50) == pytest.approx((55.6075, 13.005))


def test_a_right_map_is_let_through():
    place_map().check()
    place_map(georeference=CORNERS).check()
    place_map(georeference=MetricFrame("map", 0.05, (0, 0, 0)), photos=()).check()


@pytest.mark.parametrize(
    "photo, reason",
    [
        (Photo(0, "c.jpg", 1, 1), "duplicate photo id 0: a.jpg and c.jpg"),
        (Photo(9, "a.jpg", 1, 1), "duplicate image a.jpg: photos 0 and 9"),
        (Photo(-1, "c.jpg", 1, 1), "id is -1, allowed are 0 to 2147483647"),
        (Photo(2**31, "c.jpg", 1, 1), "id is 2147483648"),
        (Photo(9, "", 1, 1), "an image has no file name"),
        (Photo(9, "../c.jpg", 1, 1), r"'\.\./c.jpg' is outside of the map's folder"),
        (Photo(9, "/c.jpg", 1, 1), "'/c.jpg' is outside of the map's folder"),
        (Photo(9, "c;d.jpg", 1, 1), "';', line ends and blanks at the ends are not allowed"),
        (Photo(9, "c.jpg ", 1, 1), "blanks at the ends"),
        (Photo(9, "c.jpg", 400.5, 1), r"photo 9: x is 400.5, outside the overview \(0 to 400\)"),
        (Photo(9, "c.jpg", 1, -1), r"photo 9: y is -1, outside the overview \(0 to 200\)"),
        (Photo(9, "c.jpg", math.nan, 1), "photo 9: x is nan"),
        (Photo(9, "c.jpg", 1, 1, math.inf), "photo 9: yaw is inf, not finite"),
    ],
)
def test_a_photo_that_cannot_be(photo, reason):
    with pytest.raises(ValueError, match=reason):
        place_map(photos=(*PHOTOS, photo)).check()


@pytest.mark.parametrize(
    "georeference, reason",
    [
        (MetricFrame("", 0.1, (0, 0, 0)), "frame is '', not a valid"),
        (MetricFrame("/map", 0.1, (0, 0, 0)), "frame is '/map', not a valid"),
        (MetricFrame("map", 0, (0, 0, 0)), "resolution is 0"),
        (MetricFrame("map", 0.1, (0, 0, math.nan)), "origin is .* not finite"),
        (GeoCorners((91, 13), (55, 14)), "north_west is 91,13"),
        (GeoCorners((55, 13), (55, 14)), "north of south_east"),
        (GeoCorners((55, 13), (54, 13)), "west of south_east"),
    ],
)
def test_a_georeference_that_cannot_be(georeference, reason):
    with pytest.raises(ValueError, match=reason):
        place_map(georeference=georeference).check()


def test_an_overview_has_a_size():
    with pytest.raises(ValueError, match="height is 0"):
        place_map(overview=Overview("park.png", 400, 0)).check()
