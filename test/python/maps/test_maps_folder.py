# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What localization.launch starts with a folder of maps."""

from pathlib import Path

import roslaunch.config
from simulated_observations import wall_map

import sextant
from sextant.commands.maps.maps_folder import (
    LANDMARKS,
    MARKERS,
    PLACES,
    MapPart,
    check_folder,
    detector_arguments,
    params_arguments,
    write_folder,
)

LAUNCH = Path(__file__).resolve().parents[3] / "launch/localization.launch"


def loaded(*arguments):
    """{node name}, {parameter: value} of the launch file."""
    files = [(str(LAUNCH), list(arguments))]
    config = roslaunch.config.load_config_default(files, 11311, verbose=False, assign_machines=False)
    assert not config.config_errors
    return {node.name for node in config.nodes}, {key: each.value for key, each in config.params.items()}


def written(folder, marker_map, *files, params=None):
    (folder / PLACES).parent.mkdir(parents=True)
    parts = [
        MapPart(name, "made", ["a <b>: c"], file=name if name in files else "")
        for name in (MARKERS, LANDMARKS, PLACES)
    ]
    arguments = {**detector_arguments(marker_map), **params_arguments(folder, params)} if marker_map else {}
    return write_folder(folder, "Maps", parts, arguments)


def two_sizes():
    marker_map = wall_map([(3.0, y, 1.0, 3.1) for y in (0.0, 1.0, 2.0)])
    pose = sextant.pose_from_xyz_rpy([0.0, 5.0, 1.0], [1.57, 0.0, 0.0])
    marker_map.add(sextant.MappedMarker("tag25h9", 4, 0.08, pose))
    return marker_map


def test_all_systems_of_a_folder_are_started_from_any_directory(tmp_path, monkeypatch):
    (tmp_path / "slam.yaml").write_text("max_range: 3.5\n")
    written(tmp_path / "my hall", two_sizes(), MARKERS, LANDMARKS, PLACES, params=str(tmp_path / "slam.yaml"))
    monkeypatch.chdir(tmp_path)
    nodes, params = loaded("maps:=my hall/", "start:=map")
    assert {"marker_detector", "landmark_slam", "place_localizer"} <= nodes
    folder = tmp_path / "my hall"
    assert params["/landmark_slam/marker_map_file"] == str(folder / MARKERS)
    assert params["/landmark_slam/map_file"] == str(folder / LANDMARKS)
    assert params["/place_localizer/map_file"] == str(folder / PLACES)
    assert params["/landmark_slam/start"] == "map" and params["/landmark_slam/cameras"] == ["markers"]
    assert params["/landmark_slam/max_range"] == 3.5
    assert params["/marker_detector/families"] == ["tag25h9", "tag36h11"]
    assert params["/marker_detector/marker_size"] == 0.2
    assert params["/marker_detector/marker_sizes/tag25h9/4"] == 0.08


def test_a_system_without_a_map_is_not_started(tmp_path):
    written(tmp_path / "hall", None, LANDMARKS)
    nodes, params = loaded(f"maps:={tmp_path / 'hall'}")
    assert "landmark_slam" in nodes and not {"marker_detector", "place_localizer"} & nodes
    assert "/landmark_slam/marker_map_file" not in params and "/landmark_slam/places" not in params


def test_a_folder_that_does_not_exist_yet_is_no_problem(tmp_path):
    check_folder(tmp_path / "a/b", force=False)
    assert list(tmp_path.iterdir()) == []
