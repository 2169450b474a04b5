# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A corridor with pillars between markers at both ends, which odometry alone does not connect."""

import numpy as np
import pytest
from landmark_bags import observation_message, observations_message, planar
from simulated_observations import T_BASE_CAMERA, SimulatedCamera, wall_map
from written_bags import WrittenBag

import sextant
from sextant.commands.map_markers import main as map_markers
from sextant.commands.maps.map_all import main as map_all
from sextant.geometry.plane_poses import composed, in_frame

TURN = np.pi + 1.0  # where the markers look: their pose is not ambiguous
ENDS = wall_map([(x, y, 1.0, np.sign(y) * TURN) for x in (4.0, 32.0) for y in (1.2, -1.2)])
X = np.arange(2.0, 36.0, 2.5)
PILLARS = np.column_stack([X, 1.6 * (-1.0) ** np.arange(len(X))])
CLASSES = ("red_pillar", "blue_pillar", "green_pillar")
RATE, REACH = 5, 5.0  # Hz; metres of the sensors
SCALE, TURNING = 1.03, 0.001  # of odometry: over the true distance; radians a metre


def write_corridor(path):
    """The robot drives 31 m along x, a metre a second."""
    rng, camera, odometry = np.random.default_rng(1), SimulatedCamera("plumb_bob 0"), np.zeros(3)
    with WrittenBag(path) as bag:
        bag.transforms([("base_link", "camera", T_BASE_CAMERA)])
        for number in range(31 * RATE + 1):
            at = number / RATE
            pose = np.array([at, 0.0, 0.0])
            bag.odometry("/odom", planar(odometry), at)
            odometry = composed(odometry, np.array([SCALE, 0.0, TURNING]) / RATE)
            near = [
                each for each in camera.visible(planar(pose), ENDS) if each.T_map_marker[0, 3] - at < REACH
            ]
            bag.markers("/markers", camera.view(planar(pose), near).detections, camera.calibration, at)
            bag.write("/landmarks", observations_message(at, list(seen(pose, rng))), at)
    return str(path)


def seen(pose, rng):
    for number, (x, y) in enumerate(in_frame(pose, PILLARS)):
        if 0.0 < x < REACH:
            position = np.array([x, y]) + 0.03 * rng.standard_normal(2)
            yield observation_message(CLASSES[number % 3], position, 0.03**2 * np.eye(2))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The bag, and a map of the markers where the drive begins."""
    folder = tmp_path_factory.mktemp("corridor")
    write_corridor(folder / "drive.bag")
    known = sextant.MarkerMap("corridor")
    for id in (0, 1):
        known.add(ENDS.find("tag36h11", id))
    sextant.write_marker_map(known, str(folder / "known.yaml"))
    return folder


@pytest.mark.slow
def test_landmarks_connect_markers_that_are_far_apart(folder):
    given = [str(folder / "drive.bag"), "--known", str(folder / "known.yaml")]
    assert map_markers([*given, "-o", str(folder / "alone.yaml"), "--floor-sigma", "0.01"]) == 0
    assert [each.id for each in sextant.read_marker_map(str(folder / "alone.yaml")).markers] == [0, 1]
    assert map_all([*given, "-o", str(folder / "hall")]) == 0
    made = sextant.read_marker_map(str(folder / "hall/markers.yaml"))
    assert [each.id for each in made.markers] == [0, 1, 2, 3]
    for marker in made.markers:
        error = sextant.pose_error(ENDS.find(marker.family, marker.id).T_map_marker, marker.T_map_marker)
        assert np.linalg.norm(error[:3]) < 0.3  # odometry is off by 0.9 m there
        assert error @ np.linalg.solve(marker.covariance, error) < 22.5  # one of 1000
    made = sextant.read_landmark_map(str(folder / "hall/landmarks.yaml"))
    ids = {
        label.id: each.position for label, each in zip(made.labels, made.landmarks) if label.id is not None
    }
    for id, position in ids.items():
        truth = ENDS.find("tag36h11", id).T_map_marker[:2, 3]
        assert np.hypot(*(position - truth)) < 0.3
    assert sorted(ids) == [0, 1, 2, 3]
