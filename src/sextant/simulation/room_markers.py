# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Markers of the default room, and a room for any other map."""

from typing import List, Sequence

import numpy as np

import sextant

MARKER_SIZE = 0.2  # edge length, metres
MARKER_HEIGHT = 1.0  # metres above the floor
MARKER_SPACING = 3.0  # metres between the two markers of a wall
CLEARANCE = 0.5  # metres between a marker and the walls of an enlarged room

# Yaw, radians, of the walls +y, -x, -y, +x of a room relative to the wall +y; markers face inward.
_WALL_YAWS = (0.0, 0.5 * np.pi, np.pi, -0.5 * np.pi)


def default_map(family: str = "tag36h11") -> "sextant.MarkerMap":
    """Eight markers, ids 0 to 7, two on each wall of the default 6 x 6 m room, 1 m above the floor.

    Frame `map`: origin in the centre of the floor, z up.

    :raises ValueError: unknown family, or a family with fewer than eight markers
    """
    marker_map = sextant.MarkerMap()
    half_room = 0.5 * sextant.RoomSceneParams().size[0]
    for wall, yaw in enumerate(_WALL_YAWS):
        T_map_wall = sextant.pose_from_xyz_rpy([0.0, 0.0, 0.0], [0.0, 0.0, yaw])
        for side in (0, 1):
            x = (side - 0.5) * MARKER_SPACING
            T_wall_marker = sextant.pose_from_xyz_rpy([x, half_room, MARKER_HEIGHT], [0.5 * np.pi, 0.0, 0.0])
            marker = sextant.MappedMarker(family, 2 * wall + side, MARKER_SIZE, T_map_wall @ T_wall_marker)
            marker_map.add(marker)
    return marker_map


def room_for(
    marker_map: "sextant.MarkerMap", seed: int = 1, obstacles: bool = True, size: Sequence[float] = ()
) -> "sextant.RoomSceneParams":
    """Returns the default room, or an empty one of another size; if markers lie outside, an empty larger one.

    :param seed: random seed of the walls
    :param obstacles: whether the default room has posts, a crate and a cupboard
    :param size: along x, y and z, metres; empty: that of the default room
    """
    room = sextant.RoomSceneParams()
    room.seed = seed
    if len(size):
        room.size = np.array(size)
    half = np.array([0.5 * room.size[0], 0.5 * room.size[1], 0.0])
    low = room.floor_center - half
    high = room.floor_center + half + [0.0, 0.0, room.size[2]]
    outside = _outside(marker_map, low, high)
    if outside:
        low = np.minimum(low, np.min(outside, axis=0) - CLEARANCE)
        high = np.maximum(high, np.max(outside, axis=0) + CLEARANCE)
        room.size = high - low
        room.floor_center = np.array([*(0.5 * (low + high))[:2], low[2]])
    if outside or len(size) or not obstacles:
        room.obstacles = []
    return room


def _outside(marker_map: "sextant.MarkerMap", low: np.ndarray, high: np.ndarray) -> List[np.ndarray]:
    """Positions (3,) of the markers that are not between the corners low and high, metres."""
    on_the_wall = 1e-6  # tolerance, metres
    positions = [marker.T_map_marker[:3, 3] for marker in marker_map.markers]
    return [p for p in positions if np.any(p < low - on_the_wall) or np.any(p > high + on_the_wall)]
