# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""accuracy_statistics for a static camera at measured distances."""

import argparse
import functools
from pathlib import Path
from typing import Dict, List, NamedTuple, Optional, Sequence

import numpy as np

import sextant
from sextant.bags.drive_reader import read_drive
from sextant.bags.recorded_poses import RecordedPoses, read_poses
from sextant.commands.bag_options import read_bags
from sextant.commands.command_line import Answer, check_output
from sextant.commands.located_bags import (
    localization_params,
    located_poses,
    marker_frame,
    measured_marker,
    noted,
    read_map,
    reading,
)
from sextant.evaluation.accuracy_report import AccuracyFiles, accuracy_table, write_accuracy
from sextant.evaluation.accuracy_yaml import CornerNoise
from sextant.evaluation.corner_scatter import corner_noise
from sextant.evaluation.distance_folders import DistanceBag, distance_bags
from sextant.evaluation.pose_series import (
    AXES,
    GroundTruth,
    PoseSeries,
    by_distance,
    pose_series,
    series_statistics,
)

FACING = np.pi  # roll of a camera that faces the marker, in the marker's frame


class _Found(NamedTuple):
    poses: List[RecordedPoses]
    notes: List[str]
    noise: Optional[CornerNoise] = None  # None: not measured


def accuracy_of_series(options: argparse.Namespace) -> Answer:
    """Reads the bags of all distances and writes workbook, plots and parameters.

    :raises ValueError, RuntimeError: an option or bag is invalid; nothing was written
    """
    if len(options.inputs) != 1:
        raise ValueError("a series is one folder; drives need --truth or --truth-frame")
    files = AccuracyFiles.named(options.output)
    for path in files:
        check_output(path, options.force)
    truth = true_poses(options)
    bags = distance_bags(options.inputs[0], options.axis)
    if bags.problems and not options.skip:
        raise ValueError(f"{bags.problems[0]}; --skip continues without it")
    found = (_recorded if options.pose else _located)([each.path for each in bags.bags], options)
    series = _series(bags.bags, found)
    statistics = [series_statistics(each, truth) for each in series]
    written = write_accuracy(files, series, statistics, found.noise)
    skipped = [f"skipped: {problem}" for problem in bags.problems]
    notes = [*skipped, *found.notes, *_notes(series)]
    return Answer([*notes, *accuracy_table(statistics), *written])


def true_poses(options: argparse.Namespace) -> GroundTruth:
    """Returns the true values of the axes that are not measured.

    In a marker's frame, the defaults are 0 and a camera that faces the marker; else they are unknown.

    :raises ValueError: a value is not a number, or an axis is unknown
    """
    others: Dict[str, Optional[float]] = dict.fromkeys(AXES, None)
    if not (options.pose or options.map):
        others = {**dict.fromkeys(AXES, 0.0), "roll": FACING}
    del others[options.axis]
    for axis, value in options.true:
        try:
            others[axis] = None if value == "unknown" else float(value)
        except ValueError:
            raise ValueError(f"--true {axis}={value}: '{value}' is neither a number nor unknown") from None
    truth = GroundTruth(options.axis, others)
    truth.at(0.0)
    return truth


def _recorded(bags: Sequence[str], options: argparse.Namespace) -> _Found:
    read, notes = read_bags(functools.partial(read_poses, topic=options.pose), bags, options)
    return _Found([poses for _, poses in read], notes)


def _located(bags: Sequence[str], options: argparse.Namespace) -> _Found:
    localization_params(options.corner_sigma)  # fail before reading the bags
    marker_map = read_map(options)
    if marker_map is None:
        marker_frame(options.family, 0, options.size)
    what = reading(options, camera_is_base=True)
    read, notes = read_bags(functools.partial(read_drive, params=what), bags, options)
    drives = [drive for _, drive in read]
    marker_map = marker_map or measured_marker(drives, options)
    noise = _noise(drives, marker_map, options.corner_sigma)
    params = localization_params(noise.sigma if options.corner_sigma is None else options.corner_sigma)
    poses = [located_poses(drive, marker_map, params) for drive in drives]
    notes += noted(poses)
    if noise is not None:
        notes.append(f"corner noise: {noise.sigma:.3g} px. {noise.measured}")
    return _Found(poses, notes, noise)


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
    """Returns one series per distance.

    :raises ValueError: no bag has a pose
    """
    poses = {each.bag: each for each in found.poses}
    series = [_bag_series(bag, poses[bag.path]) for bag in bags if bag.path in poses]
    if not any(len(each.poses) for each in series):
        reasons = "; ".join([*found.notes, *_notes(series)]) or "no marker was seen"
        raise ValueError(f"no bag has a pose: {reasons}")
    return by_distance(series)


def _bag_series(bag: DistanceBag, of: RecordedPoses) -> PoseSeries:
    name = f"{Path(bag.path).parent.name}/{Path(bag.path).name}"
    return pose_series(bag.distance, name, of.stamps, of.poses, of.covariances, of.start, of.frame)


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
