# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plain text files with additions that a conversion leaves out, and that the nodes' own reader refuses."""

import numpy as np
import pytest
from foreign_maps import refused

import sextant
from sextant.markers.formats.format_types import MapFormatParams
from sextant.markers.map_formats import read_map

PRINTS = MapFormatParams(family="tag36h11", size=0.2)
PLAIN = "# name Tx Ty Tz Rx Ry Rz\nId7 1 2 3 0.1 0.2 0.3\ncamera 0.1 0 1 0 0 0\n"
WITH_ADDITIONS = (
    "map 0 0.0 0 0 0 -0.0\nId7 1 2 3 0.1 0.2 0.3 0.145 # wall\r\ncamera\t0.1 0 1 0 0 0\nId8 0 0 0 0 0 0 x\n"
)


def read_lines(tmp_path, text):
    path = tmp_path / "map.txt"
    path.write_bytes(text.encode())
    return read_map(str(path), "text", PRINTS)


def test_additions_are_left_out_with_a_warning(tmp_path):
    read = read_lines(tmp_path, WITH_ADDITIONS)
    assert [(marker.id, marker.name, marker.size) for marker in read.marker_map.markers] == [
        (7, "Id7", 0.2),
        (8, "Id8", 0.2),
    ]
    np.testing.assert_array_equal(
        read.marker_map.markers[0].T_map_marker, sextant.pose_from_xyz_rpy([1, 2, 3], [0.1, 0.2, 0.3])
    )
    assert [(frame.name, frame.parent) for frame in read.marker_map.frames] == [("camera", "map")]
    assert read.warnings == [
        "line 1, the frame of the map: it has no pose in itself",
        "the eighth field, '0.145' in line 2 and 1 more: the format has 7, it is ignored",
        "the parents of the frames 'camera': set to 'map'",
    ]


def test_a_file_without_additions_has_no_such_warning(tmp_path):
    assert read_lines(tmp_path, PLAIN).warnings == ["the parents of the frames 'camera': set to 'map'"]


def test_another_frame_of_the_name_map_is_kept(tmp_path):
    """--frame names the frame of the poses, so map is a frame in it, with its pose."""
    path = tmp_path / "map.txt"
    path.write_text("map 0.5 0 0 0 0 0\n7 1 2 3 0 0 0\n")
    read = read_map(str(path), "text", MapFormatParams(frame="hall", family="tag36h11", size=0.2))
    assert [(frame.name, frame.parent) for frame in read.marker_map.frames] == [("map", "hall")]
    assert read.marker_map.frames[0].T_parent_frame[0, 3] == 0.5


@pytest.mark.parametrize(
    "text, reason",
    [
        ("7 1 2 3 0 0 0\nmap 0.5 0 0 0 0 0\n", ":2: the frame of the map, 'map', cannot have a pose"),
        ("map 0 0 0 0 0 x 1\n", ":1: 'x' is not a number"),
        ("7 1 2 3 0 0 0 1 2\n", ":1: has 9 fields, needs"),
        ("map 0 0 0 0 0 0\n\n7 1 2 3 0 0\n", ":3: has 6 fields, needs"),
        ("7 1 2 3 0 0 0 9\nId7 1 2 3 0 0 0 9\n", ":2: marker 7 (tag36h11): it is listed twice"),
    ],
)
def test_other_mistakes_are_refused_with_their_line(tmp_path, text, reason):
    assert refused(tmp_path, "map.txt", text, "text", PRINTS).startswith(reason)


@pytest.mark.parametrize("line", ["map 0 0 0 0 0 0", "7 1 2 3 0 0 0 0.2"])
def test_the_nodes_refuse_additions(tmp_path, line):
    path = tmp_path / "map.txt"
    path.write_text(line + "\n")
    with pytest.raises(RuntimeError, match="map.txt:1: "):
        sextant.read_marker_map(str(path))
