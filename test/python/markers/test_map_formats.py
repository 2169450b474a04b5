# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Maps of other packages, against corners that were worked out by hand (test/data/map_formats/README.md)."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from foreign_maps import CORNERS, DATA, FILES, corners_in_map, example_map, read_file

import sextant
from sextant.markers.formats.format_types import MapFileError, MapFormatParams, decimal
from sextant.markers.map_formats import FORMATS, guess_read_format, guess_write_format, read_map, write_map

# ---- known answers --------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", FILES)
def test_corners_are_where_they_hang(name):
    read = read_file(name)
    assert [marker.id for marker in read.marker_map.markers] == list(CORNERS)
    for marker in read.marker_map.markers:
        np.testing.assert_allclose(corners_in_map(marker), CORNERS[marker.id], atol=1e-8)
    family = sextant.canonical_family(FILES[name][1].family or "tag36h11")
    assert {(each.family, each.size) for each in read.marker_map.markers} == {(family, 0.2)}
    assert read.marker_map.frame == "map"


@pytest.mark.parametrize(
    "name, parts",
    [
        ("fiducial_slam.txt", ["the number of observations of each marker", "one variance for all six"]),
        ("tags.yaml", ["standalone tags 30"]),
        ("tagslam.yaml", ["plane_measurements", "the prints of 9 show another id"]),
        ("poses.yaml", ["the uncertainty of the tags 9", "ROS 1 writes the noise of tagslam.yaml"]),
    ],
)
def test_content_that_a_map_cannot_represent_is_reported(name, parts):
    warnings = read_file(name).warnings
    assert len(warnings) == len(parts)
    for warning, part in zip(warnings, parts):
        assert part in warning


def test_decimals_are_numbers_to_yaml():
    for value in (1.0, 1e-5, -0.0, 0.1, 1e22, 123456.789):
        assert yaml.safe_load(decimal(value)) == value
        assert isinstance(yaml.safe_load(decimal(value)), float)
    assert decimal(-0.0) == "0.0"


# ---- round trips ----------------------------------------------------------------------------------------


def assert_same(one, two):
    assert [(each.family, each.id, each.size) for each in one.markers] == [
        (each.family, each.id, each.size) for each in two.markers
    ]
    for ours, theirs in zip(one.markers, two.markers):
        np.testing.assert_allclose(ours.T_map_marker, theirs.T_map_marker, atol=1e-12)


TRIPS = {
    "yaml": ("map.yaml", {}, "tag36h11"),
    "text": ("map.txt", dict(family="tag36h11", size=0.2), "tag36h11"),
    "fiducial_slam": ("map.txt", dict(family="DICT_APRILTAG_36h11", size=0.2), "tag36h11"),
    "apriltag_ros": ("tags.yaml", dict(family="tagStandard41h12"), "tagStandard41h12"),
    "tagslam": ("tagslam.yaml", {}, "tag36h11"),
}


@pytest.mark.parametrize("name", FORMATS)
def test_round_trip(tmp_path, name):
    file, options, family = TRIPS[name]
    path = str(tmp_path / file)
    written = example_map(family=family)
    write_map(written, path, name)
    assert guess_read_format(path) == name
    assert_same(written, read_map(path, name, MapFormatParams(**options)).marker_map)


@pytest.mark.parametrize("name", ["yaml", "fiducial_slam", "tagslam"])
def test_round_trip_of_a_covariance(tmp_path, name):
    file, options, _ = TRIPS[name]
    path = str(tmp_path / file)
    warnings = write_map(example_map(exact=False), path, name)
    assert not any("covariance" in warning for warning in warnings)
    for marker in read_map(path, name, MapFormatParams(**options)).marker_map.markers:
        np.testing.assert_allclose(marker.covariance, 0.0025 * np.eye(6), atol=1e-12)


def test_frame_is_the_one_that_is_asked_for():
    read = read_map(str(DATA / "tags.yaml"), "apriltag_ros", MapFormatParams(frame="dock", bundle="room"))
    assert read.marker_map.frame == "dock"


def with_extras(tmp_path):
    """A map with a frame that is no marker, a name, and a covariance that is not the same along all axes."""
    path = tmp_path / "extras.yaml"
    path.write_text(
        "frame: hall\nmarkers:\n"
        "  - {family: tag36h11, id: 7, size: 0.2, position: [1, 2, 3], rpy: [0, 0, 0], name: door_7,"
        " covariance: [4, 1, 0, 0, 0, 0, 1, 4, 0, 0, 0, 0, 0, 0, 4, 0, 0, 0,"
        " 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1]}\n"
        "frames:\n  - {name: camera, parent: base_link, position: [0, 0, 1], rpy: [0, 0, 0]}\n"
    )
    return sextant.read_marker_map(str(path))


@pytest.mark.parametrize(
    "name, parts",
    [
        (
            "text",
            ["family: tag36h11, size: 0.2, frame: hall, parents: {'camera': 'base_link'}", "covariance"],
        ),
        ("fiducial_slam", ["dictionary: 20, fiducial_len: 0.2, fiducial_slam map_frame: hall", "1 covar"]),
        ("apriltag_ros", ["tag_family: tag36h11", "the covariance of marker 'door_7'"]),
        ("tagslam", ["tag36h11; the frame: set fixed_frame_id: hall", "of 1 covariances"]),
    ],
)
def test_content_that_is_lost_in_writing_is_reported(tmp_path, name, parts):
    if name != "text":
        parts = [*parts, "the name of marker 'door_7'", "not markers: 'camera'"]
    warnings = write_map(with_extras(tmp_path), str(tmp_path / ("out" + Path(TRIPS[name][0]).suffix)), name)
    assert len(warnings) == len(parts), warnings
    for warning, part in zip(warnings, parts):
        assert part in warning


def test_text_keeps_frames_and_names(tmp_path):
    path = str(tmp_path / "map.txt")
    write_map(with_extras(tmp_path), path, "text")
    read = read_map(path, "text", MapFormatParams(family="tag36h11", size=0.2, frame="hall"))
    assert [marker.name for marker in read.marker_map.markers] == ["door_7"]
    assert [frame.name for frame in read.marker_map.frames] == ["camera"]
    assert read.warnings == ["the parents of the frames 'camera': set to 'hall'"]


# ---- what is refused ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name, options, reason",
    [
        ("fiducial_slam", {}, "does not contain the markers' family and size: set --family and --size"),
        ("text", dict(size=0.2), "text does not contain the markers' family: set --family"),
        (
            "fiducial_slam",
            dict(family="tagCircle21h7", size=0.2),
            "aruco_detect does not know tagCircle21h7, only",
        ),
        ("fiducial_slam", dict(family="tag36h12", size=0.2), "unknown marker family 'tag36h12'; known are"),
        ("fiducial_slam", dict(family="tag36h11", size=0.0), r"--size must be in \(0, 100\] m, not 0"),
        (
            "fiducial_slam",
            dict(family="tag36h11", size=float("nan")),
            r"--size must be in \(0, 100\] m, not nan",
        ),
        ("apriltag_ros", dict(size=0.2), "apriltag_ros does not use --size"),
        ("apriltag_ros", dict(family="DICT_4X4_50"), "apriltag_ros does not know DICT_4X4_50, only"),
        ("apriltag_ros", dict(frame="/map"), "--frame: '/map' cannot name a tf frame"),
        ("apriltag_ros", dict(frame="a b"), "--frame: 'a b' cannot name a tf frame"),
        ("apriltag_ros", dict(frame=""), "--frame: '' cannot name a tf frame"),
        ("tagslam", dict(family="DICT_4X4_50"), "tagslam has AprilTags only, not DICT_4X4_50"),
        ("yaml", dict(frame="map", family="tag36h11"), "yaml does not use --family and --frame"),
    ],
)
def test_options_that_are_refused(name, options, reason):
    with pytest.raises(MapFileError, match=reason):
        read_map(str(DATA / "tags.yaml"), name, MapFormatParams(**options))


def several_families():
    marker_map = example_map()
    marker_map.add(sextant.MappedMarker("DICT_4X4_50", 1, 0.2, np.eye(4)))
    return marker_map


@pytest.mark.parametrize(
    "name, marker_map, reason",
    [
        ("fiducial_slam", several_families(), "has one family per map, this map has DICT_4X4_50, tag36h11"),
        ("apriltag_ros", several_families(), "has one family per map"),
        ("tagslam", several_families(), "has one family per map"),
        ("text", several_families(), "cannot represent marker 'tag36h11/3': it is of family tag36h11"),
        ("fiducial_slam", example_map(sizes=(0.2, 0.1)), "has one size per map, this map has 0.1 m, 0.2 m"),
        ("text", example_map(sizes=(0.2, 0.1)), "cannot represent marker 'tag36h11/4': its size is 0.1 m"),
        ("fiducial_slam", example_map(family="tagCircle21h7"), "fiducial_slam does not know tagCircle21h7"),
        ("apriltag_ros", example_map(family="DICT_4X4_50"), "apriltag_ros does not know DICT_4X4_50"),
        ("tagslam", example_map(family="DICT_4X4_50"), "tagslam does not know DICT_4X4_50"),
        *((name, sextant.MarkerMap(), "the map has no markers") for name in FORMATS if name != "yaml"),
    ],
)
def test_maps_that_a_format_cannot_hold(tmp_path, name, marker_map, reason):
    with pytest.raises(MapFileError, match=reason):
        write_map(marker_map, str(tmp_path / TRIPS[name][0]), name)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", FORMATS)
def test_a_file_that_cannot_be_written(tmp_path, name):
    with pytest.raises(MapFileError, match="cannot be written: No such file"):
        write_map(example_map(), str(tmp_path / "nowhere" / TRIPS[name][0]), name)


@pytest.mark.parametrize("name", FORMATS)
def test_a_file_that_cannot_be_read(tmp_path, name):
    file, options, _ = TRIPS[name]
    with pytest.raises(MapFileError, match="cannot be read: No such file"):
        read_map(str(tmp_path / file), name, MapFormatParams(**options))


@pytest.mark.parametrize("name", FILES)
def test_half_a_file_is_read_as_such_or_refused(tmp_path, name):
    """Nothing but MapFileError, wherever it is cut off; and no marker is other than in the whole."""
    text = (DATA / name).read_text()
    path = tmp_path / name
    for length in range(0, len(text), 37):
        path.write_text(text[:length])
        try:
            read = read_map(str(path), *FILES[name])
        except MapFileError:
            continue
        for marker in read.marker_map.markers:
            np.testing.assert_allclose(corners_in_map(marker)[0], CORNERS[marker.id][0], atol=1e-8)


# ---- guesses --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "file, text, name",
    [
        ("m.txt", "# a map\n7 1 2 3 0 0 0\n", "text"),
        ("m.txt", "map 0 0 0 0 0 0\n7 1 2 3 0 0 0 0.2\n", "text"),
        ("m", "7 1 2 3 0 0 0 0.01 4\n", "fiducial_slam"),
        ("m.yml", "frame: map\nmarkers: []\n", "yaml"),
        ("m.yaml", "standalone_tags: []\n", "apriltag_ros"),
        ("m.yaml", "bodies: []\n", "tagslam"),
    ],
)
def test_format_is_seen(tmp_path, file, text, name):
    (tmp_path / file).write_text(text)
    assert guess_read_format(str(tmp_path / file)) == name


@pytest.mark.parametrize(
    "file, text",
    [
        ("m.txt", "7 1 2 3 0 0 0\n8 1 2 3 0 0 0 0.01 4\n"),
        ("m.txt", "7 1 2 3 0 0\n"),
        ("m.txt", "# nothing\n"),
        ("m.yaml", "cam0: {pose: 1}\n"),
        ("m.yaml", "bodies: []\nmarkers: []\n"),
    ],
)
def test_format_is_asked_for(tmp_path, file, text):
    (tmp_path / file).write_text(text)
    with pytest.raises(MapFileError, match="name the format: --from"):
        guess_read_format(str(tmp_path / file))


def test_format_to_write():
    assert guess_write_format("a/map.yaml") == guess_write_format("map.yml") == "yaml"
    with pytest.raises(MapFileError, match="the ending does not define the format; set --to yaml"):
        guess_write_format("map.txt")
    with pytest.raises(MapFileError, match="is a file name of apriltag_ros; set --to apriltag_ros"):
        guess_write_format("config/tags.yaml")


@pytest.mark.parametrize("name, file", [("yaml", "map.txt"), ("text", "map.yaml")])
def test_sextant_recognizes_its_own_formats_by_the_ending(tmp_path, name, file):
    with pytest.raises(MapFileError, match="rename it"):
        write_map(example_map(), str(tmp_path / file), name)
    with pytest.raises(MapFileError, match="rename it"):
        read_map(str(tmp_path / file), name, MapFormatParams(**TRIPS[name][1]))
