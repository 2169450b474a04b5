# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""accuracy_statistics for a static camera at measured distances, or a standing robot at surveyed points."""

import argparse
import functools
from dataclasses import replace
from pathlib import Path
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

import sextant
from sextant.bags.drive_reader import read_drive
from sextant.bags.recorded_poses import RecordedPoses, read_poses
from sextant.commands.bag_options import read_bags
from sextant.commands.command_line import Answer, check_output
from sextant.commands.located_bags import (
    chosen_modes,
    chosen_topics,
    localization_params,
    located_poses,
    mapped_markers,
    marker_frame,
    measured_marker,
    noted,
    read_map,
    reading,
)
from sextant.evaluation.accuracy_report import AccuracyFiles, accuracy_table, write_accuracy
from sextant.evaluation.accuracy_yaml import CornerNoise
from sextant.evaluation.corner_scatter import corner_noise
from sextant.evaluation.distance_folders import DistanceBag, DistanceBags, distance_bags
from sextant.evaluation.error_statistics import error_statistics, position_table
from sextant.evaluation.pose_series import (
    AXES,
    GroundTruth,
    PoseSeries,
    TruePoses,
    by_distance,
    pose_series,
    series_statistics,
)
from sextant.evaluation.surveyed_points import SURVEYED, SurveyedPoints, point_bags, read_points
from sextant.localization.drive_observations import DriveObservations
from sextant.simulation.camera import camera_mount

FACING = np.pi  # roll of a camera that faces the marker, in the marker's frame


class _Found(NamedTuple):
    poses: Dict[str, List[RecordedPoses]]  # by method
    notes: List[str]
    noise: Optional[CornerNoise] = None  # None: not measured


def accuracy_of_series(options: argparse.Namespace) -> Answer:
    """Reads the bags of all distances or points and writes workbook, page, plots and parameters.

    :raises ValueError, RuntimeError: an option or bag is invalid; nothing was written
    """
    files = AccuracyFiles.named(options.output)
    for path in files:
        check_output(path, options.force)
    truth, bags = (_surveyed if options.points else _measured)(options)
    if bags.problems and not options.skip:
        raise ValueError(f"{bags.problems[0]}; --skip continues without it")
    found = (_recorded if options.pose else _located)([each.path for each in bags.bags], options)
    series = _series(bags.bags, found)
    statistics = [series_statistics(each, truth) for each in series]
    written = write_accuracy(files, series, statistics, found.noise, mapped_markers(options))
    skipped = [f"skipped: {problem}" for problem in bags.problems]
    table = position_table(error_statistics(statistics)) if options.points else accuracy_table(statistics)
    return Answer([*skipped, *found.notes, *_notes(series), *table, *written])


def _measured(options: argparse.Namespace) -> Tuple[TruePoses, DistanceBags]:
    if len(options.inputs) != 1:
        raise ValueError("a series is one folder of measured distances; surveyed points need --points")
    return true_poses(options), distance_bags(options.inputs[0], options.axis)


def _surveyed(options: argparse.Namespace) -> Tuple[TruePoses, DistanceBags]:
    """Reads --points and finds its bags.

    :raises ValueError: a row is invalid, there is no bag, or no map
    """
    if options.inputs:
        raise ValueError(f"{options.inputs[0]}: the bags of surveyed points are named in --points")
    if not (options.pose or options.map):
        raise ValueError("points are in the frame of a map: set --map, or a topic of poses (--pose)")
    others = _given_truths(options)
    for axis in set(others) & set(SURVEYED):
        raise ValueError(f"the true {axis} is in --points, it cannot be set with --true")
    points = read_points(options.points)
    bags = point_bags(points, options.points.parent)
    if not bags.bags:
        raise ValueError(bags.problems[0])
    return SurveyedPoints(points, others), bags


def true_poses(options: argparse.Namespace) -> GroundTruth:
    """Returns the true values of the axes that are not measured.

    In a marker's frame, the defaults are 0 and a camera that faces the marker; else they are unknown.

    :raises ValueError: a value is not a number, or an axis is unknown
    """
    others: Dict[str, Optional[float]] = dict.fromkeys(AXES, None)
    if not (options.pose or options.map):
        others = {**dict.fromkeys(AXES, 0.0), "roll": FACING}
    del others[options.axis]
    truth = GroundTruth(options.axis, {**others, **_given_truths(options)})
    truth.at(0.0)
    return truth


def _given_truths(options: argparse.Namespace) -> Dict[str, Optional[float]]:
    """Parses --true; None: unknown.

    :raises ValueError: a value is not a number, or an axis is unknown
    """
    given: Dict[str, Optional[float]] = {}
    for axis, value in options.true:
        try:
            given[axis] = None if value == "unknown" else float(value)
        except ValueError:
            raise ValueError(f"--true {axis}={value}: '{value}' is neither a number nor unknown") from None
        if axis not in AXES:
            raise ValueError(f"--true {axis}: '{axis}' is not an axis, allowed are {', '.join(AXES)}")
    return given


def _recorded(bags: Sequence[str], options: argparse.Namespace) -> _Found:
    poses: Dict[str, List[RecordedPoses]] = {}
    notes: List[str] = []
    for method, topic in chosen_topics(options).items():
        read, of_topic = read_bags(functools.partial(read_poses, topic=topic), bags, options)
        poses[method] = [each for _, each in read]
        notes += of_topic
    return _Found(poses, notes)


def _located(bags: Sequence[str], options: argparse.Namespace) -> _Found:
    modes = chosen_modes(options)
    localization_params(options.corner_sigma)  # fail before reading the bags
    marker_map = read_map(options)
    if marker_map is None:
        marker_frame(options.family, 0, options.size)
    drives, notes = _drives(bags, options)
    marker_map = marker_map or measured_marker(drives, options)
    noise = _noise(drives, marker_map, options.corner_sigma)
    sigma = noise.sigma if options.corner_sigma is None else options.corner_sigma
    poses = {}
    for method, mode in modes.items():
        params = localization_params(sigma, mode)
        poses[method] = [located_poses(drive, marker_map, params) for drive in drives]
        notes += noted(poses[method], method)
    if noise is not None:
        notes.append(f"corner noise: {noise.sigma:.3g} px. {noise.measured}")
    return _Found(poses, notes, noise)


def _drives(bags: Sequence[str], options: argparse.Namespace) -> Tuple[List[DriveObservations], List[str]]:
    """Reads the bags; poses are the camera's at distances, the robot's at points."""
    what = reading(options, camera_is_base=not options.points)
    read, notes = read_bags(functools.partial(read_drive, params=what), bags, options)
    return [_facing_forward(drive) if options.points else drive for _, drive in read], notes


def _facing_forward(drive: DriveObservations) -> DriveObservations:
    """Makes x the viewing direction of a camera that is the base itself, so that its yaw can be surveyed."""
    cameras = {
        name: replace(camera, T_base_camera=camera_mount([0.0, 0.0, 0.0], [0.0, 0.0, 0.0]))
        if np.array_equal(camera.T_base_camera, np.eye(4))
        else camera
        for name, camera in drive.cameras.items()
    }
    return replace(drive, cameras=cameras)


def _noise(drives, marker_map: "sextant.MarkerMap", given: Optional[float]) -> Optional[CornerNoise]:
    """Estimates the corner noise; None if that fails and the noise is given.

    :raises ValueError: that fails and the noise is not given
    """
    try:
        return corner_noise(drives, {(marker.family, marker.id) for marker in marker_map.markers})
    except ValueError as error:
        if given is None:
            raise ValueError(f"{error}; set --corner-sigma instead") from None
        return None


def _series(bags: Sequence[DistanceBag], found: _Found) -> List[PoseSeries]:
    """Returns one series per method and distance or point.

    :raises ValueError: no bag has a pose
    """
    series = []
    for method, of_method in found.poses.items():
        poses = {each.bag: each for each in of_method}
        series += [_bag_series(bag, poses[bag.path], method) for bag in bags if bag.path in poses]
    if not any(len(each.poses) for each in series):
        reasons = "; ".join([*found.notes, *_notes(series)]) or "no marker was seen"
        raise ValueError(f"no bag has a pose: {reasons}")
    return by_distance(series)


def _bag_series(bag: DistanceBag, of: RecordedPoses, method: str) -> PoseSeries:
    name = f"{Path(bag.path).parent.name}/{Path(bag.path).name}"
    series = pose_series(
        bag.distance, name, of.stamps, of.poses, of.covariances, of.start, of.frame, of.images
    )
    return replace(series, method=method)


def _notes(series: Sequence[PoseSeries]) -> List[str]:
    """Returns notes on poses that were left out or may be duplicates."""
    notes = []
    for each in series:
        for count in each.counts:
            if count.stale or count.invalid:
                left_out = f"{count.stale} poses stamped before the bag began, {count.invalid} invalid poses"
                notes.append(f"{count.bag}: left out: {left_out}")
        again = len(each.stamps) - len(np.unique(each.stamps))
        if again:
            notes.append(f"{each.distance:g}: {again} poses have duplicate stamps: is there a copy of a bag?")
    return notes
