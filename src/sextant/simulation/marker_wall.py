# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Markers side by side on a wall, and a camera that looks at their centre.

Frame `map`: origin in the centre of the markers, x right as one faces the wall, y into the wall, z up.
"""

from typing import List

import numpy as np

import sextant

CAMERA_SPREAD = np.deg2rad(2.0)  # half range of the camera's direction and roll
AIM_SPREAD = np.deg2rad(1.0)  # half range of pan and tilt: the markers fall on different pixels
CLEARANCE = 1.5  # metres between the camera or the markers and the other walls
HEIGHT = 3.0  # minimum height of the room, metres


def wall_map(family: str, size: float, count: int, spacing: float) -> "sextant.MarkerMap":
    """Returns a map of upright markers on one wall at one height, ids from 0 on from the left.

    :param size: edge length, metres
    :param spacing: distance of the centres of adjacent markers, metres
    :raises ValueError: an unknown family, or one with fewer markers
    """
    marker_map = sextant.MarkerMap()
    for id in range(count):
        x = spacing * (id - 0.5 * (count - 1))
        T_map_marker = sextant.pose_from_xyz_rpy([x, 0.0, 0.0], [0.5 * np.pi, 0.0, 0.0])
        marker_map.add(sextant.MappedMarker(family, id, size, T_map_marker))
    return marker_map


def wall_room(
    marker_map: "sextant.MarkerMap", distance: float, angle: float, seed: int = 1
) -> "sextant.RoomSceneParams":
    """Returns an empty room that contains the markers and a camera.

    :param distance: of the camera, metres
    :param angle: of the camera, from the wall's normal, radians
    :param seed: random seed of the walls
    """
    reach = max(np.hypot(*marker.T_map_marker[:2, 3]) + marker.size for marker in marker_map.markers)
    width = 2.0 * (max(distance * abs(np.sin(angle)), reach) + CLEARANCE)
    depth = distance + CLEARANCE
    height = max(HEIGHT, 2.0 * reach, 2.0 * (distance * np.sin(CAMERA_SPREAD) + 0.5))
    room = sextant.RoomSceneParams()
    room.seed, room.obstacles = seed, []
    room.size = np.array([width, depth, height])
    room.floor_center = np.array(
        [0.0, 0.01 - 0.5 * depth, -0.5 * height]
    )  # the markers are 1 cm off the wall
    return room


def camera_poses(distance: float, angle: float, count: int, seed: int = 1) -> List[np.ndarray]:
    """Returns poses T_map_camera (4, 4) of a camera that looks at the centre of the markers.

    Direction, aim and roll vary by CAMERA_SPREAD and AIM_SPREAD; the distance does not.

    :param distance: from the centre of the markers, metres
    :param angle: of the direction to the camera from the wall's normal, to the right, radians
    :param seed: random seed; the same deviations for every distance and angle
    """
    spreads = [CAMERA_SPREAD, CAMERA_SPREAD, AIM_SPREAD, AIM_SPREAD, CAMERA_SPREAD]
    deviations = np.random.default_rng(seed).uniform(-1.0, 1.0, (count, 5)) * spreads
    T_mount_optical = sextant.pose_from_xyz_rpy([0.0, 0.0, 0.0], [-0.5 * np.pi, 0.0, 0.0])
    poses = []
    for bearing, elevation, pan, tilt, roll in deviations:
        T_map_direction = sextant.pose_from_xyz_rpy([0.0, 0.0, 0.0], [-elevation, 0.0, angle + bearing])
        T_direction_mount = sextant.pose_from_xyz_rpy([0.0, -distance, 0.0], [tilt, roll, pan])
        poses.append(T_map_direction @ T_direction_mount @ T_mount_optical)
    return poses
