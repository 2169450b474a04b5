# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import re

import numpy as np
import pytest
from foreign_maps import CORNERS, DATA, PRINTS, corners_in_map, read_file, refused, variances
from opencv_aruco import opencv_marker

import sextant
from sextant.markers.formats.format_types import MapFileError, MapFormatParams
from sextant.markers.map_formats import read_map


def test_variance_of_fiducial_slam_is_of_all_six_axes():
    read = read_file("fiducial_slam.txt")
    assert variances(read, 7) == pytest.approx([0.0004] * 6)
    assert variances(read, 8) == pytest.approx([0.0025] * 6)
    assert variances(read, 9) == pytest.approx([0] * 6)


@pytest.mark.parametrize("family", ["DICT_APRILTAG_16h5", "DICT_APRILTAG_36h11", "tag25h9"])
def test_fiducial_slam_has_apriltags_upside_down(tmp_path, family):
    """The print of OpenCV, which aruco_detect finds, is ours turned by 180 degrees."""
    options = MapFormatParams(family=family, size=0.2)
    read = read_map(str(DATA / "fiducial_slam.txt"), "fiducial_slam", options)
    for marker in read.marker_map.markers:
        np.testing.assert_allclose(corners_in_map(marker), np.roll(CORNERS[marker.id], 2, axis=0), atol=1e-8)
    modules, begin, end = sextant.marker_image(family, 7)
    name = "DICT_APRILTAG_" + sextant.canonical_family(family)[len("tag") :]
    theirs = opencv_marker(name, 7, end - begin)
    np.testing.assert_array_equal(modules[begin:end, begin:end], np.rot90(theirs, 2))


LINE = "7 1 2 3 90 0 0 0.01 12 8 9\n"


@pytest.mark.parametrize(
    "text, reason",
    [
        ("7 1 2 3 90 0 0\n", ":1: has 7 fields, needs 'id x y z roll pitch yaw variance observations links"),
        (LINE + LINE, r":2: marker 7 \(DICT_5X5_50\): it is listed twice"),
        (LINE + "\n8 1 2 nan 90 0 0 0.01 12\n", ":3: 'nan' is not a finite number"),
        ("7 1 2 3 90 0 inf 0.01 12\n", ":1: 'inf' is not a finite number"),
        ("7 1 2 3 90 0 0,1 0.01 12\n", ":1: '0,1' is not a number"),
        ("7 1 2 3 90 0 1_0 0.01 12\n", ":1: '1_0' is not a finite number"),
        ("7 1 2 3 90 0 0 -0.01 12\n", ":1: a variance cannot be negative"),
        ("7.0 1 2 3 90 0 0 0.01 12\n", ":1: '7.0' must be a whole number"),
        ("-7 1 2 3 90 0 0 0.01 12\n", ":1: '-7' must be a whole number"),
        ("7 1 2 3 90 0 0 0.01 12 x\n", ":1: 'x' must be a whole number: an id, the observations, or a link"),
        ("50 1 2 3 90 0 0 0.01 12\n", r":1: marker 50 \(DICT_5X5_50\): the ids of this family are 0 to 49"),
        ("# nothing\n\n", ": has no markers"),
    ],
)
def test_fiducial_slam_refuses(tmp_path, text, reason):
    assert re.match(reason, refused(tmp_path, "map.txt", text, "fiducial_slam", PRINTS))


def test_a_file_that_is_no_text(tmp_path):
    (tmp_path / "map.txt").write_bytes(b"7 \xff")
    with pytest.raises(MapFileError, match=r"map.txt: is no UTF-8 text \(byte 2\)"):
        read_map(str(tmp_path / "map.txt"), "fiducial_slam", PRINTS)
