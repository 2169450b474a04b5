# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""accuracy_statistics of drives whose truth is known."""

import argparse
import functools
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Dict, List, Optional, Sequence, Tuple

import numpy as np

from sextant.bags.bag_params import BagParams
from sextant.bags.drive_reader import read_drive
from sextant.bags.recorded_poses import RecordedPoses, read_frame, read_poses
from sextant.base.atomic_file import atomic_files
from sextant.commands.bag_options import read_bags
from sextant.commands.command_line import Answer, check_output
from sextant.commands.located_bags import MapFile, localization_params, located_poses, reading
from sextant.evaluation.drive_accuracy import DriveAccuracy, compare, drive_table, write_errors
from sextant.evaluation.drive_plot import plot_drive
from sextant.evaluation.trajectory import Trajectory
from sextant.evaluation.trajectory_files import read_trajectory
from sextant.evaluation.trajectory_metrics import RPE_UNITS


@dataclass(frozen=True)
class DriveJob:
    """How the poses of a bag are found and compared, as plain values."""

    pose: str  # topic; empty: they are located
    reading: Optional[BagParams]
    map_file: MapFile
    corner_sigma: Optional[float]  # pixels; None: the locator's own
    truth: Optional[Trajectory]  # None: tf has it
    truth_frame: str
    rpe: Tuple[float, str]
    align: bool


@dataclass(frozen=True)
class MeasuredDrive:
    """What a job answers."""

    accuracy: DriveAccuracy
    warnings: Tuple[str, ...]


def accuracy_of_drives(options: argparse.Namespace) -> Answer:
    """Reads the bags, compares poses and truth, writes errors and pictures.

    :raises ValueError, RuntimeError: an option, a bag or a truth that cannot be; nothing was written then
    """
    bags = _bags(options)
    errors, pictures = _files(options.output, bags)
    for path in (errors, *pictures.values()):
        check_output(path, options.force)
    job = _job(options)
    marker_map = job.map_file.read()
    markers = marker_map.markers if marker_map and not job.align else ()  # aligned is the truth's frame
    read, notes = read_bags(functools.partial(measure, job=job), bags, options)
    drives: Dict[str, DriveAccuracy] = {bag: each.accuracy for bag, each in read}
    with atomic_files(errors.parent) as folder:
        write_errors(folder / errors.name, drives)
        for bag, of in drives.items():
            plot_drive(str(folder / pictures[bag].name), of.truth, {bag: of.estimate}, markers)
    written = [f"{errors}: errors of every pose", *(f"{pictures[bag]}: {bag}, drawn" for bag in drives)]
    return Answer([*notes, *drive_table(drives, job.rpe), *written])


def _bags(options: argparse.Namespace) -> List[str]:
    named = Counter(path.resolve() for path in options.inputs)
    again = [str(bag) for bag, count in named.items() if count > 1]
    if again:
        raise ValueError(f"{again[0]}: is named twice")
    return [str(path) for path in options.inputs]


def _files(name: Path, bags: Sequence[str]) -> Tuple[Path, Dict[str, Path]]:
    """NAME.csv; by bag, NAME.png or NAME_1.png, NAME_2.png, ..."""
    numbers = [""] if len(bags) == 1 else [f"_{number}" for number in range(1, len(bags) + 1)]
    pictures = {bag: name.with_name(f"{name.name}{number}.png") for bag, number in zip(bags, numbers)}
    return name.with_name(f"{name.name}.csv"), pictures


def _job(options: argparse.Namespace) -> DriveJob:
    if not (options.pose or options.map):
        raise ValueError("where are the markers? Name a map (--map), or a topic of poses (--pose)")
    localization_params(options.corner_sigma)
    return DriveJob(
        options.pose,
        None if options.pose else reading(options, camera_is_base=False),
        MapFile.of(options),
        options.corner_sigma,
        read_trajectory(options.truth) if options.truth is not None else None,
        options.truth_frame,
        _rpe(*options.rpe),
        options.align,
    )


def _rpe(delta: str, unit: str) -> Tuple[float, str]:
    try:
        value = float(delta)
    except ValueError:
        value = np.nan
    whole = unit != "frames" or value.is_integer()
    if not (0.0 < value < np.inf and whole and unit in RPE_UNITS):
        raise ValueError(f"--rpe {delta} {unit}: allowed is a number above 0 and {', '.join(RPE_UNITS)}")
    return value, unit


def measure(bag: str, job: DriveJob) -> MeasuredDrive:
    """One drive.

    :raises ValueError, RuntimeError: it cannot be read, has no pose, or no truth
    """
    poses = read_poses(bag, job.pose) if job.pose else _located(bag, job)
    if not len(poses.stamps):
        raise ValueError("; ".join(poses.warnings) or "no marker was seen")
    truth, notes = job.truth, []
    if truth is None:
        truth, notes = read_frame(bag, poses.frame, job.truth_frame, poses.stamps)
    of = compare(truth, poses.stamps, poses.poses, poses.covariances, job.rpe, job.align)
    return MeasuredDrive(of, tuple(dict.fromkeys([*poses.warnings, *notes])))


def _located(bag: str, job: DriveJob) -> RecordedPoses:
    drive = read_drive(bag, job.reading)
    poses = located_poses(drive, job.map_file.read(), localization_params(job.corner_sigma))
    return RecordedPoses(
        bag, poses.frame, poses.stamps, poses.poses, poses.covariances,
        warnings=(*drive.warnings, *poses.warnings),
    )  # fmt: skip
