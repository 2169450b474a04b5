# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Detected markers as observations in the robot frame, from projected corners of known markers."""

import numpy as np
from simulated_observations import T_BASE_CAMERA, SimulatedCamera, wall_map

import sextant
from sextant.bags.landmark_reader import OdometryReading, RecordedLandmarks
from sextant.bags.marker_scans import marker_scans, with_marker_scans
from sextant.localization.drive_observations import DriveCamera, DriveObservations, ImageDetections

WALL = wall_map([(3.0, -0.6, 1.0, 2.8), (3.2, 0.8, 1.2, 3.4)])
T_MAP_BASE = sextant.pose_from_xyz_rpy([0.3, 0.1, 0.0], [0.0, 0.0, 0.1])
PARAMS = sextant.MarkerLandmarkParams()


def size_in(marker_map):
    def size_of(family, id):
        marker = marker_map.find(family, id)
        return marker.size if marker else None

    return size_of


def drive(*images):
    camera = SimulatedCamera("plumb_bob 4")
    cameras = {"front": DriveCamera(camera.calibration, T_base_camera=T_BASE_CAMERA)}
    return DriveObservations("a.bag", cameras, list(images))


def detections(*markers, seed=1):
    return SimulatedCamera("plumb_bob 4", sigma=0.1, seed=seed).view(T_MAP_BASE, list(markers)).detections


def test_positions_and_headings_are_those_of_the_markers():
    (scan,) = marker_scans(
        drive(ImageDetections(7, "front", detections(*WALL.markers))), size_in(WALL), PARAMS
    )
    assert scan.stamp == 7 and scan.has_markers and len(scan.observations) == 2
    np.testing.assert_allclose(scan.T_base_sensor, [0.1, 0.0, 0.0], atol=1e-9)
    for seen, marker in zip(scan.observations, WALL.markers):
        T = np.linalg.inv(T_MAP_BASE) @ marker.T_map_marker
        error = seen.observation.position - T[:2, 3]
        covariance = seen.observation.covariance[:2, :2]
        assert (seen.label.class_name, seen.label.id) == (marker.family, marker.id)
        assert np.hypot(*error) < 0.1 and error @ np.linalg.solve(covariance, error) < 13.8  # 99.9 %


def test_markers_that_are_not_mapped_or_seen_twice_are_left_out():
    first, second = WALL.markers
    alone = sextant.MarkerMap()
    alone.add(first)
    assert marker_scans(drive(ImageDetections(1, "front", detections(second))), size_in(alone), PARAMS) == []
    twice = [*detections(first), *detections(first, seed=2), *detections(second)]
    (scan,) = marker_scans(drive(ImageDetections(1, "front", twice)), size_in(WALL), PARAMS)
    assert [seen.label.id for seen in scan.observations] == [second.id]


def test_mapped_markers_measure_the_slope_of_a_ramp():
    T_map_tilted = T_MAP_BASE @ sextant.pose_from_xyz_rpy(np.zeros(3), [0.0, 0.1, 0.0])
    seen = SimulatedCamera("plumb_bob 4", sigma=0.1, seed=1).view(T_map_tilted, list(WALL.markers)).detections
    params, errors = sextant.MarkerLandmarkParams(), []
    params.ramp_sigma = 0.1
    for marker_map in (None, WALL):
        (scan,) = marker_scans(drive(ImageDetections(1, "front", seen)), size_in(WALL), params, marker_map)
        true = [(np.linalg.inv(T_MAP_BASE) @ marker.T_map_marker)[:2, 3] for marker in WALL.markers]
        off = [each.observation.position - position for each, position in zip(scan.observations, true)]
        errors.append(np.hypot(*np.transpose(off)).max())
    assert errors[1] < 0.3 * errors[0]


def test_scans_are_between_the_readings_of_odometry():
    readings = [OdometryReading(stamp, np.zeros(3)) for stamp in (1, 5, 9)]
    recorded = RecordedLandmarks("a.bag", 0.0, 1.0, readings, ())
    scans = marker_scans(drive(ImageDetections(6, "front", detections(*WALL.markers))), size_in(WALL), PARAMS)
    assert [each.stamp for each in with_marker_scans(recorded, scans).messages] == [1, 5, 6, 9]
