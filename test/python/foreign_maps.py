# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Maps of other packages for the tests; where their markers hang is written in test/data/map_formats."""

from pathlib import Path

import numpy as np
import pytest

import sextant
from sextant.markers.formats.format_types import MapFileError, MapFormatParams
from sextant.markers.map_formats import read_map

DATA = Path(__file__).resolve().parents[1] / "data/map_formats"
PRINTS = MapFormatParams(family="DICT_5X5_50", size=0.2)
TAGS = MapFormatParams()
FILES = {
    "fiducial_slam.txt": ("fiducial_slam", PRINTS),
    "tags.yaml": ("apriltag_ros", TAGS),
    "tagslam.yaml": ("tagslam", TAGS),
    "poses.yaml": ("tagslam", TAGS),
}
# top left, top right, bottom right, bottom left, as one looks at the print
CORNERS = {
    7: [(0.9, 3, 1.6), (1.1, 3, 1.6), (1.1, 3, 1.4), (0.9, 3, 1.4)],
    8: [(4, -0.9, 1.3), (4, -1.1, 1.3), (4, -1.1, 1.1), (4, -0.9, 1.1)],
    9: [(0.4, 0.35, 0), (0.6, 0.35, 0), (0.6, 0.15, 0), (0.4, 0.15, 0)],
}


def corners_in_map(marker):
    T = marker.T_map_marker
    return sextant.marker_corners(marker.size) @ T[:3, :3].T + T[:3, 3]


def read_file(name):
    return read_map(str(DATA / name), *FILES[name])


def variances(read, id):
    (marker,) = (each for each in read.marker_map.markers if each.id == id)
    assert np.abs(marker.covariance - np.diag(np.diag(marker.covariance))).max() < 1e-9
    return np.diag(marker.covariance)


def example_map(exact=True, frame="map", family="tag36h11", sizes=(0.2, 0.2)):
    """Two markers, turned about no axis in particular; one of them upside down (half a turn)."""
    marker_map = sextant.MarkerMap(frame)
    poses = [([1, -2, 0.3], [0.4, -0.5, 2.5]), ([1e-6, 20.25, -3], [np.pi, 0, 0])]
    for id, (size, (xyz, rpy)) in enumerate(zip(sizes, poses), 3):
        T = sextant.pose_from_xyz_rpy(xyz, rpy)
        covariance = np.zeros((6, 6)) if exact else 0.0025 * np.eye(6)
        marker_map.add(sextant.MappedMarker(family, id, size, T, covariance=covariance))
    return marker_map


def refused(tmp_path, file, text, name, options):
    """The reason, from the line number on."""
    path = tmp_path / file
    path.write_text(text)
    with pytest.raises(MapFileError) as error:
        read_map(str(path), name, options)
    assert str(error.value).startswith(str(path)) and "\n" not in str(error.value)
    return str(error.value)[len(str(path)) :]
