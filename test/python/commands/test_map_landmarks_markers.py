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


def tag_map(path):
    marker_map = sextant.MarkerMap("room")
    for id, (x, y, z, yaw) in TAGS.items():
        T = sextant.pose_from_xyz_rpy([x, y, z], [0.0, 0.0, yaw])
        T[:3, :3] = T[:3, :3] @ [[0, 0, 1], [1, 0, 0], [0, 1, 0]]  # x right, y up, z out of the wall
        marker_map.add(sextant.MappedMarker("tag36h11", id, 0.2, T))
    sextant.write_marker_map(marker_map, str(path))
    return marker_map


def seen_tag(marker, T_map_camera):
    message = Marker(family="tag36h11", id=marker.id, size=marker.size, alternative_reprojection_error=-1.0)
    message.pose.pose = pose_to_message(np.linalg.inv(T_map_camera) @ marker.T_map_marker)
    message.pose.covariance = (1e-4 * np.eye(6)).ravel().tolist()
    return message


def test_markers_locate_the_robot(tmp_path, capsys):
    """It drives from (1, -1) on, and knows nothing but the map of the markers."""
    tags, truth = tag_map(tmp_path / "tags.yaml"), {}
    T_base_camera = sextant.pose_from_xyz_rpy([0.1, 0.0, 0.3], [-np.pi / 2, 0.0, -np.pi / 2])
    start = planar([1.0, -1.0, 0.2])
    with WrittenBag(tmp_path / "tags.bag") as bag:
        bag.transforms([("base_link", "camera", T_base_camera)])
        for index in range(50):
            seconds, T_odom_base = 1.0 + 0.1 * index, planar([0.02 * index, 0.0, 0.0])
            T_map_base = start @ T_odom_base
            seen = [seen_tag(tag, T_map_base @ T_base_camera) for tag in tags.markers]
            seen.append(Marker(family="tag36h11", id=9))
            bag.odometry("/odom", T_odom_base, seconds)
            bag.write(
                "/camera/markers", MarkerArray(header(seconds, "camera"), CameraInfo(), False, seen), seconds
            )
            truth[nanoseconds(seconds)] = T_map_base
    given = ["--marker-map", str(tmp_path / "tags.yaml"), "--trajectory", str(tmp_path / "poses.tum")]
    assert main([str(tmp_path / "tags.bag"), "-o", str(tmp_path / "m.yaml"), *given]) == 0
    poses = read_trajectory(tmp_path / "poses.tum")
    assert len(poses) > 40
    for stamp, T in poses.items():
        assert sextant.pose_error(truth[stamp], T) == pytest.approx(np.zeros(6), abs=0.02)
    assert sextant.read_landmark_map(str(tmp_path / "m.yaml")).frame == "room"
    assert "marker 9: 50 of 50 messages were left out: it has no size" in capsys.readouterr().out
