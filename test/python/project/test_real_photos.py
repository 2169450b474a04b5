# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Photos of real prints; what is expected comes from other detectors (benchmark/real_data.py)."""

import numpy as np
import pytest
import real_data
from under_test import detector

import sextant
from markers import real_photos

FOLDER = real_data.EXTERNAL / "markers/photos"
pytestmark = pytest.mark.skipif(
    not FOLDER.is_dir(), reason="the external test data (markers/photos) is not there"
)

BAG_MARKERS = (106, 107, 112)  # whose places are known relative to 111


@pytest.fixture
def photos():
    return real_data.Photos(FOLDER)


def test_pose_of_marker_403(photos):
    position, angle, reprojection_error = real_photos.pose_of_403(photos)
    assert position <= 2e-3
    assert np.degrees(angle) <= 1.0
    assert reprojection_error <= 0.11


def test_a_grey_photo_gives_the_same_corners_as_a_coloured_one(photos):
    aruco = detector(photos.expected["dictionary"])
    coloured = photos.image("tag_01_d7_14cm.png")
    grey = coloured @ [0.114, 0.587, 0.299]  # ITU-R BT.601, as all of OpenCV
    (expected,) = aruco.detect(coloured)
    (found,) = aruco.detect(np.round(grey).astype(np.uint8))
    np.testing.assert_allclose(found.corners, expected.corners, atol=0.02)


def test_corners(photos):
    assert real_photos.farthest_corner(photos) <= 0.7


def test_nothing_else_is_found(photos):
    aruco = detector(photos.expected["dictionary"])
    for name, known in photos.corners().items():
        assert {each.id for each in aruco.detect(photos.image(name))} == set(known)


def test_the_bag_has_seven_markers_where_they_hang(photos):
    """The bag does not contain their size: positions are compared in marker sizes, the edge being 1."""
    detections = {each.id: each for each in real_photos.bag_markers(photos)}
    assert len(detections) == 7
    K = [1014.343103379204, 0, 637.2463708126373, 0, 1011.69373183754, 469.5663779911617, 0, 0, 1]
    D = [0.1570058008946036, -0.2862704919204555, -5.60164774255961e-05, 0.001586362091473342, 0.0]
    camera = sextant.CameraModel(real_data.calibration((1280, 960), K, D, "plumb_bob"))
    T = {
        id: sextant.solve_marker_pose(camera, each.corners, 1.0).best.T_camera_marker
        for id, each in detections.items()
    }
    places = np.array([(np.linalg.inv(T[111]) @ T[id])[:3, 3] for id in BAG_MARKERS])
    known = np.array([photos.expected["aruco_images.bag"][id]["xyz"] for id in BAG_MARKERS])
    size = np.sum(known * known) / np.sum(known * places)  # least squares, known = size * places
    assert 0.1 < size < 0.2
    np.testing.assert_allclose(size * places, known, atol=0.02)


def test_apriltags_outdoors(photos):
    found, wrong, known = real_photos.outdoor_tags(photos)
    assert (known, wrong) == (47, 0)
    assert found >= 46
