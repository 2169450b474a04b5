# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""From one drive to the maps of all systems, in the frame of a known marker of the hall."""

from pathlib import Path

import hall_drives as hall
import numpy as np
import pytest
from html_page import Page
from landmark_bags import planar
from written_bags import START

import sextant
from sextant.commands.maps.map_all import main
from sextant.place_maps.photo_poses import read_photo_poses
from sextant.place_maps.place_map_file import read_place_map

CHI_6 = 22.5  # exceeded by one of 1000, six degrees of freedom


@pytest.fixture(scope="module")
def known(tmp_path_factory):
    """A map of one marker of the hall."""
    path = tmp_path_factory.mktemp("known") / "door.yaml"
    door = sextant.MarkerMap("hall")
    door.add(hall.WALLS.find("tag36h11", 0))
    sextant.write_marker_map(door, str(path))
    return str(path)


def mapped(folder, known, *systems, seconds=20.0):
    """The folder of the maps of a drive with these systems."""
    bag = hall.write_hall(folder / "drive.bag", seconds, systems=systems)
    out = folder / "hall"
    assert main([bag, "-o", str(out), "--known", known]) == 0
    return out


def own_landmarks(path):
    """(class, position) of the landmarks that are no markers."""
    made = sextant.read_landmark_map(str(path))
    return [
        (label.class_name, each.position)
        for label, each in zip(made.labels, made.landmarks)
        if label.id is None
    ]


@pytest.mark.slow
def test_all_maps_of_a_drive_are_those_of_the_hall(tmp_path, known, capsys):
    out = mapped(tmp_path, known, "markers", "landmarks", "photos", seconds=24.0)
    check_markers(sextant.read_marker_map(str(out / "markers.yaml")))
    assert sextant.read_landmark_map(str(out / "landmarks.yaml")).frame == "hall"
    found = own_landmarks(out / "landmarks.yaml")
    assert len(found) >= 5 and max(distance(*each) for each in found) < 0.15
    check_photos(out / "places/map.txt")
    text = capsys.readouterr().out
    assert "photos of" in text and "no map" not in text
    page = Page((out / "index.html").read_text())
    links = [value for name, value in page.attributes if name == "href"]
    assert links == ["markers.html", "landmarks.html"] and all((out / link).is_file() for link in links)


def distance(class_name, position):
    """Of a landmark from the nearest pillar of its class."""
    same = hall.PILLARS[[each == class_name for each in hall.CLASSES]]
    return np.hypot(*(same - position).T).min()


def check_markers(made):
    assert made.frame == "hall" and len(made.markers) >= 8
    for marker in made.markers[1:]:
        truth = hall.WALLS.find(marker.family, marker.id).T_map_marker
        error = sextant.pose_error(truth, marker.T_map_marker)
        assert np.linalg.norm(error[:3]) < 0.15 and error @ np.linalg.solve(marker.covariance, error) < CHI_6


def check_photos(path):
    """Their poses are those of the camera at their stamps."""
    place_map, poses = read_place_map(path), read_photo_poses(path.with_name("map.txt.poses"))
    assert place_map.georeference.frame == poses.frame == "hall" and len(poses.photos) > 8
    for photo in place_map.photos:
        seconds = float(Path(photo.image).stem.rpartition("_")[2]) - START * 1e-9
        truth = planar(hall.pose(seconds)) @ hall.T_BASE_CAMERA
        error = sextant.pose_error(truth, poses.photos[photo.image].T_map_camera)
        assert np.linalg.norm(error[:3]) < 0.15 and np.linalg.norm(error[3:]) < 0.03
        assert place_map.path(photo).is_file()


@pytest.mark.slow
def test_without_landmarks_photos_have_the_poses_of_the_markers(tmp_path, known, capsys):
    out = mapped(tmp_path, known, "markers", "photos")
    assert "landmarks: no map: the bags have no sextant/LandmarkObservations" in capsys.readouterr().out
    assert not (out / "landmarks.yaml").exists() and "landmark_map" not in (out / "maps.launch").read_text()
    check_photos(out / "places/map.txt")


@pytest.mark.slow
def test_without_markers_the_first_pose_is_the_origin(tmp_path, capsys):
    bag = hall.write_hall(tmp_path / "drive.bag", 30.0, systems=("landmarks",))
    out = tmp_path / "hall"
    assert main([bag, "-o", str(out), "--frame", "yard"]) == 0
    text = capsys.readouterr().out
    assert "markers: no map: the bags have neither sextant/MarkerArray nor images with camera_info" in text
    assert "places: no map: the bags have no images" in text
    made, start = sextant.read_landmark_map(str(out / "landmarks.yaml")), planar(hall.pose(0.0))
    assert made.frame == "yard" and len(made.landmarks) > 5
    found = [
        (name, (start @ [*position, 0.0, 1.0])[:2])
        for name, position in own_landmarks(out / "landmarks.yaml")
    ]
    assert max(distance(*each) for each in found) < 0.6  # odometry drifts
    assert "marker_map" not in (out / "maps.launch").read_text()


@pytest.mark.slow
def test_a_folder_is_overwritten_on_request_only(tmp_path, known, capsys):
    out = mapped(tmp_path, known, "markers", seconds=8.0)
    before = (out / "markers.yaml").read_text()
    again = [str(tmp_path / "drive.bag"), "-o", str(out), "--known", known]
    assert main(again) == 2
    assert "markers.yaml: already exists; --force overwrites it" in capsys.readouterr().err
    (out / "markers.yaml").write_text("old")
    assert main([*again, "--force"]) == 0
    assert (out / "markers.yaml").read_text() == before


def test_a_drive_without_any_system_leaves_no_folder(tmp_path, capsys):
    bag = hall.write_hall(tmp_path / "drive.bag", 2.0, systems=())
    assert main([bag, "-o", str(tmp_path / "hall")]) == 2
    captured = capsys.readouterr()
    assert "no map can be made: the bags have neither" in captured.err and captured.err.count("\n") == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["drive.bag"]


REFUSED = {
    "a file": (["-o", "drive.bag"], "drive.bag: cannot be written"),
    "no parameters": (["--params", "nowhere.yaml"], "nowhere.yaml"),
    "a size": (["--size", "-1"], "size"),
    "a turn": (["--turn", "0"], "--turn"),
    "a bag twice": (["BAG"], "duplicate bag"),
    "no such topic": (["--image", "/rear"], "/rear"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_wrong_options_are_refused_before_anything_is_computed(case, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    hall.write_hall(tmp_path / "drive.bag", 1.0)
    arguments, reason = REFUSED[case]
    arguments = ["drive.bag" if each == "BAG" else each for each in arguments]
    assert main(["drive.bag", "-o", "hall", *arguments]) == 2
    captured = capsys.readouterr()
    assert reason in captured.err and captured.err.count("\n") == 1 and captured.out == ""
    assert sorted(path.name for path in tmp_path.iterdir()) == ["drive.bag"]
