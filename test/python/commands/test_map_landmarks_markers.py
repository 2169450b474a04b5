# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Landmark SLAM over recorded markers, as its user calls it."""

import numpy as np
import pytest
from landmark_bags import planar
from sensor_msgs.msg import CameraInfo
from written_bags import WrittenBag, header, nanoseconds

import sextant
from sextant.commands.map_landmarks import main
from sextant.evaluation.trajectory_files import read_trajectory
from sextant.messages.pose_messages import pose_to_message
from sextant.msg import Marker, MarkerArray

TAGS = {0: [4.0, 1.0, 0.3, np.pi], 1: [3.0, -2.0, 0.3, np.pi / 2]}  # x, y, z, where the print looks


def tag_map(path, height=0.0):
    marker_map = sextant.MarkerMap("room")
    for id, (x, y, z, yaw) in TAGS.items():
        T = sextant.pose_from_xyz_rpy([x, y, z + height], [0.0, 0.0, yaw])
        T[:3, :3] = T[:3, :3] @ [[0, 0, 1], [1, 0, 0], [0, 1, 0]]  # x right, y up, z out of the wall
        marker_map.add(sextant.MappedMarker("tag36h11", id, 0.2, T))
    sextant.write_marker_map(marker_map, str(path))
    return marker_map


def seen_tag(marker, T_map_camera):
    message = Marker(family="tag36h11", id=marker.id, size=marker.size, alternative_reprojection_error=-1.0)
    message.pose.pose = pose_to_message(np.linalg.inv(T_map_camera) @ marker.T_map_marker)
    message.pose.covariance = (1e-4 * np.eye(6)).ravel().tolist()
    return message


def write_drive(path, tags, pitch=0.0):
    """The robot drives from (1, -1) on. :returns: its poses, seen from above, by stamp"""
    truth, T_level_base = {}, sextant.pose_from_xyz_rpy(np.zeros(3), [0.0, pitch, 0.0])
    T_base_camera = sextant.pose_from_xyz_rpy([0.1, 0.0, 0.3], [-np.pi / 2, 0.0, -np.pi / 2])
    start = planar([1.0, -1.0, 0.2])
    with WrittenBag(path) as bag:
        bag.transforms([("base_link", "camera", T_base_camera)])
        for index in range(50):
            seconds, T_odom_base = 1.0 + 0.1 * index, planar([0.02 * index, 0.0, 0.0])
            T_map_base = start @ T_odom_base
            T_map_camera = T_map_base @ T_level_base @ T_base_camera
            seen = [seen_tag(tag, T_map_camera) for tag in tags.markers]
            seen.append(Marker(family="tag36h11", id=9))
            bag.odometry("/odom", T_odom_base, seconds)
            bag.write(
                "/camera/markers", MarkerArray(header(seconds, "camera"), CameraInfo(), False, seen), seconds
            )
            truth[nanoseconds(seconds)] = T_map_base
    return truth


def located(folder, *options):
    """The poses by stamp of the drive in the folder, by the map of the markers alone."""
    given = ["--marker-map", str(folder / "tags.yaml"), "--trajectory", str(folder / "poses.tum"), *options]
    assert main([str(folder / "tags.bag"), "-o", str(folder / "m.yaml"), "--force", *given]) == 0
    poses = read_trajectory(folder / "poses.tum")
    assert len(poses) > 40
    return poses


def test_markers_locate_the_robot(tmp_path, capsys):
    truth = write_drive(tmp_path / "tags.bag", tag_map(tmp_path / "tags.yaml"))
    for stamp, T in located(tmp_path).items():
        assert sextant.pose_error(truth[stamp], T) == pytest.approx(np.zeros(6), abs=0.02)
    assert sextant.read_landmark_map(str(tmp_path / "m.yaml")).frame == "room"
    assert "marker 9: 50 of 50 messages were left out: it has no size" in capsys.readouterr().out


def test_the_slope_of_a_ramp_is_measured_by_markers_above_the_robot(tmp_path):
    tags = tag_map(tmp_path / "tags.yaml", height=1.5)
    truth = write_drive(tmp_path / "tags.bag", tags, pitch=-0.1)
    off = {}
    for name in ("tilt_sigma", "ramp_sigma"):
        (tmp_path / f"{name}.yaml").write_text(f"{name}: 0.1")
        poses = located(tmp_path, "--params", str(tmp_path / f"{name}.yaml"))
        off[name] = np.mean([np.hypot(*(truth[k] - poses[k])[:2, 3]) for k in poses])
    assert off["tilt_sigma"] > 0.08  # 0.1 rad, 1.8 m above the base
    assert off["ramp_sigma"] < 0.02
