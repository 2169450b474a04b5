# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes a map as tagslam.yaml; tagslam.py describes the format."""

from typing import List

import numpy as np

import sextant
from sextant.markers.formats.format_types import WrittenMap, decimal
from sextant.markers.formats.losses import lost_frames, lost_names, only_family
from sextant.markers.formats.tagslam_noise import (
    AXES,
    MIN_POSITION,
    MIN_ROTATION,
    deviations_in_tag_axes,
)

BODY = "marker_map"  # not the map frame: tagslam publishes the body's frame as its child
# tagslam does not start without the first two tables; the numbers are from its examples
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
    """Formats a map as a tagslam.yaml with one static body, without cameras and the moving body.

    :raises MapFileError: several families, or a family that is not an AprilTag family
    """
    apriltags = {name for name in sextant.marker_families() if name.startswith("tag")}
    family = only_family(marker_map, apriltags, "tagslam")
    exact = np.repeat([MIN_POSITION, MIN_ROTATION], 3)
    text = HEADER + _format_pose(np.eye(4), exact, 6) + "      tags:\n"
    text += "".join(_format_tag(marker) for marker in marker_map.markers)
    settings = f"the family: set the detector to {family}"
    if marker_map.frame != "map":
        settings += f"; the frame: set fixed_frame_id: {marker_map.frame}"
    return text, [settings, *_changed(marker_map), *lost_names(marker_map), *lost_frames(marker_map)]


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
    """Warns of covariances that the file cannot represent."""
    found = [
        deviations_in_tag_axes(each.covariance, each.T_map_marker[:3, :3]) for each in marker_map.markers
    ]
    changed = sum(not is_exact for _, is_exact in found)
    if not changed:
        return []
    return [
        f"correlations of {changed} covariances: only deviations along and about the tag's axes are written;"
        f" an exact pose has {decimal(MIN_POSITION)} m and {decimal(MIN_ROTATION)} rad"
    ]
