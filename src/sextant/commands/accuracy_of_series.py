# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""accuracy_statistics of a camera that stood still at measured distances."""

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
    MapFile,
    localization_params,
    located_poses,
    marker_frame,
    measured_marker,
    noted,
    reading,
)
from sextant.evaluation.accuracy_report import AccuracyFiles, accuracy_table, write_accuracy
from sextant.evaluation.accuracy_yaml import CornerNoise
from sextant.evaluation.corner_scatter import corner_noise
from sextant.evaluation.distance_folders import DistanceBag, distance_bags
from sextant.evaluation.pose_series import (
    AXES,
    PoseSeries,
    Truths,
    by_distance,
    pose_series,
    series_statistics,
)

FACING = np.pi  # roll of an optical frame that looks at the marker whose frame it is in


class _Found(NamedTuple):
    poses: List[RecordedPoses]
    notes: List[str]
    noise: Optional[CornerNoise] = None  # None: not measured


def accuracy_of_series(options: argparse.Namespace) -> Answer:
    """Reads the bags of all distances and writes workbook, plots and parameters.

    :raises ValueError, RuntimeError: an option or a bag that cannot be; nothing was written then
    """
    if len(options.inputs) != 1:
        raise ValueError("a series is one folder; of drives --truth or --truth-frame tells the truth")
    files = AccuracyFiles.named(options.output)
    for path in files:
        check_output(path, options.force)
    truths = true_poses(options)
    bags = distance_bags(options.inputs[0], options.axis)
    if bags.problems and not options.skip:
        raise ValueError(f"{bags.problems[0]}; --skip goes on without it")
    found = (_recorded if options.pose else _located)([each.path for each in bags.bags], options)
    series = _series(bags.bags, found)
    statistics = [series_statistics(each, truths) for each in series]
    written = write_accuracy(files, series, statistics, found.noise)
    skipped = [f"skipped: {problem}" for problem in bags.problems]
    notes = [*skipped, *found.notes, *_notes(series)]
    return Answer([*notes, *accuracy_table(statistics), *written])


def true_poses(options: argparse.Namespace) -> Truths:
    """Of a marker's frame, the others are 0 and the camera faces it; of another frame nobody knows.

    :raises ValueError: a value that is no number, an axis that there is not
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
    truths = Truths(options.axis, others)
    truths.at(0.0)
    return truths


def _recorded(bags: Sequence[str], options: argparse.Namespace) -> _Found:
    read, notes = read_bags(functools.partial(read_poses, topic=options.pose), bags, options)
    return _Found([poses for _, poses in read], notes)


def _located(bags: Sequence[str], options: argparse.Namespace) -> _Found:
    localization_params(options.corner_sigma)  # before hours of reading
    marker_map = MapFile.of(options).read()
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
    """None where it cannot be measured, and need not. :raises ValueError: it needs to be"""
    try:
        return corner_noise(drives, {(marker.family, marker.id) for marker in marker_map.markers})
    except ValueError as error:
        if given is None:
            raise ValueError(f"{error}; --corner-sigma tells it where the series cannot") from None
        return None


def _series(bags: Sequence[DistanceBag], found: _Found) -> List[PoseSeries]:
    """By distance. :raises ValueError: there is not one pose"""
    poses = {each.bag: each for each in found.poses}
    series = [_bag_series(bag, poses[bag.path]) for bag in bags if bag.path in poses]
    if not any(len(each.poses) for each in series):
        reasons = "; ".join([*found.notes, *_notes(series)]) or "no marker was seen"
        raise ValueError(f"there is not one pose in all bags: {reasons}")
    return by_distance(series)


def _bag_series(bag: DistanceBag, of: RecordedPoses) -> PoseSeries:
    name = f"{Path(bag.path).parent.name}/{Path(bag.path).name}"
    return pose_series(bag.distance, name, of.stamps, of.poses, of.covariances, of.start, of.frame)


def _notes(series: Sequence[PoseSeries]) -> List[str]:
    """What was left out, and what is there twice."""
    notes = []
    for each in series:
        for count in each.counts:
            if count.stale or count.invalid:
                left_out = f"{count.stale} poses stamped before the bag began, {count.invalid} that are none"
                notes.append(f"{count.bag}: left out: {left_out}")
        again = len(each.stamps) - len(np.unique(each.stamps))
        if again:
            notes.append(f"{each.distance:g}: {again} poses have another's stamp: is a bag there twice?")
    return notes
