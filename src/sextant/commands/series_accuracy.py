# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""accuracy_statistics of a camera that stood still at measured distances."""

import argparse
from pathlib import Path
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from sextant.bags.recorded_poses import RecordedPoses
from sextant.commands.command_line import Answer, check_output
from sextant.commands.located_bags import (
    located_poses,
    read_drives,
    recorded_poses,
    reference_map,
)
from sextant.statistics.accuracy_report import AccuracyFiles, accuracy_table, write_accuracy
from sextant.statistics.accuracy_yaml import CornerNoise
from sextant.statistics.corner_scatter import corner_noise
from sextant.statistics.distance_folders import DistanceBag, distance_bags
from sextant.statistics.pose_series import Truths, by_distance, pose_series, series_statistics

FACING = np.pi  # roll of an optical frame that looks at the marker whose frame it is in


class _Located(NamedTuple):
    poses: List[Tuple[str, RecordedPoses]]
    notes: List[str]
    noise: Optional[CornerNoise]


def series_accuracy(options: argparse.Namespace) -> Answer:
    """Reads the bags of all distances and writes workbook, plots and parameters.

    :raises ValueError, RuntimeError: an option or a bag that cannot be; nothing was written then
    """
    if len(options.inputs) != 1:
        raise ValueError("a series is one folder; of drives --truth or --truth-frame tells the truth")
    files = AccuracyFiles.named(options.output)
    for path in files:
        check_output(path, options.force)
    truths = true_poses(options)
    truths.at(0.0)
    found = distance_bags(options.inputs[0], options.axis)
    if found.problems and not options.skip:
        raise ValueError(f"{found.problems[0]}; --skip goes on without it")
    located = _locate([each.path for each in found.bags], options)
    series = by_distance(
        [_series(bag, dict(located.poses)) for bag in found.bags if bag.path in dict(located.poses)]
    )
    statistics = [series_statistics(each, truths) for each in series]
    written = write_accuracy(files, series, statistics, located.noise)
    skipped = [f"skipped: {problem}" for problem in found.problems]
    return Answer([*skipped, *located.notes, *accuracy_table(statistics), *written])


def true_poses(options: argparse.Namespace) -> Truths:
    """:raises ValueError: a value that is no number"""
    facing = {"roll": FACING} if not (options.pose or options.map) and options.axis != "roll" else {}
    others: Dict[str, Optional[float]] = {**facing}
    for axis, value in options.true:
        try:
            others[axis] = None if value == "unknown" else float(value)
        except ValueError:
            raise ValueError(f"--true {axis}={value}: '{value}' is neither a number nor unknown") from None
    return Truths(options.axis, others)


def _locate(bags: Sequence[str], options: argparse.Namespace) -> _Located:
    if options.pose:
        poses, notes, _ = recorded_poses(bags, options)
        return _Located(poses, notes, None)
    read, notes = read_drives(bags, options, camera_is_base=True)
    drives = [drive for _, drive in read]
    noise = corner_noise(drives)
    sigma = noise.sigma if options.corner_sigma is None else options.corner_sigma
    poses, more = located_poses(read, reference_map(options, drives), sigma)
    return _Located(poses, [*notes, *more, f"corner noise: {noise.sigma:.3g} px. {noise.measured}"], noise)


def _series(bag: DistanceBag, poses: Dict[str, RecordedPoses]):
    of = poses[bag.path]
    name = f"{Path(bag.path).parent.name}/{Path(bag.path).name}"
    return pose_series(bag.distance, name, of.stamps, of.poses, of.covariances, of.start)
