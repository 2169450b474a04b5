# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Maps of fiducial_slam (package fiducials, UbiquityRobotics, ROS 1).

One line per marker, as in Map::saveMap and Map::loadMap of fiducial_slam/src/map.cpp:

    id x y z roll pitch yaw variance observations links...

Metres, and degrees for tf2's setRPY: R = Rz(yaw) Ry(pitch) Rx(roll). A pose is T_map_marker (T_mapFid =
T_mapCam * T_camFid). links are the ids of markers seen in one image with it.

Marker frame: aruco_detect puts OpenCV's corners at (-, +), (+, +), (+, -), (-, -), z out of the print, as
in Sextant (getSingleMarkerObjectPoints of aruco_detect.cpp). It supports OpenCV's dictionaries only, and
OpenCV prints AprilTags rotated by 180 degrees against libapriltag, whose orientation Sextant uses.

The variance is computed in m^2 from the height and tilt of the resulting robot pose, plus systematic_error
(Map::updatePose). It decreases with every observation as if they were independent (normalizeDavid of
transform_with_variance.cpp). fiducial_slam uses it for all six axes, metres and radians (toPose of
transform_with_variance.h), and so does this reader: variance * I. Variance 0 is a fixed marker: exact.
"""

import re
from typing import List, Tuple

import numpy as np

import sextant
from sextant.markers.formats.format_types import (
    MapFileError,
    MapFormatParams,
    ReadMap,
    WrittenMap,
    decimal,
    errors_located_at,
    fields_of,
    finite,
    read_text,
)
from sextant.markers.formats.losses import lost_frames, lost_names, only_family, only_size

FIELDS = 9  # followed by any number of links
T_PRINT_TURNED = np.diag([-1.0, -1.0, 1.0, 1.0])
APRILTAGS = ("DICT_APRILTAG_16h5", "DICT_APRILTAG_25h9", "DICT_APRILTAG_36h10", "DICT_APRILTAG_36h11")
# values of aruco_detect's parameter dictionary: OpenCV's enumeration
DICTIONARIES = (
    *(f"DICT_{n}X{n}_{count}" for n in (4, 5, 6, 7) for count in (50, 100, 250, 1000)),
    "DICT_ARUCO_ORIGINAL",
    *APRILTAGS,
)
_NUMBERS = {sextant.canonical_family(name): number for number, name in enumerate(DICTIONARIES)}
_TURNED = {sextant.canonical_family(name) for name in APRILTAGS}


def read_fiducial_slam(path: str, params: MapFormatParams) -> ReadMap:
    """Reads a map file.

    :param params: family and size are required, since the file does not contain them
    :raises MapFileError: a malformed line, "file:line: reason"
    """
    family = params.known_family()
    if family not in _NUMBERS:
        raise MapFileError(f"{path}: aruco_detect does not know {family}, only {', '.join(DICTIONARIES)}")
    marker_map = params.empty_map()
    for number, line in enumerate(read_text(path).split("\n"), 1):
        words = fields_of(line)
        if words:
            with errors_located_at(f"{path}:{number}"):
                marker_map.add(_marker(words, family, params.size))
    return ReadMap(marker_map, _warnings(marker_map))


def _marker(words: List[str], family: str, size: float) -> sextant.MappedMarker:
    id, numbers = _fields(words)
    T_map_theirs = sextant.pose_from_xyz_rpy(numbers[:3], np.deg2rad(numbers[3:6]))
    covariance = numbers[6] * np.eye(6)
    return sextant.MappedMarker(family, id, size, T_map_theirs @ _turn(family), covariance=covariance)


def _fields(words: List[str]) -> Tuple[int, List[float]]:
    """Parses the id and the seven numbers after it."""
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
    """Returns (4, 4) between the frames of a print in OpenCV and in Sextant; its own inverse."""
    return T_PRINT_TURNED if family in _TURNED else np.eye(4)


def _warnings(marker_map: sextant.MarkerMap) -> List[str]:
    warnings = ["the number of observations of each marker, and the links"]
    if any(np.any(marker.covariance) for marker in marker_map.markers):
        warnings.append(
            "the uncertainty of each axis: fiducial_slam has one variance for all six, used as m^2 and rad^2;"
            " it comes from the robot's height and tilt, so replace it by sigma_position and sigma_rotation"
            " if you know them"
        )
    return warnings


def format_fiducial_slam(marker_map: sextant.MarkerMap) -> WrittenMap:
    """Formats a map file; the variance is the mean over the three axes of the position, there are no links.

    :raises MapFileError: several families or sizes, or a family that OpenCV does not have
    """
    family = only_family(marker_map, _NUMBERS, "fiducial_slam")
    size = only_size(marker_map, "fiducial_slam")
    lines = [_format_line(marker) for marker in marker_map.markers]
    settings = "family and size: aruco_detect needs "
    settings += f"dictionary: {_NUMBERS[family]}, fiducial_len: {decimal(size)}"
    if marker_map.frame != "map":
        settings += f", fiducial_slam map_frame: {marker_map.frame}"
    warnings = [settings, *_reduced(marker_map), *lost_names(marker_map), *lost_frames(marker_map)]
    return "".join(lines), warnings


def _format_line(marker: sextant.MappedMarker) -> str:
    T_map_theirs = marker.T_map_marker @ _turn(marker.family)
    rpy = np.rad2deg(sextant.rpy_from_rotation(T_map_theirs[:3, :3]))
    numbers = [*T_map_theirs[:3, 3], *rpy, _variance(marker)]
    return " ".join([str(marker.id), *map(decimal, numbers), "0"]) + "\n"


def _variance(marker: sextant.MappedMarker) -> float:
    return float(np.trace(marker.covariance[:3, :3] / 3))


def _reduced(marker_map: sextant.MarkerMap) -> List[str]:
    """Warns of covariances that are not a multiple of the identity."""
    variances = [_variance(marker) * np.eye(6) for marker in marker_map.markers]
    pairs = zip(marker_map.markers, variances)
    reduced = sum(not np.allclose(marker.covariance, variance, atol=1e-12) for marker, variance in pairs)
    return [f"{reduced} covariances: reduced to one variance, the mean over x, y and z"] if reduced else []
