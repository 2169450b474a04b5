# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import pickle

import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp

import sextant
from sextant.geometry.poses import interpolated_poses
from sextant.localization.drive_observations import DriveCamera, DriveObservations, ImageDetections
from sextant.localization.recorded_instants import (
    camera_name,
    count_instants,
    mounted_camera_name,
    recorded_instants,
)
from sextant.simulation.camera import camera_calibration

LENS = camera_calibration(640, 480)
MOUNT = sextant.pose_from_xyz_rpy([0.1, 0.2, 0.3], [0.4, 0.5, 0.6])


def camera(T_base_camera=MOUNT):
    return DriveCamera(LENS, T_base_camera=T_base_camera)


def marker(marker_id=3):
    return sextant.Detection("tag36h11", marker_id, np.arange(8.0).reshape(4, 2), [0.1, 0.2, 0.3, -1.0])


def ms(milliseconds):
    return 1_600_000_000 * 10**9 + round(milliseconds * 1e6)


def drive(images, odometry=(), cameras=("a", "b"), name="d.bag"):
    """images: (ms, camera, whether there is a marker); odometry: (ms, pose)"""
    seen = [ImageDetections(ms(t), of, [marker()] if there else []) for t, of, there in images]
    stamps = np.array([ms(t) for t, _ in odometry], dtype=np.int64)
    poses = np.array([T for _, T in odometry]).reshape(-1, 4, 4)
    return DriveObservations(name, {each: camera() for each in cameras}, seen, stamps, poses)


def pose(x, yaw=0.0):
    return sextant.pose_from_xyz_rpy([x, 0.0, 0.0], [0.0, 0.0, yaw])


def indices(recording):
    return [[view.camera_index for view in instant.views] for instant in recording.instants]


def test_images_of_one_time_are_one_instant():
    images = [(0, "a", True), (8, "b", True), (100, "b", True), (111, "a", True), (200, "a", True)]
    recording = recorded_instants([drive(images)])
    assert indices(recording) == [[0, 1], [1], [0], [0]]
    assert recording.stamps.tolist() == [ms(t) for t in (8, 100, 111, 200)]
    assert recording.cameras == ["a", "b"]


def test_a_camera_is_not_twice_in_an_instant():
    images = [(5, "a", True), (0, "a", True), (8, "b", True)]
    recording = recorded_instants([drive(images)])
    assert indices(recording) == [[0, 1], [0]]
    assert recording.stamps.tolist() == [ms(8), ms(5)]


def test_what_was_seen_is_handed_on():
    instant = recorded_instants([drive([(0, "b", True)])]).instants[0]
    assert instant.T_odom_base is None and instant.drive == 0
    assert instant.views[0].camera_index == 1


def test_cameras_are_numbered_over_all_drives():
    first = drive([(0, "b", True)], cameras=("b",))
    second = drive([(0, "a", True), (0, "c", True)], cameras=("c", "a"))
    recording = recorded_instants([first, second])
    assert recording.cameras == ["a", "b", "c"]
    assert indices(recording) == [[1], [0, 2]]
    assert [instant.drive for instant in recording.instants] == [0, 1]


def test_the_places_of_a_camera_are_one_camera():
    names = [mounted_camera_name("/cam", 0), mounted_camera_name("/cam", 1)]
    assert names == ["/cam", "/cam#2"] and {camera_name(name) for name in names} == {"/cam"}
    images = [(0, "/cam", True), (100, "/cam#2", True)]
    recording = recorded_instants([drive(images, cameras=names)])
    assert recording.cameras == ["/cam"] and indices(recording) == [[0], [0]]


def test_images_without_markers_are_kept_where_there_is_odometry():
    images = [(0, "a", False), (100, "a", True), (100, "b", False), (900, "a", False)]
    recording = recorded_instants([drive(images, [(0, pose(0.0)), (200, pose(2.0))])])
    assert indices(recording) == [[], [0]]
    assert indices(recorded_instants([drive(images)])) == [[0]]


def test_odometry_between_its_readings():
    odometry = [(0, pose(0.0, 3.0)), (400, pose(4.0, -3.0)), (1000, pose(5.0))]
    images = [(t, "a", True) for t in (-1, 0, 100, 400, 700, 1000, 1001)]
    recording = recorded_instants([drive(images, odometry)])
    poses = [instant.T_odom_base for instant in recording.instants]
    assert [T is None for T in poses] == [True, False, False, False, True, False, True]  # 700: a gap of 0.6 s
    assert poses[2] == pytest.approx(pose(1.0, 3.0 + 0.25 * (2.0 * np.pi - 6.0)), abs=1e-12)
    for index, T in ((1, odometry[0][1]), (3, odometry[1][1]), (5, odometry[2][1])):
        np.testing.assert_array_equal(poses[index], T)


def test_a_camera_that_saw_earlier_is_put_where_it_then_was():
    """A point that stands still is where it is, whatever camera of a moving robot looks at it."""
    odometry = [(0, pose(0.0)), (100, pose(0.2, 0.3))]
    T_map_odom, size = pose(7.0), 0.6
    T_map_marker = sextant.pose_from_xyz_rpy([10.0, 0.3, 0.4], [0.5 * np.pi, 0.0, -0.5 * np.pi + 0.7])
    mount = np.eye(4)
    mount[:3, :3] = [[0, 0, 1], [-1, 0, 0], [0, -1, 0]]
    corners = np.c_[sextant.marker_corners(size), np.ones(4)] @ T_map_marker.T
    images = []
    for t, name in ((0, "a"), (9, "b")):
        T_odom_base = interpolated_poses(*stamped(odometry), np.array([ms(t)]), 0.5)[0]
        points = corners @ np.linalg.inv(T_map_odom @ T_odom_base @ mount).T
        pixels = np.array([sextant.CameraModel(LENS).project(point[:3]) for point in points])
        images.append(ImageDetections(ms(t), name, [sextant.Detection("tag36h11", 3, pixels)]))
    seen = DriveObservations("d", {name: camera(mount) for name in "ab"}, images, *stamped(odometry))
    instant = recorded_instants([seen]).instants[0]
    marker_map = sextant.MarkerMap()
    marker_map.add(sextant.MappedMarker("tag36h11", 3, size, T_map_marker))
    located = sextant.MarkerLocator().locate(marker_map, instant.views).pose
    assert located.T_map_base == pytest.approx(T_map_odom @ instant.T_odom_base, abs=1e-6)
    assert located.reprojection_error < 1e-6


def stamped(odometry):
    return np.array([ms(t) for t, _ in odometry], dtype=np.int64), np.array([T for _, T in odometry])


def test_interpolation_is_slerp():
    random = np.random.default_rng(3)
    rotations = Rotation.random(20, random_state=4)
    stamps = np.cumsum(random.integers(1, 10**8, 20)) + ms(0)
    poses = np.tile(np.eye(4), (20, 1, 1))
    poses[:, :3, :3], poses[:, :3, 3] = rotations.as_matrix(), random.normal(size=(20, 3))
    at = np.sort(random.integers(stamps[0], stamps[-1], 50))
    expected = Slerp(stamps - stamps[0], rotations)(at - stamps[0]).as_matrix()
    found = np.array(interpolated_poses(stamps, poses, at, 1.0))
    assert found[:, :3, :3] == pytest.approx(expected, abs=1e-12)
    for axis in range(3):
        positions = np.interp(at - stamps[0], stamps - stamps[0], poses[:, axis, 3])
        assert found[:, axis, 3] == pytest.approx(positions, abs=1e-9)


def test_nothing_at_all():
    recording = recorded_instants([])
    assert recording.instants == [] and recording.cameras == [] and len(recording.stamps) == 0
    assert recorded_instants([drive([])]).instants == []


def test_what_cannot_be_is_refused():
    with pytest.raises(ValueError, match="d.bag: an image is of 'c'"):
        recorded_instants([drive([(0, "c", True)])])


def test_a_drive_can_be_pickled_bit_for_bit():
    lens = camera_calibration(640, 480, distortion=[-0.2, 0.05, 1e-3, -1e-3, 0.1])
    images = [ImageDetections(7, "a", [marker()])]
    seen = DriveObservations("d.bag", {"a": DriveCamera(lens, True, MOUNT)}, images)
    copy = pickle.loads(pickle.dumps(seen))
    for name in ("width", "height", "distortion_model", "D", "K", "R", "P"):
        assert np.array_equal(getattr(copy.cameras["a"].calibration, name), getattr(lens, name)), name
    assert copy.cameras["a"].rectified and np.array_equal(copy.cameras["a"].T_base_camera, MOUNT)
    [detection] = copy.images[0].markers
    for name in ("family", "id", "corners", "corner_sigmas", "hamming", "decision_margin"):
        assert np.array_equal(getattr(detection, name), getattr(marker(), name)), name


def test_instants_without_markers_are_counted():
    images = [(0, "a", True), (8, "b", False), (100, "b", False), (111, "a", False), (200, "a", True)]
    assert len(recorded_instants([drive(images)]).instants) == 2
    assert count_instants(drive(images)) == 4
