# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The maps of the building: what is shipped and what is written agree with the plan."""

from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml

import sextant
from sextant.buildings.building_maps import FRAME, has_building_map, true_marker_map, write_building_map
from sextant.buildings.building_view import BuildingCamera
from sextant.place_maps.photo_poses import poses_path, read_photo_poses
from sextant.place_maps.place_map_file import read_place_map
from sextant.simulation.building import Building

BUILDING = Building()
CONFIG = Path(__file__).resolve().parents[3] / "config"
CAMERA = BuildingCamera(64, 48)


def test_the_shipped_markers_are_those_of_the_building():
    shipped, true = sextant.read_marker_map(str(CONFIG / "building_markers.yaml")), true_marker_map(BUILDING)
    assert [(each.family, each.id, each.size) for each in shipped.markers] == [
        (each.family, each.id, each.size) for each in true.markers
    ]
    assert shipped.frame == FRAME
    for marker, truth in zip(shipped.markers, true.markers):
        error = sextant.pose_error(truth.T_map_marker, marker.T_map_marker)
        assert error @ np.linalg.solve(marker.covariance, error) < 30.0


def test_markers_hang_upright_and_face_their_normal():
    for marker, mapped in zip(BUILDING.markers, true_marker_map(BUILDING).markers):
        x, y, heading = marker.pose
        np.testing.assert_allclose(mapped.T_map_marker[:2, 3], [x, y])
        np.testing.assert_allclose(mapped.T_map_marker[:3, 1], [0.0, 0.0, 1.0], atol=1e-12)
        normal = [np.cos(heading), np.sin(heading), 0.0]
        np.testing.assert_allclose(mapped.T_map_marker[:3, 2], normal, atol=1e-12)


def test_the_shipped_pillars_are_those_of_the_building():
    shipped = sextant.read_landmark_map(str(CONFIG / "building_pillars.yaml"))
    assert (shipped.frame, shipped.is_lost) == (FRAME, True)
    assert [each.class_name for each in shipped.labels] == BUILDING.classes
    errors = np.array([each.position for each in shipped.landmarks]) - BUILDING.pillars
    assert 0.0 < np.abs(errors).max() < 4 * np.sqrt(shipped.covariance[3, 3])


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("building") / "map"
    assert not has_building_map(folder)
    write_building_map(folder, BUILDING, CAMERA, 8.0)
    return folder


def test_photos_are_on_every_way_in_both_directions(folder):
    assert has_building_map(folder)
    place_map = read_place_map(folder / "map.txt")
    poses = read_photo_poses(poses_path(folder / "map.txt"))
    assert poses.frame == place_map.georeference.frame == FRAME
    assert set(poses.photos) == {photo.image for photo in place_map.photos}
    assert len(place_map.photos) == 2 * len(place_map.places())
    for photo in place_map.photos:
        assert cv2.imread(str(folder / photo.image), cv2.IMREAD_UNCHANGED).shape == (48, 64)
        at = place_map.georeference.position(place_map.overview, photo.x, photo.y)
        T = poses.photos[photo.image].T_map_camera
        assert np.hypot(*(T[:2, 3] - at)) < 0.3 and T[2, 3] == pytest.approx(CAMERA.above)
        yaw = place_map.georeference.yaw(photo.yaw)
        np.testing.assert_allclose(T[:2, 2], [np.cos(yaw), np.sin(yaw)], atol=1e-3)
        assert BUILDING.is_inside(np.array(at))


def test_the_plan_is_an_occupancy_grid(folder):
    """By the rules of map_server."""
    table = yaml.safe_load((folder / "plan.yaml").read_text())
    grey = cv2.imread(str(folder / table["image"]), cv2.IMREAD_UNCHANGED)
    occupancy = (255 - grey.astype(float)) / 255
    assert np.all((occupancy > table["occupied_thresh"]) | (occupancy < table["free_thresh"]))

    def is_free(x, y):
        column, row = ((np.array([x, y]) - table["origin"][:2]) / table["resolution"]).astype(int)
        return occupancy[grey.shape[0] - 1 - row, column] < table["free_thresh"]

    assert all(is_free(*node) for node in BUILDING.nodes)
    assert not any(is_free(*pillar) for pillar in BUILDING.pillars)
    assert not is_free(10.0, 10.0) and not is_free(-0.5, 4.0)
