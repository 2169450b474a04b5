# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The locator on recorded corners, against poses that tagslam optimized from them."""

import numpy as np
import pytest
import real_data
from under_test import locator

import sextant
from markers import recorded_drives

FOLDER = real_data.EXTERNAL / "markers"
pytestmark = pytest.mark.skipif(
    not all((FOLDER / name).is_dir() for name in recorded_drives.TITLES),
    reason="the external test data (markers/tagslam_*) is not there",
)


@pytest.fixture(scope="module", params=list(recorded_drives.TITLES))
def recording(request):
    return request.param, real_data.read_tagslam(FOLDER / request.param)


@pytest.mark.slow
def test_every_mode_reaches_its_bar(recording):
    table = recorded_drives.recording_table(*recording)
    assert table.holds, str(table)


@pytest.mark.slow
def test_every_image_with_a_reference_has_a_pose(recording):
    _, recorded = recording
    joint = locator("joint")
    for observation in recorded.referenced():
        result = joint.locate(recorded.map, [recorded.view(observation)])
        assert result.pose, result.reason


def test_reference_poses_project_the_map_onto_the_corners(recording):
    """Guards the reader: mounts, order of corners and lens models fit what was recorded."""
    _, recorded = recording
    errors = [error for each in recorded.referenced() for error in corner_errors(recorded, each)]
    assert np.median(errors) < 0.5  # pixels


def corner_errors(recorded, observation):
    T_map_camera = recorded.trajectory[observation.stamp] @ recorded.mounts[observation.camera]
    for detection in observation.detections:
        marker = recorded.map.find("tag36h11", detection.id)
        T_camera_marker = np.linalg.inv(T_map_camera) @ marker.T_map_marker
        for corner, pixel in zip(sextant.marker_corners(marker.size), detection.corners):
            projected = recorded.cameras[observation.camera].project((T_camera_marker @ [*corner, 1.0])[:3])
            yield np.inf if projected is None else np.linalg.norm(projected - pixel)
