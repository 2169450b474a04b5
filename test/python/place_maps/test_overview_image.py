# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Overviews as a map's folder holds them."""

import io

import numpy as np
import pytest
from made_photos import picture
from PIL import Image

from sextant.place_maps.overview_image import drawn_overview, overview_from_file, overview_from_map_server
from sextant.place_maps.place_map import GeoCorners, MetricFrame, Overview, PlaceMap

CORNERS = GeoCorners((55.61, 13.00), (55.60, 13.02))
PIXELS = picture(3, (60, 40))


def saved(path):
    path.parent.mkdir(exist_ok=True)
    Image.fromarray(PIXELS).save(path)
    return path


def decoded(content):
    return Image.open(io.BytesIO(content))


def test_an_image_in_the_folder_stays_where_it_is(tmp_path):
    taken = overview_from_file(tmp_path, saved(tmp_path / "plans" / "park.png"), CORNERS)
    assert taken == (Overview("plans/park.png", 60, 40), CORNERS, {})
    assert taken.empty_map(tmp_path) == PlaceMap(tmp_path, taken.overview, (), CORNERS)


def test_an_image_elsewhere_is_copied(tmp_path):
    path = saved(tmp_path / "plans" / "park.jpg")
    taken = overview_from_file(tmp_path / "map", path, None)
    assert taken == (Overview("park.jpg", 60, 40), None, {"park.jpg": path.read_bytes()})


@pytest.mark.parametrize("suffix", [".pgm", ".tif", ".bmp"])
def test_what_browsers_do_not_show_is_copied_as_png(tmp_path, suffix):
    taken = overview_from_file(tmp_path, saved(tmp_path / f"floor{suffix}"), None)
    assert taken.overview == Overview("floor.png", 60, 40)
    copy = decoded(taken.files["floor.png"])
    assert copy.format == "PNG"
    np.testing.assert_array_equal(np.asarray(copy), PIXELS)


def test_the_image_of_map_server_brings_its_frame(tmp_path):
    saved(tmp_path / "maps" / "floor.pgm")
    yaml = tmp_path / "maps" / "floor.yaml"
    yaml.write_text("image: floor.pgm\nresolution: 0.05\norigin: [-1.5, 2.0, 0.1]\n")
    taken = overview_from_map_server(tmp_path, yaml, "hall")
    assert taken.georeference == MetricFrame("hall", 0.05, (-1.5, 2.0, 0.1))
    assert taken.overview == Overview("floor.png", 60, 40) and list(taken.files) == ["floor.png"]


def test_a_drawing_has_its_name_and_size():
    drawn = drawn_overview("map.png", Image.fromarray(PIXELS), CORNERS)
    assert drawn.overview == Overview("map.png", 60, 40)
    np.testing.assert_array_equal(np.asarray(decoded(drawn.files["map.png"])), PIXELS)


def test_a_damaged_image_is_refused(tmp_path):
    path = saved(tmp_path / "floor.pgm")
    path.write_bytes(path.read_bytes()[:-100])
    with pytest.raises(ValueError, match="floor.pgm: cannot be converted to PNG"):
        overview_from_file(tmp_path, path, None)
