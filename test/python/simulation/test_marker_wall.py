# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

import sextant
from sextant.simulation.marker_wall import AIM_SPREAD, CAMERA_SPREAD, camera_poses, wall_map, wall_room


def test_markers_are_side_by_side_and_face_the_camera():
    markers = wall_map("tag36h11", 0.2, 3, 0.8).markers
    assert [marker.id for marker in markers] == [0, 1, 2]
    for marker, x in zip(markers, (-0.8, 0.0, 0.8)):
        T = marker.T_map_marker
        np.testing.assert_allclose(T[:3, 3], [x, 0.0, 0.0], atol=1e-12)
        np.testing.assert_allclose(T[:3, :3], [[1, 0, 0], [0, 0, -1], [0, 1, 0]], atol=1e-12)


@pytest.mark.parametrize("angle", [0.0, 0.5, 1.2])
@pytest.mark.parametrize("distance", [0.5, 7.0])
def test_camera_looks_at_the_centre_from_its_distance_and_angle(distance, angle):
    poses = camera_poses(distance, angle, 50)
    for T_map_camera in poses:
        np.testing.assert_allclose(T_map_camera[:3, :3] @ T_map_camera[:3, :3].T, np.eye(3), atol=1e-12)
        x, y, z = T_map_camera[:3, 3]
        assert np.linalg.norm([x, y, z]) == pytest.approx(distance)
        assert abs(np.arctan2(x, -y) - angle) <= CAMERA_SPREAD
        assert abs(np.arcsin(z / distance)) <= CAMERA_SPREAD
        ray = np.linalg.inv(T_map_camera)[:3, 3] / distance  # to the centre of the markers
        assert ray[2] > np.cos(1.5 * AIM_SPREAD)
        assert T_map_camera[2, 1] < -0.99  # the camera's y points down
    assert len({tuple(T.ravel()) for T in poses}) == 50


def test_deviations_are_those_of_the_seed():
    np.testing.assert_array_equal(camera_poses(2.0, 0.3, 5, 4), camera_poses(2.0, 0.3, 5, 4))
    assert not np.allclose(camera_poses(2.0, 0.3, 5, 4), camera_poses(2.0, 0.3, 5, 5))


@pytest.mark.parametrize("distance, angle", [(0.3, 0.0), (0.3, 1.4), (30.0, 0.0), (30.0, 1.4)])
def test_room_contains_markers_and_camera(distance, angle):
    marker_map = wall_map("tag36h11", 0.4, 4, 1.5)
    scene = sextant.RoomScene(wall_room(marker_map, distance, angle), marker_map)
    assert all(scene.contains(T[:3, 3]) for T in camera_poses(distance, angle, 20))
