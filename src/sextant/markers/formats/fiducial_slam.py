# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Maps of fiducial_slam (package fiducials, UbiquityRobotics, ROS 1).

A line a marker, as Map::saveMap and Map::loadMap of fiducial_slam/src/map.cpp write and read it:

    id x y z roll pitch yaw variance observations links...

metres; degrees, for tf2's setRPY: R = Rz(yaw) Ry(pitch) Rx(roll); a pose takes the marker's frame to the
map's (T_mapFid = T_mapCam * T_camFid). links are the ids that were seen together with it.

Marker frame: aruco_detect puts OpenCV's corners at (-, +), (+, +), (+, -), (-, -), z out of the print, as
ours (getSingleMarkerObjectPoints of aruco_detect.cpp). It has OpenCV's dictionaries only, and OpenCV prints
AprilTags turned by 180 degrees against libapriltag, whose upright is ours.

The variance is worked out in m^2, from how far off the floor and how tilted the robot would stand, plus
systematic_error (Map::updatePose), and shrinks with every sighting as if they were independent
(normalizeDavid of transform_with_variance.cpp). fiducial_slam takes it for all six axes alike, metres and
radians (toPose of transform_with_variance.h), and so it is here: variance * I. 0 is a marker that it never
moves: exact.
"""

import re
from typing import Callable, List, Tuple

import numpy as np

import sextant
from sextant.markers.formats.losses import lost_frames, lost_names, only_family, only_size, require_markers
from sextant.markers.formats.map_file import (
    MapFileError,
    MapFormatParams,
    ReadMap,
    WrittenMap,
    decimal,
    finite,
    read_text,
    told_as,
)

FIELDS = 9  # and any number of links
T_PRINT_TURNED = np.diag([-1.0, -1.0, 1.0, 1.0])
APRILTAGS = ("DICT_APRILTAG_16h5", "DICT_APRILTAG_25h9", "DICT_APRILTAG_36h10", "DICT_APRILTAG_36h11")
# aruco_detect's parameter dictionary, by its number: OpenCV's enumeration
DICTIONARIES = (
    *(f"DICT_{n}X{n}_{count}" for n in (4, 5, 6, 7) for count in (50, 100, 250, 1000)),
    "DICT_ARUCO_ORIGINAL",
    *APRILTAGS,
)
_NUMBERS = {sextant.canonical_family(name): number for number, name in enumerate(DICTIONARIES)}
_TURNED = {sextant.canonical_family(name) for name in APRILTAGS}


def read_fiducial_slam(path: str, params: MapFormatParams) -> ReadMap:
    """A map file; options give family and size, which it does not say.

    :raises MapFileError: the first line that is none of the format, "file:line: reason"
    """
    family = params.known_family()
    if family not in _NUMBERS:
        raise MapFileError(f"{path}: aruco_detect does not know {family}, only {', '.join(DICTIONARIES)}")
    marker_map = params.empty_map()
    for number, line in enumerate(read_text(path).split("\n"), 1):
        words = line.partition("#")[0].split()
        if words:
            with told_as(_mistake(path, number)):
                marker_map.add(_marker(words, family, params.size))
    return ReadMap(marker_map, _warnings(marker_map))


def _marker(words: List[str], family: str, size: float) -> sextant.MappedMarker:
    id, numbers = _fields(words)
    T_map_theirs = sextant.pose_from_xyz_rpy(numbers[:3], np.deg2rad(numbers[3:6]))
    covariance = numbers[6] * np.eye(6)
    return sextant.MappedMarker(family, id, size, T_map_theirs @ _turn(family), covariance=covariance)


def _mistake(path: str, number: int) -> Callable[[str], MapFileError]:
    return lambda reason: MapFileError(f"{path}:{number}: {reason}")


def _fields(words: List[str]) -> Tuple[int, List[float]]:
    """Id, and the seven numbers behind it."""
    if len(words) < FIELDS:
        raise ValueError(
            f"has {len(words)} fields, needs 'id x y z roll pitch yaw variance observations links...'"
        )
    for word in (words[0], *words[FIELDS - 1 :]):
        if not re.fullmatch(r"\d{1,9}", word):
            raise ValueError(f"'{word}' must be a whole number: an id, the observations, or a link")
    numbers = [finite(word) for word in words[1 : FIELDS - 1]]
    if numbers[6] < 0:
        raise ValueError("a variance cannot be negative")
    return int(words[0]), numbers


def _turn(family: str) -> np.ndarray:
    """(4, 4) between the frames of one print there and here; its own inverse."""
    return T_PRINT_TURNED if family in _TURNED else np.eye(4)


def _warnings(marker_map: sextant.MarkerMap) -> List[str]:
    warnings = ["how often each marker was seen, and which were seen together"]
    if any(np.any(marker.covariance) for marker in marker_map.markers):
        warnings.append(
            "how sure each axis is: fiducial_slam has one variance for all six, taken as m^2 and as rad^2; it"
            " comes from the robot's height and tilt, so put sigma_position and sigma_rotation in its place"
            " if you know them"
        )
    return warnings


def format_fiducial_slam(marker_map: sextant.MarkerMap) -> WrittenMap:
    """A map file: variance is the mean of the three of the position; no observations, no links.

    :raises MapFileError: no markers, several families or sizes, a family that OpenCV does not have
    """
    require_markers(marker_map)
    family = only_family(marker_map, _NUMBERS, "fiducial_slam")
    size = only_size(marker_map, "fiducial_slam")
    lines = [_format_line(marker) for marker in marker_map.markers]
    told = "family and size: aruco_detect needs "
    told += f"dictionary: {_NUMBERS[family]}, fiducial_len: {decimal(size)}"
    if marker_map.frame != "map":
        told += f", fiducial_slam map_frame: {marker_map.frame}"
    warnings = [told, *_reduced(marker_map), *lost_names(marker_map), *lost_frames(marker_map)]
    return WrittenMap("".join(lines), warnings)


def _format_line(marker: sextant.MappedMarker) -> str:
    T_map_theirs = marker.T_map_marker @ _turn(marker.family)
    rpy = np.rad2deg(sextant.rpy_from_rotation(T_map_theirs[:3, :3]))
    numbers = [*T_map_theirs[:3, 3], *rpy, _variance(marker)]
    return " ".join([str(marker.id), *map(decimal, numbers), "0"]) + "\n"


def _variance(marker: sextant.MappedMarker) -> float:
    return float(np.trace(marker.covariance[:3, :3] / 3))


def _reduced(marker_map: sextant.MarkerMap) -> List[str]:
    """Markers whose covariance is more than one variance."""
    variances = [_variance(marker) * np.eye(6) for marker in marker_map.markers]
    pairs = zip(marker_map.markers, variances)
    reduced = sum(not np.allclose(marker.covariance, variance, atol=1e-12) for marker, variance in pairs)
    return [f"of {reduced} covariances all but one variance, the mean over x, y and z"] if reduced else []
