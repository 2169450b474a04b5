# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Overviews that are drawn, and those of map_server."""

import numpy as np
import pytest

from sextant.place_maps.overview import (
    LONGER_SIDE,
    PATH,
    draw_overview,
    draw_paths,
    grid_step,
    map_server_frame,
)
from sextant.place_maps.place_map import MetricFrame, Overview

YAML = "image: {image}\nresolution: 0.05\norigin: [-1.5, 2.0, 0.1]\nnegate: 0\noccupied_thresh: 0.65\n"


def rgb(colour):
    return tuple(int(colour[i : i + 2], 16) for i in (1, 3, 5))


def test_a_drawing_has_the_shape_of_what_it_shows():
    image, resolution = draw_overview([np.array([(10, 10), (90, 40)])], 100, 50)
    assert image.size == (LONGER_SIDE, LONGER_SIDE // 2)
    assert resolution == pytest.approx(100 / LONGER_SIDE)


def test_the_path_is_drawn_where_it_was():
    image, _ = draw_overview([np.array([(10, 10), (90, 10)])], 100, 50)
    scale = LONGER_SIDE / 100
    assert image.getpixel((int(50 * scale), int(10 * scale))) == rgb(PATH)
    assert image.getpixel((int(50 * scale), int(30 * scale))) != rgb(PATH)


def test_paths_are_drawn_at_their_position_in_the_frame():
    paths = [np.array([(-20.0, 5.0), (-10.0, 5.0)]), np.array([(13.33, 31.77), (13.33, 20.0)])]
    image, frame = draw_paths(paths, "hall", 3)
    assert frame.frame == "hall" and frame.origin[2] == 0
    assert frame.origin[:2] == pytest.approx((-23, 2), abs=0.1)
    assert frame.resolution * image.width == pytest.approx(39.4) and image.width == LONGER_SIDE
    sheet = Overview("a.png", *image.size)
    for x, y, drawn in ((-15, 5, True), (13.33, 25, True), (-5, 12, False), (-15, 7, False)):
        pixel = tuple(int(each) for each in frame.pixel(sheet, x, y))
        assert (image.getpixel(pixel) == rgb(PATH)) == drawn


def test_a_long_straight_way_has_a_sheet_to_look_at():
    image, frame = draw_paths([np.array([(0.0, 7.0), (194.0, 7.0)])], "map", 3)
    assert image.size == (LONGER_SIDE, LONGER_SIDE // 4)
    assert frame.origin[:2] == pytest.approx((-3, 7 - 25))


def test_a_robot_that_stood_still_has_a_sheet():
    image, frame = draw_paths([np.zeros((2, 2))], "map", 2)
    assert image.size == (LONGER_SIDE, LONGER_SIDE) and frame.resolution == pytest.approx(4 / LONGER_SIDE)


@pytest.mark.parametrize("side, step", [(12, 1), (13, 2), (100, 10), (170, 20), (1000, 100), (0.9, 0.1)])
def test_the_grid_has_round_steps(side, step):
    assert grid_step(side) == pytest.approx(step)


@pytest.mark.parametrize("width, height", [(0, 10), (10, -1), (float("nan"), 1)])
def test_nothing_cannot_be_drawn(width, height):
    with pytest.raises(ValueError, match="cannot be drawn"):
        draw_overview([], width, height)


def test_a_map_server_map_has_a_metric_frame(tmp_path):
    (tmp_path / "floor.yaml").write_text(YAML.format(image="floor.pgm"))
    picture, frame = map_server_frame(tmp_path / "floor.yaml", "map")
    assert picture == tmp_path / "floor.pgm"
    assert frame == MetricFrame("map", 0.05, (-1.5, 2.0, 0.1))
    assert frame.position(Overview("floor.pgm", 60, 40), 0, 40) == pytest.approx((-1.5, 2.0))


@pytest.mark.parametrize(
    "text, reason",
    [
        ("[", "is not YAML"),
        ("markers: []", "image, resolution, origin missing"),
        ("text", "image, resolution, origin missing"),
        ("image: a.pgm\nresolution: x\norigin: [0, 0, 0]", "resolution must be a number"),
        ("image: a.pgm\nresolution: 1\norigin: [0, 0]", r"origin \[x, y, yaw\]"),
    ],
)
def test_another_yaml_is_refused(tmp_path, text, reason):
    (tmp_path / "floor.yaml").write_text(text)
    with pytest.raises(ValueError, match=reason):
        map_server_frame(tmp_path / "floor.yaml", "map")
