# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Packages that localize with printed markers, and how to read a robot pose from what they publish.

Poses of markers are converted as doc/how_to/migrating.md describes.
"""

from typing import Any, Callable, Dict, List, NamedTuple, Optional, Tuple

import numpy as np

from peers.shown_drive import ShownDrive
from sextant.messages.pose_messages import pose_from_message

MANAGER, ADAPTER = "/sextant_manager", "/marker_adapter"
Reading = Tuple[int, np.ndarray]  # stamp in nanoseconds, T_map_base (4, 4)


class Result(NamedTuple):
    """A topic with poses, and the nodes that compute them."""

    name: str
    topic: str
    type: str
    nodes: Tuple[str, ...]
    read: Callable[[Any, ShownDrive], Optional[Reading]]  # None: no pose in this message


class MarkerPackage(NamedTuple):
    """A package, started by the launch file of its name in this folder."""

    name: str
    required: Tuple[str, ...]  # names for rospack
    family: str  # of the markers that it finds
    map_format: Optional[str]  # of its own map, for convert_map
    results: List[Result]


def _pose(message: Any, _drive: ShownDrive) -> Optional[Reading]:
    """From PoseWithCovarianceStamped."""
    return message.header.stamp.to_nsec(), pose_from_message(message.pose.pose)


def _bundle(message: Any, drive: ShownDrive) -> Optional[Reading]:
    """From AprilTagDetectionArray, whose bundle has all markers of the map."""
    for detection in message.detections:
        if len(detection.id) > 1:
            T_camera_map = pose_from_message(detection.pose.pose.pose)
            T_map_camera = np.linalg.inv(T_camera_map)
            return message.header.stamp.to_nsec(), T_map_camera @ np.linalg.inv(drive.T_base_camera)
    return None


def _camera_poses(message: Any, drive: ShownDrive) -> Dict[int, np.ndarray]:
    """T_map_base by the id of the marker, from aruco_msgs/MarkerArray."""
    known = {marker.id: marker.T_map_marker for marker in drive.map.markers}
    T_camera_base = np.linalg.inv(drive.T_base_camera)
    return {
        marker.id: known[marker.id] @ np.linalg.inv(pose_from_message(marker.pose.pose)) @ T_camera_base
        for marker in message.markers
        if marker.id in known
    }


def _mean(message: Any, drive: ShownDrive) -> Optional[Reading]:
    """Mean position; the rotation is of any one marker."""
    poses = list(_camera_poses(message, drive).values())
    if not poses:
        return None
    # Of the cameras, which are compared: base_link is turned about them by the errors of the rotations.
    cameras = np.array([T @ drive.T_base_camera for T in poses])
    T_map_camera = cameras[0].copy()
    T_map_camera[:3, 3] = cameras[:, :3, 3].mean(axis=0)
    return message.header.stamp.to_nsec(), T_map_camera @ np.linalg.inv(drive.T_base_camera)


def _nearest(message: Any, drive: ShownDrive) -> Optional[Reading]:
    """From the marker that is nearest to the camera."""
    poses = _camera_poses(message, drive)
    near = sorted(
        (marker.pose.pose.position.z, marker.id) for marker in message.markers if marker.id in poses
    )
    return (message.header.stamp.to_nsec(), poses[near[0][1]]) if near else None


def _pose_result(name: str, topic: str, *nodes: str) -> Result:
    return Result(name, topic, "geometry_msgs/PoseWithCovarianceStamped", nodes, _pose)


SEXTANT = [
    MarkerPackage("sextant", (), family, None, [_pose_result(f"Sextant, {family}", "pose", MANAGER)])
    for family in ("tag36h11", "DICT_4X4_50")
]
OTHERS = [
    MarkerPackage(
        "apriltag_ros",
        ("apriltag_ros",),
        "tag36h11",
        "apriltag_ros",
        [
            Result(
                "apriltag_ros, one bundle",
                "tag_detections",
                "apriltag_ros/AprilTagDetectionArray",
                ("/apriltag_ros",),
                _bundle,
            ),
            _pose_result("apriltag_ros and marker_locator", "pose", "/apriltag_ros", ADAPTER, MANAGER),
        ],
    ),
    MarkerPackage(
        "aruco_ros",
        ("aruco_ros",),
        "tag36h11",
        None,
        [
            Result(
                "aruco_ros, mean of all markers",
                "aruco_ros/markers",
                "aruco_msgs/MarkerArray",
                ("/aruco_ros",),
                _mean,
            ),
            Result(
                "aruco_ros, nearest marker",
                "aruco_ros/markers",
                "aruco_msgs/MarkerArray",
                ("/aruco_ros",),
                _nearest,
            ),
            _pose_result("aruco_ros and marker_locator", "pose", "/aruco_ros", ADAPTER, MANAGER),
        ],
    ),
    MarkerPackage(
        "fiducials",
        ("aruco_detect", "fiducial_slam"),
        "DICT_4X4_50",
        "fiducial_slam",
        [
            _pose_result("fiducials", "fiducial_pose", "/aruco_detect", "/fiducial_slam"),
            _pose_result("fiducials and marker_locator", "pose", "/aruco_detect", ADAPTER, MANAGER),
        ],
    ),
]
