# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Maps that are moved by a known transform; covariances by numeric derivatives."""

import cv2
import numpy as np
import pytest
from landmark_bags import planar
from made_photos import picture

import sextant
from sextant.commands.maps.moved_maps import FrameMove, moved_landmark_map, moved_marker_map, moved_place_map
from sextant.geometry.plane_poses import composed
from sextant.images.photo_depth import depth_path
from sextant.place_maps.photo_poses import PhotoCamera, PhotoPoses, PosedPhoto, poses_path, write_photo_poses
from sextant.place_maps.place_map import GeoCorners, MetricFrame, Overview, Photo, PlaceMap
from sextant.place_maps.place_map_file import write_place_map
from sextant.simulation.camera import camera_calibration

T = np.array([3.0, -2.0, 2.5])
SIGMA = np.array([[0.04, 0.01, 0.002], [0.01, 0.09, -0.003], [0.002, -0.003, 0.01]])  # of T
MOVE = FrameMove("hall", T, SIGMA)
STEP = 1e-6
LABELS = [sextant.LandmarkLabel("pillar"), sextant.LandmarkLabel("tag36h11", 7)]
POSES = np.array([[0.5, 0.2, 0.1], [4.0, -1.0, 0.0], [2.0, 3.0, -0.7]])  # of the robot, and of the landmarks


def landmark_map(poses, covariance):
    landmarks = [sextant.Landmark2D(poses[1, :2], None), sextant.Landmark2D(poses[2, :2], poses[2, 2])]
    return sextant.LandmarkMap("pillars", poses[0], landmarks, LABELS, covariance, False)


def flat(found):
    headings = [[] if each.heading is None else [each.heading] for each in found.landmarks]
    return np.concatenate([found.pose, *(np.r_[e.position, h] for e, h in zip(found.landmarks, headings))])


def derivative(function, at):
    columns = [function(at + STEP * unit) - function(at - STEP * unit) for unit in np.eye(len(at))]
    return np.column_stack(columns) / (2 * STEP)


def test_a_landmark_map_is_moved_with_its_covariance():
    rng = np.random.default_rng(1)
    root = 0.1 * rng.standard_normal((8, 8))
    found = moved_landmark_map(landmark_map(POSES, root @ root.T), MOVE)
    expected = [composed(T, pose) for pose in POSES]
    assert found.frame == "hall" and list(found.labels) == LABELS and not found.is_lost
    np.testing.assert_allclose(flat(found), np.r_[expected[0], expected[1][:2], expected[2]], atol=1e-12)

    def by_transform(transform):
        return flat(moved_landmark_map(landmark_map(POSES, np.eye(8)), MOVE._replace(T_to_from=transform)))

    def by_map(values):
        poses = np.array([values[:3], [*values[3:5], 0.0], values[5:]])
        return flat(moved_landmark_map(landmark_map(poses, np.eye(8)), MOVE))

    J, G = derivative(by_transform, T), derivative(by_map, np.r_[POSES[0], POSES[1, :2], POSES[2]])
    np.testing.assert_allclose(found.covariance, J @ SIGMA @ J.T + G @ root @ root.T @ G.T, atol=1e-6)


def test_a_marker_map_is_moved_with_its_covariance():
    root = 0.1 * np.random.default_rng(2).standard_normal((6, 6))
    pose = sextant.pose_from_xyz_rpy([2.0, 1.0, 0.8], [np.pi / 2, 0.1, 0.4])
    marker_map = sextant.MarkerMap("walls")
    marker_map.add(sextant.MappedMarker("tag36h11", 3, 0.2, pose, "door", root @ root.T))
    (found,) = moved_marker_map(marker_map, MOVE).markers
    assert (found.family, found.id, found.size, found.name) == ("tag36h11", 3, 0.2, "door")
    np.testing.assert_allclose(found.T_map_marker, planar(T) @ pose, atol=1e-9)

    def by_transform(transform):
        return sextant.pose_error(planar(T) @ pose, planar(transform) @ pose)

    J, turn = derivative(by_transform, T), np.kron(np.eye(2), planar(T)[:3, :3])
    np.testing.assert_allclose(found.covariance, J @ SIGMA @ J.T + turn @ root @ root.T @ turn.T, atol=1e-6)


def test_a_place_map_is_moved_with_its_poses_into_one_folder(tmp_path):
    source, place = tmp_path / "photos", MetricFrame("photos", 0.1, (-5.0, 2.0, 0.3))
    (source / "day").mkdir(parents=True)
    overview = Overview("overview.png", 100, 80)
    cv2.imwrite(str(source / "day/a.png"), picture(1))
    depth_path(source / "day/a.png").write_bytes(b"depth")
    write_place_map(
        source / "map.txt", PlaceMap(source, overview, (Photo(4, "day/a.png", 30.0, 20.0, 0.5),), place)
    )
    T_camera = sextant.pose_from_xyz_rpy([1.0, 2.0, 0.5], [-np.pi / 2, 0.0, 0.2])
    posed = PosedPhoto(PhotoCamera(camera_calibration(320, 240)), T_camera)
    write_photo_poses(poses_path(source / "map.txt"), PhotoPoses("photos", {"day/a.png": posed}))
    found = moved_place_map(source / "map.txt", tmp_path / "new", MOVE)
    (photo,), frame = found.place_map.photos, found.place_map.georeference
    assert (photo.image, frame.frame, found.poses.frame) == ("day_a.png", "hall", "hall")
    before = np.array([*place.position(overview, photo.x, photo.y), place.yaw(0.5)])
    after = np.array([*frame.position(overview, photo.x, photo.y), frame.yaw(0.5)])
    np.testing.assert_allclose(planar(after), planar(composed(T, before)), atol=1e-9)
    np.testing.assert_allclose(found.poses.photos["day_a.png"].T_map_camera, planar(T) @ T_camera, atol=1e-6)
    assert set(found.files) == {"day_a.png", depth_path(tmp_path / "day_a.png").name}


def test_a_place_map_without_a_tf_frame_is_refused(tmp_path):
    corners = GeoCorners((55.61, 13.0), (55.6, 13.02))
    write_place_map(tmp_path / "map.txt", PlaceMap(tmp_path, Overview("a.png", 10, 10), (), corners))
    with pytest.raises(ValueError, match="has no tf frame"):
        moved_place_map(tmp_path / "map.txt", tmp_path, MOVE)
