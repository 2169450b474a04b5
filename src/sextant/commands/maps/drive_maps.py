# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Markers and landmarks of one drive in one frame, and the path of the robot.

Where markers are far apart, the drift of odometry between them is larger than what a marker map allows for.
With landmarks between them, their path replaces odometry.
"""

import dataclasses
import tempfile
from typing import Dict, Optional, Set

import numpy as np

import sextant
from sextant.bags.drive_photos import BasePath
from sextant.bags.drive_reader import RecordedDrive
from sextant.bags.landmark_reader import OdometryReading, RecordedLandmarks
from sextant.bags.marker_scans import SizeOf, marker_scans, with_marker_scans
from sextant.commands.map_landmarks import MadeLandmarks, made_landmarks, robot_poses
from sextant.commands.map_markers import MadeMarkers, MarkerInputs
from sextant.geometry.plane_poses import planar
from sextant.geometry.poses import MAX_GAP
from sextant.landmarks.slam_run import SlamRun

# Standard deviations of the first pose, metres, metres, radians: the robot may move until the first image.
START_SIGMAS = [0.3, 0.3, 0.2]
# Noise of a path by landmarks as sextant.OdometryParams: position and heading after a metre, heading after a
# radian; metres, radians.
PATH_DRIFT = {"position_drift": 0.03, "heading_drift": 0.005, "turn_drift": 0.02}

Params = "sextant.LandmarkSlamNodeParams"
Drives = Dict[str, RecordedDrive]  # by bag
Recorded = Dict[str, RecordedLandmarks]  # by bag


def path_of_markers(made: MadeMarkers) -> BasePath:
    """The path of the robot by the images of markers, and odometry between them."""
    pairs = zip(made.recorded.stamps.tolist(), made.result.T_map_base)
    return _path(made.result.map.frame, {stamp: T for stamp, T in pairs if T is not None})


def path_of_landmarks(made: MadeLandmarks) -> BasePath:
    """The path of the robot by all observations."""
    return _path(made.result.map.frame, robot_poses(made.result))


def _path(frame: str, poses: Dict[int, np.ndarray]) -> BasePath:
    stamps = sorted(poses)
    at = np.array([poses[stamp] for stamp in stamps]).reshape(-1, 4, 4)
    return BasePath(frame, np.array(stamps, dtype=np.int64), at)


def with_path_by_landmarks(
    drives: Drives, recorded: Recorded, inputs: MarkerInputs, params: Params
) -> Drives:
    """The drives with the path by landmarks and markers instead of odometry; sets the noise of inputs.params.

    :returns: the same drives if the observations do not determine a path of each
    """
    scanned = _with_scans(drives, recorded, _expected_size(inputs), params)
    made = made_landmarks(list(scanned.values()), SlamRun(params))
    if not made.result.sightings:
        return drives
    poses = robot_poses(made.result)
    found = {bag: _with_path(drive, recorded.get(bag), poses) for bag, drive in drives.items()}
    if any(each is None for each in found.values()):  # the noise is that of all drives
        return drives
    for name, value in PATH_DRIFT.items():
        setattr(inputs.params.odometry, name, value)
    return found


def _with_path(
    drive: RecordedDrive, recorded: Optional[RecordedLandmarks], poses: Dict[int, np.ndarray]
) -> Optional[RecordedDrive]:
    messages = recorded.messages if recorded else ()
    stamps = [each.stamp for each in messages if isinstance(each, OdometryReading) and each.stamp in poses]
    if not stamps:
        return None
    at = np.array([poses[stamp] for stamp in stamps])
    return dataclasses.replace(drive, odometry_stamps=np.array(stamps, dtype=np.int64), odometry=at)


def landmarks_among(
    markers: MadeMarkers, drives: Drives, recorded: Recorded, inputs: MarkerInputs, params: Params
) -> MadeLandmarks:
    """Landmarks in the frame of the marker map. Markers that it lacks are landmarks, too: only landmarks may
    connect them with the others. Those that were moved or printed twice are not used.

    Sets the start in params.
    """
    expected, moved = _expected_size(inputs), set(markers.result.inconsistent)
    mapped = _size_in(markers.result.map)

    def size_of(family: str, id: int) -> Optional[float]:
        return None if (family, id) in moved else mapped(family, id) or expected(family, id)

    scanned = _with_scans(drives, recorded, size_of, params, markers.result.map)
    _set_start(params, path_of_markers(markers), scanned)
    return made_landmarks(list(scanned.values()), _run_among(params, markers.result.map))


def own_landmarks(made: MadeLandmarks) -> Set[int]:
    """Indices of the landmarks that are no markers."""
    scans = [scan for segment in made.slam_run.segments for scan in segment.scans if scan.has_markers]
    markers = {seen.label for scan in scans for seen in scan.observations}
    markers.update(made.slam_run.first_map.labels)
    return {index for index, label in enumerate(made.result.map.labels) if label not in markers}


def _with_scans(
    drives: Drives,
    recorded: Recorded,
    size_of: SizeOf,
    params: Params,
    marker_map: Optional["sextant.MarkerMap"] = None,
) -> Recorded:
    given = size_of, params.markers, marker_map
    scans = {bag: marker_scans(drive, *given) for bag, drive in drives.items()}
    return {bag: with_marker_scans(each, scans.get(bag, ())) for bag, each in recorded.items()}


def _size_in(marker_map: "sextant.MarkerMap") -> SizeOf:
    """Of the markers of a map."""
    sizes = {(marker.family, marker.id): marker.size for marker in marker_map.markers}
    return lambda family, id: sizes.get((family, id))


def _expected_size(inputs: MarkerInputs) -> SizeOf:
    """Of all markers."""
    known, others = _size_in(inputs.known), inputs.sizes.sizes

    def size_of(family: str, id: int) -> float:
        own = others.get(f"{family}/{id}", others.get(str(id), inputs.sizes.size))
        return known(family, id) or own

    return size_of


def _set_start(params: Params, path: BasePath, recorded: Recorded) -> None:
    """Sets where the robot starts, if markers show that; otherwise it is lost until it observes one."""
    first = min(recorded.values(), key=lambda each: each.start)
    begin = next(message.stamp for message in first.messages if isinstance(message, OdometryReading))
    nearest = int(np.abs(path.stamps - begin).argmin())
    if abs(path.stamps[nearest] - begin) <= 1e9 * MAX_GAP:
        params.start_pose, params.pose_sigma = planar(path.poses[nearest]).tolist(), START_SIGMAS


def _run_among(params: Params, marker_map: "sextant.MarkerMap") -> SlamRun:
    with tempfile.TemporaryDirectory() as folder:
        params.marker_map_file = f"{folder}/markers.yaml"
        sextant.write_marker_map(marker_map, params.marker_map_file)
        run = SlamRun(params)
    params.marker_map_file = ""
    return run
