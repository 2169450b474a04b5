# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Place maps that begin with an overview."""

import cv2
import numpy as np
import pytest
from known_drives import SIZE
from made_photos import picture
from place_map_command import CORNERS, floor_yaml, printed

from sextant.place_maps.place_map import GeoCorners, MetricFrame, Overview
from sextant.place_maps.place_map_draft import PlaceMapDraft
from sextant.place_maps.place_map_file import read_place_map


def test_a_map_of_map_server_begins_one_of_places(tmp_path, capsys):
    yaml = floor_yaml(tmp_path / "floor")
    (summary,) = printed(capsys, "image", yaml, "-o", tmp_path / "map.txt")
    assert summary == f"{tmp_path}/map.txt: no photo yet, on floor.png"
    cv2.imwrite(str(tmp_path / "a.png"), picture(1, SIZE))
    PlaceMapDraft(tmp_path / "map.txt").place("a.png", 20, 200)  # place_map_maker goes on
    made = read_place_map(tmp_path / "map.txt")
    x, y = -1 + np.cos(0.3), -3 + np.sin(0.3)
    assert made.georeference.position(made.overview, 20, 200) == pytest.approx((x, y))
    assert len(made.photos) == 1


@pytest.mark.parametrize(
    "options, place",
    [
        ([], None),
        (CORNERS, GeoCorners((55.61, 13.0), (55.6, 13.02))),
        (["--resolution", "0.1"], MetricFrame("map", 0.1, (0, 0, 0))),
        (
            ["--resolution", "0.1", "--origin=-1,2,0.5", "--frame", "hall"],
            MetricFrame("hall", 0.1, (-1, 2, 0.5)),
        ),
    ],
)
def test_the_options_give_the_position_of_an_image(tmp_path, capsys, options, place):
    cv2.imwrite(str(tmp_path / "plan.png"), picture(1, SIZE))
    printed(capsys, "image", tmp_path / "plan.png", "-o", tmp_path / "map.txt", *options)
    made = read_place_map(tmp_path / "map.txt")
    assert (made.overview, made.georeference, made.photos) == (Overview("plan.png", *SIZE), place, ())
