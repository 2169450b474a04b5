# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Photos of real prints: corners, poses and what is found at all."""

from typing import List, Tuple

import numpy as np
from real_data import Photos
from tables import Table, Value
from under_test import detector

import sextant

SAME_MARKER = 3.0  # pixels between the middles of one marker in two lists


def photo_tables(photos: Photos) -> List[Table]:
    """Everything that is known of the photos, with its bar."""
    position, angle, error = pose_of_403(photos)
    found, wrong, known = outdoor_tags(photos)
    rows = [
        ("403.jpg: error of the marker's position in the map, mm", [Value(position * 1e3, at_most=2.0)]),
        ("403.jpg: error of its rotation, degrees", [Value(np.degrees(angle), at_most=1.0)]),
        ("403.jpg: reprojection error, RMS, pixels", [Value(error, 3, at_most=0.11)]),
        ("other photos: farthest corner, pixels", [Value(farthest_corner(photos), at_most=0.7)]),
        ("aruco_images.bag: markers found, of 7", [Value(len(bag_markers(photos)), 0, at_least=7)]),
        (f"outdoors: AprilTags found, of {known}", [Value(found, 0, at_least=46)]),
        ("outdoors: wrong ones", [Value(wrong, 0, at_most=0)]),
    ]
    return [Table("Photos: differences from results of other detectors", ["figure"], rows)]


def pose_of_403(photos: Photos) -> Tuple[float, float, float]:
    """(metres, radians, RMS pixels): errors of the marker's map pose, and its reprojection error."""
    expected = photos.expected
    detections = detector(expected["dictionary"]).detect(photos.image("403.jpg"))
    corners = next(each.corners for each in detections if each.id == 403)
    camera = sextant.CameraModel(photos.calibration)
    pose = sextant.solve_marker_pose(camera, corners, expected["marker_size"]).best
    error = sextant.pose_error(photos.T_map_marker, photos.T_base_camera @ pose.T_camera_marker)
    return np.linalg.norm(error[:3]), np.linalg.norm(error[3:]), pose.reprojection_error


def farthest_corner(photos: Photos) -> float:
    """Largest distance between a found and a known corner, pixels; infinite where a marker is missed."""
    aruco = detector(photos.expected["dictionary"])
    farthest = 0.0
    for name, known in photos.corners().items():
        found = {each.id: each.corners for each in aruco.detect(photos.image(name))}
        for id, corners in known.items():
            off = np.linalg.norm(found[id] - corners, axis=1).max() if id in found else np.inf
            farthest = max(farthest, off)
    return farthest


def bag_markers(photos: Photos) -> list:
    """sextant.Detection of every marker in the bag's image."""
    return detector(photos.expected["dictionary"]).detect(photos.bag_image())


def outdoor_tags(photos: Photos) -> Tuple[int, int, int]:
    """(found, wrong, known) AprilTags; wrong: with an id that no tag of the photo has, or a known one twice.

    The lists are another detector's: they lack some tags, of the same ids.
    """
    apriltag = detector("tag36h11")
    found = wrong = total = 0
    for name, known in photos.outdoors().items():
        total += len(known)
        left = list(known)
        for detection in apriltag.detect(photos.image(name)):
            match = next((tag for tag in left if _same(tag, detection)), None)
            if match is not None:
                found += 1
                left = [tag for tag in left if tag is not match]
            else:
                wrong += _is_wrong(known, detection)
    return found, wrong, total


def _is_wrong(known: list, detection) -> bool:
    return detection.id not in dict(known) or any(_same(tag, detection) for tag in known)


def _same(tag: tuple, detection) -> bool:
    id, corners = tag
    apart = np.linalg.norm(corners.mean(axis=0) - detection.corners.mean(axis=0))
    return id == detection.id and apart < SAME_MARKER
