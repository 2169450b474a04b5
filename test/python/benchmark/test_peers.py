# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Other packages that Sextant works with, really run: what is not installed is skipped."""

import pytest
import rospkg
from quick_run import topics_of

INSTALLED = set(rospkg.RosPack().list())
REQUIRED = {"markers": [], "navigation": ["move_base", "map_server"], "corridor": ["robot_localization"]}


def needs(*packages):
    missing = ", ".join(sorted(set(packages) - INSTALLED))
    return [pytest.mark.slow, pytest.mark.skipif(bool(missing), reason=f"rospack does not find {missing}")]


@pytest.fixture(scope="module")
def rows():
    """Rows by name of the table of each topic whose packages are installed, of one quick run."""
    topics = [topic for topic, packages in REQUIRED.items() if set(packages) <= INSTALLED]
    tables = topics_of("peers.py", "--only", ",".join(topics))
    return {topic: {row["name"]: row for row in table["rows"]} for topic, (table,) in tables.items()}


@pytest.mark.parametrize(
    "name, centimetres",
    [
        # Metres off if the marker frame of the package, or the format of its map, were converted wrongly
        pytest.param("apriltag_ros, one bundle", 10.0, marks=needs("apriltag_ros")),
        pytest.param("apriltag_ros and marker_locator", 10.0, marks=needs("apriltag_ros")),
        pytest.param("aruco_ros, mean of all markers", 10.0, marks=needs("aruco_ros")),
        pytest.param("aruco_ros and marker_locator", 10.0, marks=needs("aruco_ros")),
        pytest.param("fiducials", 50.0, marks=needs("aruco_detect", "fiducial_slam")),
        pytest.param("fiducials and marker_locator", 50.0, marks=needs("aruco_detect", "fiducial_slam")),
    ],
)
def test_other_detectors_locate_the_robot_in_a_converted_map(rows, name, centimetres):
    row, family = rows["markers"][name], "DICT_4X4_50" if name.startswith("fiducials") else "tag36h11"
    ours = rows["markers"][f"Sextant, {family}"]
    assert row["poses, %"]["value"] > 0.9 * ours["poses, %"]["value"]
    assert ours["error, cm: mean"]["value"] < row["error, cm: mean"]["value"] < centimetres


@pytest.mark.parametrize("topic", [pytest.param("corridor", marks=needs(*REQUIRED["corridor"]))])
def test_the_filters_are_right_again_after_the_corridor(rows, topic):
    for row in rows[topic].values():
        assert row["1 s after it, m"]["value"] < 0.1


@pytest.mark.parametrize("topic", [pytest.param("navigation", marks=needs(*REQUIRED["navigation"]))])
def test_move_base_reaches_its_goals(rows, topic):
    for row in rows[topic].values():
        assert row["reached within 10 cm"]["value"] == row["goals"]["value"]
