# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Maps in three frames whose transforms are known, and a drive through all of them."""

import cv2
import hall_drives as hall
import numpy as np
import pytest
from html_page import Page
from landmark_bags import planar

import sextant
from sextant.commands.maps.align_maps import main
from sextant.geometry.plane_poses import composed, in_frame
from sextant.place_maps.place_map import MetricFrame, Overview, Photo, PlaceMap
from sextant.place_maps.place_map_file import read_place_map, write_place_map

PILLAR_FRAME = np.array([3.0, -2.0, 0.7])  # pose in the frame of the hall, metres and radians
PHOTO_FRAME = np.array([-8.0, 5.0, -1.2])


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Maps without errors, each in its own frame."""
    folder = tmp_path_factory.mktemp("maps")
    walls = sextant.MarkerMap("hall")
    for marker in hall.WALLS.markers:
        walls.add(marker)
    sextant.write_marker_map(walls, str(folder / "walls.yaml"))
    sextant.write_landmark_map(pillar_map(), str(folder / "pillars.yaml"))
    write_photos(folder / "photos")
    return folder


def pillar_map():
    landmarks = [sextant.Landmark2D(each, None) for each in in_frame(PILLAR_FRAME, hall.PILLARS)]
    labels = [sextant.LandmarkLabel(name) for name in hall.CLASSES]
    covariance = 0.01**2 * np.eye(3 + 2 * len(landmarks))
    return sextant.LandmarkMap("pillars", np.zeros(3), landmarks, labels, covariance, True)


def write_photos(folder):
    """One of each place, in the middle of where the camera sees it."""
    folder.mkdir()
    overview, frame = Overview("overview.png", 600, 600), MetricFrame("photos", 0.05, (-15.0, -15.0, 0.0))
    photos = []
    for number in range(hall.SAME_PLACE // 2, round(hall.EIGHT.period * hall.RATE), hall.SAME_PLACE):
        T = planar(hall.pose(number / hall.RATE)) @ hall.T_BASE_CAMERA
        in_photos = np.linalg.inv(planar(PHOTO_FRAME)) @ T
        yaw = float(np.arctan2(in_photos[1, 2], in_photos[0, 2]))
        cv2.imwrite(str(folder / f"{number}.png"), hall.photo(number))
        photos.append(Photo(number, f"{number}.png", *frame.pixel(overview, *in_photos[:2, 3]), yaw))
    write_place_map(folder / "map.txt", PlaceMap(folder, overview, tuple(photos), frame))


def given(folder, *systems):
    files = {"marker": "walls.yaml", "landmark": "pillars.yaml", "place": "photos/map.txt"}
    return [text for each in systems for text in (f"--{each}-map", str(folder / files[each]))]


def pillars_of(path):
    return np.array([each.position for each in sextant.read_landmark_map(str(path)).landmarks])


@pytest.mark.slow
def test_three_maps_are_written_in_the_frame_of_the_markers(folder, tmp_path, capsys):
    bag = hall.write_hall(tmp_path / "hall.bag", 60.0)
    out = tmp_path / "hall"
    assert main([bag, "-o", str(out), *given(folder, "marker", "landmark", "place")]) == 0
    text = capsys.readouterr().out
    assert "landmarks: aligned with markers: " in text and "places: aligned with markers: " in text
    assert sextant.read_marker_map(str(out / "markers.yaml")).frame == "hall"
    moved = sextant.read_landmark_map(str(out / "landmarks.yaml"))
    errors = pillars_of(out / "landmarks.yaml") - hall.PILLARS
    assert moved.frame == "hall" and np.hypot(*errors.T).max() < 0.15
    covariances = [moved.covariance[at : at + 2, at : at + 2] for at in range(3, len(moved.covariance), 2)]
    for error, covariance in zip(errors, covariances):
        assert error @ np.linalg.solve(covariance, error) < 22.5  # one of 10^5, two degrees of freedom
    place_map = read_place_map(out / "places/map.txt")
    assert place_map.georeference.frame == "hall"
    expected = composed(PHOTO_FRAME, np.array([-15.0, -15.0, 0.0]))
    origins = (np.array(place_map.georeference.origin), expected)
    centres = [composed(origin, np.array([15.0, 15.0, 0.0])) for origin in origins]  # near the drive
    np.testing.assert_allclose(*centres, atol=0.3)
    assert all(place_map.path(photo).is_file() for photo in place_map.photos)
    rows = Page((out / "index.html").read_text()).rows
    assert [row[0] for row in rows if row][-3:] == ["markers", "landmarks", "places"]


def test_given_transforms_need_no_drive(folder, tmp_path):
    pose = ",".join(map(str, PILLAR_FRAME))
    out = ["-o", str(tmp_path / "hall"), *given(folder, "marker", "landmark")]
    assert main([*out, "--given", f"landmarks={pose}"]) == 0
    np.testing.assert_allclose(pillars_of(tmp_path / "hall/landmarks.yaml"), hall.PILLARS, atol=1e-9)
    assert main([*out, "--given", f"landmarks={pose}"]) == 2
    back = ",".join(map(str, [*in_frame(PILLAR_FRAME, np.zeros((1, 2)))[0], -PILLAR_FRAME[2]]))
    assert main([*out, "--force", "--frame", "landmarks", "--given", f"markers={back}"]) == 0
    moved = sextant.read_marker_map(str(tmp_path / "hall/markers.yaml"))
    assert moved.frame == "pillars"
    for marker in moved.markers:
        truth = np.linalg.inv(planar(PILLAR_FRAME)) @ hall.WALLS.find(marker.family, marker.id).T_map_marker
        np.testing.assert_allclose(marker.T_map_marker, truth, atol=1e-6)


@pytest.fixture(scope="module")
def short_drive(tmp_path_factory):
    return hall.write_hall(tmp_path_factory.mktemp("drive") / "short.bag", 4.0)


REFUSED = {
    "one map": (["marker"], [], "name two maps or more"),
    "no bag": (["marker", "landmark"], [], "name a bag of a drive, or the transform of landmarks"),
    "no such map": (["marker", "landmark"], ["--frame", "places"], "there is no map of places"),
    "two numbers": (["marker", "landmark"], ["--given", "landmarks=1,2"], "allowed are three numbers"),
    "the reference": (["marker", "landmark"], ["--given", "markers=1,2,3"], "allowed are landmarks"),
    "a short drive": (["marker", "landmark"], ["BAG"], "the robot was never localized by landmarks"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_aligned_is_refused_in_one_line(case, folder, short_drive, tmp_path, capsys):
    systems, arguments, reason = REFUSED[case]
    arguments = [short_drive if each == "BAG" else each for each in arguments]
    assert main([*arguments, "-o", str(tmp_path / "hall"), *given(folder, *systems)]) == 2
    captured = capsys.readouterr()
    assert reason in captured.err and captured.err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
