# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The experience map's file: what older programs wrote is read, and what they read is written."""

import pytest

from sextant.place_maps.place_map import GeoCorners, MetricFrame, Overview, Photo, PlaceMap
from sextant.place_maps.place_map_file import read_place_map, write_place_map

OLD = "park.png;400;200\n0;a.jpg;10;20\n3;b c.jpg;10.5;20\n"
PHOTOS = (Photo(0, "a.jpg", 10, 20), Photo(3, "b c.jpg", 10.5, 20))


@pytest.fixture
def file(tmp_path):
    return tmp_path / "park.txt"


def read(file, text):
    file.write_text(text, encoding="utf-8")
    return read_place_map(file)


def old_reader(text):
    """As a program does that knows only the first fields of each line."""
    first, *lines = (line.split(";") for line in text.splitlines())
    return tuple(first[:3]), [tuple(line[:4]) for line in lines]


def test_an_old_file_is_read(file):
    assert read(file, OLD) == PlaceMap(file.parent, Overview("park.png", 400, 200), PHOTOS)


@pytest.mark.parametrize(
    "change", [("\n", "\r\n"), ("20\n", "20;\n"), ("\n0", "\n\n0"), ("park", "\ufeffpark")]
)
def test_what_editors_do_to_it_changes_nothing(file, change):
    assert read(file, OLD.replace(*change)).photos == PHOTOS


def test_a_yaw_is_read(file):
    assert read(file, "p.png;9;9\n1;a.jpg;1;2;yaw=-0.5\n").photos == (Photo(1, "a.jpg", 1, 2, -0.5),)


@pytest.mark.parametrize(
    "georeference, text",
    [
        (MetricFrame("map", 0.05, (-1.5, 2, 0.1)), "frame=map;resolution=0.05;origin=-1.5,2,0.1"),
        (GeoCorners((55.61, 13), (55.6, 13.02)), "north_west=55.61,13;south_east=55.6,13.02"),
    ],
)
def test_the_header_has_the_georeference(file, georeference, text):
    assert read(file, f"park.png;400;200;{text}\n").georeference == georeference
    write_place_map(file, PlaceMap(file.parent, Overview("park.png", 400, 200), PHOTOS, georeference))
    assert file.read_text() == OLD.replace("200\n", f"200;{text}\n", 1)
    assert old_reader(file.read_text()) == old_reader(OLD)


def test_a_written_map_is_read_bit_for_bit(file):
    photos = (Photo(7, "ä.jpg", 1 / 3, 199.99999999999997, -3e-7),)
    written = PlaceMap(file.parent, Overview("park.png", 400, 200), photos)
    write_place_map(file, written)
    assert read_place_map(file) == written


@pytest.mark.parametrize(
    "line, reason",
    [
        ("4;c.jpg;1", "4: 3 fields, expected id;image;x;y"),
        ("0;c.jpg;1;1", "4: duplicate id 0, see line 2"),
        ("9;a.jpg;1;1", "4: duplicate image a.jpg, see line 2"),
        ("x;c.jpg;1;1", "4: id is 'x', not a whole number"),
        ("4.0;c.jpg;1;1", "4: id is '4.0', not a whole number"),
        ("-4;c.jpg;1;1", "4: id is '-4', not a whole number"),
        ("4;c.jpg;1,5;1", "4: x is '1,5', not a number"),
        ("4;c.jpg;1;900", "4: photo 4: y is 900, outside the overview"),
        ("4;c.jpg;1;nan", "4: photo 4: y is nan, outside the overview"),
        ("4;../c.jpg;1;1", "4: image '../c.jpg' is outside of the map's folder"),
        ("4;;1;1", "4: an image has no file name"),
        ("4;c.jpg;1;1;2", "4: '2' is not a field, allowed are yaw="),
        ("4;c.jpg;1;1;yaw=1;yaw=2", "4: duplicate field yaw"),
        ("4;c.jpg;1;1;yaw=north", "4: yaw is 'north', not a number"),
    ],
)
def test_a_wrong_line_is_refused_with_its_number(file, line, reason):
    with pytest.raises(ValueError) as error:
        read(file, OLD + line + "\n")
    assert str(error.value).startswith(f"{file}:{reason}")


@pytest.mark.parametrize(
    "line, reason",
    [
        ("", "1: the first line must be overview.png;width;height"),
        ("park.png;400", "1: the first line must be overview.png;width;height"),
        ("park.png;400;0", "1: height is 0"),
        ("park.png;400.5;200", "1: width is '400.5', not a whole number"),
        (
            "park.png;400;200;frame=map",
            "1: the fields after the size must be all of (frame, resolution, origin) or (north_west",
        ),
        ("park.png;400;200;scale=2", "1: 'scale=2' is not a field"),
        ("park.png;400;200;north_west=1;south_east=0,1", "1: north_west is '1', expected latitude,longitude"),
        ("park.png;400;200;north_west=1,1;south_east=2,2", "1: north_west must be north of south_east"),
    ],
)
def test_a_wrong_header_is_refused(file, line, reason):
    with pytest.raises(ValueError) as error:
        read(file, line + "\n")
    assert str(error.value).startswith(f"{file}:{reason}")


def test_bytes_that_are_no_text_are_refused(file):
    file.write_bytes(b"\xff\xd8\xff\xe0")
    with pytest.raises(ValueError, match="is not UTF-8 text"):
        read_place_map(file)


def test_a_map_that_cannot_be_is_not_written(file):
    file.write_text(OLD)
    with pytest.raises(ValueError, match="duplicate photo id 0"):
        write_place_map(file, PlaceMap(file.parent, Overview("park.png", 400, 200), (PHOTOS[0], PHOTOS[0])))
    assert file.read_text() == OLD


def test_a_map_lies_beside_its_photos(file, tmp_path):
    with pytest.raises(ValueError, match="the map must be in"):
        write_place_map(tmp_path / "other.txt", PlaceMap(tmp_path / "photos", Overview("park.png", 4, 2)))
