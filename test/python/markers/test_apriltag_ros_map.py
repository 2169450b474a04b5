# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import re

import pytest
import yaml
from foreign_maps import TAGS, example_map, refused

from sextant.markers.formats.format_types import MapFileError, MapFormatParams
from sextant.markers.map_formats import read_map, write_map


def test_apriltag_ros_gets_numbers_with_a_point(tmp_path):
    """It asserts that a size is a double."""
    path = tmp_path / "tags.yaml"
    write_map(example_map(sizes=(1.0, 0.05), frame="dock"), str(path), "apriltag_ros")
    (bundle,) = yaml.safe_load(path.read_text())["tag_bundles"]
    assert bundle["name"] == "dock" and [tag["size"] for tag in bundle["layout"]] == [1.0, 0.05]
    assert all(isinstance(tag["size"], float) for tag in bundle["layout"])
    assert bundle["layout"][0]["x"] == 1.0 and bundle["layout"][1]["x"] == 1e-6


def bundles(*layouts, standalone=""):
    rows = ", ".join(f"{{name: b{i}, layout: [{layout}]}}" for i, layout in enumerate(layouts))
    return f"standalone_tags: [{standalone}]\ntag_bundles: [{rows}]\n"


@pytest.mark.parametrize(
    "text, reason",
    [
        (bundles(), ":1: has no tag_bundles: standalone tags have no pose"),
        (bundles("{id: 1, size: 0.1}", ""), r":1: has several bundles, choose .* \(--bundle\): b0, b1"),
        (bundles("{id: 1}"), ":2: a tag of a bundle lacks 'size'"),
        (bundles("{id: 1, size: 0.1, roll: 3}"), ":2: 'roll' is not a name in a tag of a bundle"),
        (bundles("{id: 1, size: 0.1, qw: 0}"), ":2: the quaternion is not a rotation"),
        (bundles("{id: 1, size: 0.1, qw: .nan}"), ":2: 'qw' must be a finite number, not nan"),
        (bundles("{id: 1, size: 0.1, x: .inf}"), ":2: 'x' must be a finite number, not inf"),
        (bundles("{id: 1, size: 0.1, x: left}"), ":2: 'x' needs a number: 'left' is not a number"),
        (bundles("{id: 1, size: 0.1, x: [1]}"), r":2: 'x' must be a finite number, not \[1\]"),
        (bundles("{id: 1, size: 0.1, x: 1, x: 2}"), ":2: 'x' is defined twice"),
        (bundles("{id: 1.5, size: 0.1}"), ":2: 'id' must be a whole number, not 1.5"),
        (bundles("{id: true, size: 0.1}"), ":2: 'id' must be a whole number, not True"),
        (bundles("{id: 99999999999, size: 0.1}"), ":2: 'id' is too large for an id"),
        (
            bundles("{id: 587, size: 0.1}"),
            r":2: marker 587 \(tag36h11\): the ids of this family are 0 to 586",
        ),
        (bundles("{id: 1, size: 0}"), r":2: marker 1 \(tag36h11\): size must be in \(0, 100\] m"),
        (bundles("{id: 1, size: 0.1}, {id: 1, size: 0.1}"), r":2: marker 1 \(tag36h11\): it is listed twice"),
        (bundles("3"), ":2: 'layout' must be a list of tables"),
        (bundles(""), ": has no markers"),
        (
            bundles("{id: 1, size: 0.1}", standalone="{id: 1, size: 0.2}"),
            ":2: tag 1 has 0.1 m here and 0.2 m as",
        ),
        (bundles(standalone="{id: 1, size: 0.2}, {id: 1, size: 0.2}"), ":1: standalone tag 1 is defined"),
        ("tag_bundles: [{name: b, layout: []}, {name: b, layout: []}]", ":1: bundle 'b' is defined twice"),
        ("tag_bundles: [{name: 3, layout: []}]", ":1: 'name' must be a word, not 3"),
        ("tag_bundle: []", ":1: 'tag_bundle' is not a name in a tags.yaml"),
        ("tag_bundles: [", ":1: expected the node content|:2: expected"),
        ("tag_bundles: !!python/object:os.system []", ":1: could not determine a constructor"),
        ("a: 2001-02-31", ": is no YAML: day is out of range"),
        ("a: \x07", ": is no YAML: unacceptable character"),
        ("? [1]\n: 2", ":1: a list or table cannot be a name"),
        ("[1, 2]", ": must be a table of names and values"),
        ("", ": must be a table of names and values"),
    ],
)
def test_apriltag_ros_refuses(tmp_path, text, reason):
    assert re.match(reason, refused(tmp_path, "tags.yaml", text, "apriltag_ros", TAGS))


def test_a_bundle_is_chosen(tmp_path):
    path = tmp_path / "tags.yaml"
    path.write_text(bundles("{id: 1, size: 0.1}", "{id: 2, size: 0.1}"))
    (marker,) = read_map(str(path), "apriltag_ros", MapFormatParams(bundle="b1")).marker_map.markers
    assert marker.id == 2
    with pytest.raises(MapFileError, match="has no bundle 'b', only b0, b1"):
        read_map(str(path), "apriltag_ros", MapFormatParams(bundle="b"))


@pytest.mark.slow
def test_a_file_without_end(tmp_path):
    assert refused(tmp_path, "tags.yaml", "[" * 5000, "apriltag_ros", TAGS) == ": is nested too deeply"
