# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""accuracy_statistics for drives with ground truth."""

import argparse
import functools
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Callable, Dict, List, Optional, Sequence, Tuple

import numpy as np

from sextant.bags.bag_params import BagParams
from sextant.bags.drive_reader import read_drive
from sextant.bags.recorded_poses import RecordedPoses, read_frame, read_poses
from sextant.base.atomic_file import atomic_files
from sextant.commands.bag_options import read_bags
from sextant.commands.command_line import Answer, check_output
from sextant.commands.located_bags import localization_params, located_poses, read_map, reading
from sextant.evaluation.drive_accuracy import DriveAccuracy, compare, drive_table, write_errors
from sextant.evaluation.drive_plot import plot_drive
from sextant.evaluation.trajectory import Trajectory
from sextant.evaluation.trajectory_files import read_trajectory
from sextant.evaluation.trajectory_metrics import RPE_UNITS


@dataclass(frozen=True)
class MeasuredDrive:
    """Result of measure()."""

    accuracy: DriveAccuracy  # errors of the poses
    warnings: Tuple[str, ...]  # of reading the bag


def accuracy_of_drives(options: argparse.Namespace) -> Answer:
    """Reads the bags, compares poses with ground truth, and writes errors and plots.

    :raises ValueError, RuntimeError: an option, bag or ground truth is invalid; nothing was written
    """
    bags = _bags(options)
    errors, plots = _files(options.output, bags)
    for path in (errors, *plots.values()):
        check_output(path, options.force)
    rpe = _rpe(*options.rpe)
    measured = functools.partial(_measured(options), rpe=rpe)
    marker_map = read_map(options)
    markers = marker_map.markers if marker_map and not options.align else ()  # aligned: in the truth's frame
    read, notes = read_bags(measured, bags, options)
    drives: Dict[str, DriveAccuracy] = {bag: each.accuracy for bag, each in read}
    with atomic_files(errors.parent) as folder:
        write_errors(folder / errors.name, drives)
        for bag, of in drives.items():
            plot_drive(str(folder / plots[bag].name), of.truth, {bag: of.estimate}, markers)
    written = [f"{errors}: errors of every pose", *(f"{plots[bag]}: plot of {bag}" for bag in drives)]
    return Answer([*notes, *drive_table(drives, rpe), *written])


def _bags(options: argparse.Namespace) -> List[str]:
    named = Counter(path.resolve() for path in options.inputs)
    again = [str(bag) for bag, count in named.items() if count > 1]
    if again:
        raise ValueError(f"{again[0]}: is given twice")
    return [str(path) for path in options.inputs]


def _files(name: Path, bags: Sequence[str]) -> Tuple[Path, Dict[str, Path]]:
    """Returns NAME.csv and, by bag, NAME.png or NAME_1.png, NAME_2.png, ..."""
    numbers = [""] if len(bags) == 1 else [f"_{number}" for number in range(1, len(bags) + 1)]
    plots = {bag: name.with_name(f"{name.name}{number}.png") for bag, number in zip(bags, numbers)}
    return name.with_name(f"{name.name}.csv"), plots


def _measured(options: argparse.Namespace) -> Callable[..., MeasuredDrive]:
    """Reads and checks everything but the bags; returns measure() as a function of a bag."""
    if not (options.pose or options.map):
        raise ValueError("set a marker map (--map) or a topic of poses (--pose)")
    localization_params(options.corner_sigma)
    params = None if options.pose else reading(options, camera_is_base=False)
    truth = read_trajectory(options.truth) if options.truth is not None else None
    return functools.partial(measure, options=options, params=params, truth=truth)


def _rpe(delta: str, unit: str) -> Tuple[float, str]:
    try:
        value = float(delta)
    except ValueError:
        value = np.nan
    whole = unit != "frames" or value.is_integer()
    if not (0.0 < value < np.inf and whole and unit in RPE_UNITS):
        raise ValueError(f"--rpe {delta} {unit}: allowed is a number above 0 and {', '.join(RPE_UNITS)}")
    return value, unit


def measure(
    bag: str,
    options: argparse.Namespace,
    params: Optional[BagParams],
    truth: Optional[Trajectory],
    rpe: Tuple[float, str],
) -> MeasuredDrive:
    """Compares the poses of one drive with its ground truth.

    :param params: None: poses are recorded, on topic options.pose
    :param truth: None: from tf
    :param rpe: delta and unit of sextant.evaluation.trajectory_metrics.relative_errors()
    :raises ValueError, RuntimeError: the bag cannot be read, has no pose, or no ground truth
    """
    poses = _located(bag, options, params) if params else read_poses(bag, options.pose)
    if not len(poses.stamps):
        raise ValueError("; ".join(poses.warnings) or "no marker was seen")
    notes: List[str] = []
    if truth is None:
        truth, notes = read_frame(bag, poses.frame, options.truth_frame, poses.stamps)
    of = compare(truth, poses.stamps, poses.poses, poses.covariances, rpe, options.align)
    return MeasuredDrive(of, tuple(dict.fromkeys([*poses.warnings, *notes])))


def _located(bag: str, options: argparse.Namespace, params: BagParams) -> RecordedPoses:
    drive = read_drive(bag, params)
    poses = located_poses(drive, read_map(options), localization_params(options.corner_sigma))
    return RecordedPoses(
        bag, poses.frame, poses.stamps, poses.poses, poses.covariances,
        warnings=(*drive.warnings, *poses.warnings),
    )  # fmt: skip
