# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A map as tagslam.yaml; the format is described in tagslam.py."""

from typing import List

import numpy as np

import sextant
from sextant.markers.formats.losses import lost_frames, lost_names, only_family, require_markers
from sextant.markers.formats.map_file import WrittenMap, decimal
from sextant.markers.formats.tagslam_noise import (
    AXES,
    SMALLEST_POSITION,
    SMALLEST_ROTATION,
    deviations_in_tag_axes,
)

BODY = "marker_map"  # not the map's frame: tagslam sends the body's frame as a child of that
# tagslam does not start without the first two tables; the numbers are those of its examples
HEADER = f"""tagslam_parameters:
  pixel_noise: 1.0
body_defaults:
  position_noise: 0.05
  rotation_noise: 0.01
bodies:
  - {BODY}:
      is_static: true
      type: simple
"""


def format_tagslam(marker_map: sextant.MarkerMap) -> WrittenMap:
    """A tagslam.yaml of one body that stands still; the body that moves, and the cameras, are left to add.

    :raises MapFileError: no markers, several families, a family that is no AprilTag
    """
    require_markers(marker_map)
    apriltags = {name for name in sextant.marker_families() if name.startswith("tag")}
    family = only_family(marker_map, apriltags, "tagslam")
    exact = np.repeat([SMALLEST_POSITION, SMALLEST_ROTATION], 3)
    text = HEADER + _format_pose(np.eye(4), exact, 6) + "      tags:\n"
    text += "".join(_format_tag(marker) for marker in marker_map.markers)
    told = f"the family: set the detector to {family}"
    if marker_map.frame != "map":
        told += f"; the frame: set fixed_frame_id: {marker_map.frame}"
    return WrittenMap(text, [told, *_changed(marker_map), *lost_names(marker_map), *lost_frames(marker_map)])


def _format_tag(marker: sextant.MappedMarker) -> str:
    deviations, _ = deviations_in_tag_axes(marker.covariance, marker.T_map_marker[:3, :3])
    head = f"        - id: {marker.id}\n          size: {decimal(marker.size)}\n"
    return head + _format_pose(marker.T_map_marker, deviations, 10)


def _format_pose(T: np.ndarray, deviations: np.ndarray, indent: int) -> str:
    vectors = {
        "position": T[:3, 3],
        "rotation": sextant.log_so3(T[:3, :3]),
        "position_noise": deviations[:3],
        "rotation_noise": deviations[3:],
    }
    lines = [f"{name}: {_format_vector(vector)}" for name, vector in vectors.items()]
    blank = " " * indent
    return f"{blank}pose:\n" + "".join(f"{blank}  {line}\n" for line in lines)


def _format_vector(vector: np.ndarray) -> str:
    return "{" + ", ".join(f"{axis}: {decimal(value)}" for axis, value in zip(AXES, vector)) + "}"


def _changed(marker_map: sextant.MarkerMap) -> List[str]:
    """Markers whose covariance is not quite that of the file."""
    found = [
        deviations_in_tag_axes(each.covariance, each.T_map_marker[:3, :3]) for each in marker_map.markers
    ]
    changed = sum(not whole for _, whole in found)
    if not changed:
        return []
    return [
        f"of {changed} covariances what is no deviation along or about an axis of the tag; an exact place has"
        f" {decimal(SMALLEST_POSITION)} m and {decimal(SMALLEST_ROTATION)} rad"
    ]
