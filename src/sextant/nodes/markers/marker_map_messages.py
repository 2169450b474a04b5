# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Converts marker maps to messages: entries for the locator, transforms, and markers of rviz."""

from typing import List

import numpy as np
from geometry_msgs.msg import Point, Pose, PoseWithCovariance, Quaternion, TransformStamped
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import Marker, MarkerArray

import sextant
from sextant.markers.marker_mesh import board_triangles
from sextant.messages.pose_messages import pose_from_message, pose_to_message, transform_to_message
from sextant.msg import MarkerMapEntries, MarkerMapEntry


def map_to_message(marker_map: sextant.MarkerMap, stamp) -> MarkerMapEntries:
    """Converts a map to entries with covariances."""
    header = Header(stamp=stamp, frame_id=marker_map.frame)
    return MarkerMapEntries(header, [_entry(marker) for marker in marker_map.markers])


def marker_from_entry(entry: MarkerMapEntry) -> sextant.MappedMarker:
    """Converts an entry to a marker.

    :raises ValueError: the pose is invalid; MarkerMap.set() checks the rest
    """
    return sextant.MappedMarker(
        family=entry.family,
        id=entry.id,
        size=entry.size,
        name=entry.name,
        T_map_marker=pose_from_message(entry.pose.pose),
        covariance=np.reshape(entry.pose.covariance, (6, 6)),
    )


def map_to_transforms(marker_map: sextant.MarkerMap, stamp) -> List[TransformStamped]:
    """Returns the transforms of markers and other frames to their parents."""
    edges = [(marker_map.frame, marker.name, marker.T_map_marker) for marker in marker_map.markers]
    edges += [(frame.parent, frame.name, frame.T_parent_frame) for frame in marker_map.frames]
    return [
        TransformStamped(Header(stamp=stamp, frame_id=parent), child, transform_to_message(T))
        for parent, child, T in edges
    ]


def map_to_visualization(marker_map: sextant.MarkerMap) -> MarkerArray:
    """Returns boards with modules and ids for rviz; previous ones are deleted."""
    drawn = [Marker(header=Header(frame_id=marker_map.frame), action=Marker.DELETEALL)]
    for index, marker in enumerate(marker_map.markers):
        drawn += [_board(marker_map.frame, index, marker), _label(marker_map.frame, index, marker)]
    return MarkerArray(drawn)


def _entry(marker: sextant.MappedMarker) -> MarkerMapEntry:
    pose = PoseWithCovariance(pose_to_message(marker.T_map_marker), marker.covariance.ravel().tolist())
    return MarkerMapEntry(marker.family, marker.id, marker.size, marker.name, pose)


def _board(frame: str, index: int, marker: sextant.MappedMarker) -> Marker:
    corners, greys = board_triangles(marker.family, marker.id, marker.size)
    colours = [ColorRGBA(grey, grey, grey, 1.0) for grey in np.repeat(greys, 3)]
    return _shape(
        frame,
        "boards",
        index,
        Marker.TRIANGLE_LIST,
        pose_to_message(marker.T_map_marker),
        1.0,
        points=[Point(*corner) for corner in corners],
        colors=colours,
    )


def _label(frame: str, index: int, marker: sextant.MappedMarker) -> Marker:
    above = marker.T_map_marker @ np.array([0.0, 1.1 * marker.size, 0.0, 1.0])
    pose = Pose(Point(*above[:3]), Quaternion(0.0, 0.0, 0.0, 1.0))  # rviz warns of a quaternion of zeros
    return _shape(frame, "ids", index, Marker.TEXT_VIEW_FACING, pose, 0.9 * marker.size, text=str(marker.id))


def _shape(frame: str, namespace: str, index: int, kind: int, pose: Pose, scale: float, **fields) -> Marker:
    shape = Marker(
        header=Header(frame_id=frame),
        ns=namespace,
        id=index,
        type=kind,
        pose=pose,
        color=ColorRGBA(1.0, 1.0, 1.0, 1.0),
        **fields,
    )
    shape.scale.x = shape.scale.y = shape.scale.z = scale
    return shape
