# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""accuracy_statistics of drives whose truth is known."""

import argparse
from pathlib import Path
from typing import Dict, List, NamedTuple, Tuple

import sextant
from sextant.bags.recorded_poses import RecordedPoses, read_frame
from sextant.commands.command_line import Answer, check_output
from sextant.commands.located_bags import known_map, located_poses, read_drives, recorded_poses
from sextant.statistics.drive_accuracy import (
    DriveAccuracy,
    compare,
    drive_table,
    write_errors,
)
from sextant.statistics.drive_plot import plot_drive
from sextant.statistics.trajectory import Trajectory
from sextant.statistics.trajectory_files import read_trajectory


class DriveFiles(NamedTuple):
    """Files that one name stands for."""

    errors: Path
    picture: Path

    @classmethod
    def named(cls, name: Path) -> "DriveFiles":
        return cls(*(name.with_name(name.name + ending) for ending in (".csv", ".png")))


def drive_accuracy(options: argparse.Namespace) -> Answer:
    """Reads the bags, compares poses and truth, writes errors and a picture.

    :raises ValueError, RuntimeError: an option, a bag or a truth that cannot be; nothing was written then
    """
    files = DriveFiles.named(options.output)
    for path in files:
        check_output(path, options.force)
    rpe = _rpe(options.rpe)
    truth_file = read_trajectory(options.truth) if options.truth is not None else None
    poses, notes = _poses([str(path) for path in options.inputs], options)
    drives: Dict[str, DriveAccuracy] = {}
    for bag, each in poses:
        truth = _frame_truth(bag, each, options) if truth_file is None else truth_file
        drives[Path(bag).stem] = compare(truth, each.stamps, each.poses, each.covariances, rpe, options.align)
    write_errors(files.errors, drives)
    marker_map = known_map(options)
    merged = {name: each.estimate for name, each in drives.items()}
    truth = {stamp: T for each in drives.values() for stamp, T in each.truth.items()}
    plot_drive(str(files.picture), truth, merged, marker_map.markers if marker_map else ())
    written = [f"{files.errors}: errors of every pose", f"{files.picture}: the same, drawn"]
    return Answer([*notes, *drive_table(drives, rpe), *written])


def _rpe(words) -> Tuple[float, str]:
    try:
        return float(words[0]), words[1]
    except ValueError:
        raise ValueError(f"--rpe {words[0]}: is no number") from None


def _poses(bags: List[str], options: argparse.Namespace) -> Tuple[List[Tuple[str, RecordedPoses]], List[str]]:
    if options.pose:
        poses, notes, _ = recorded_poses(bags, options)
        return poses, notes
    marker_map = known_map(options)
    if marker_map is None:
        raise ValueError("where are the markers? Name a map (--map), or a topic of poses (--pose)")
    read, notes = read_drives(bags, options, camera_is_base=False)
    sigma = sextant.LocatorParams().corner_sigma if options.corner_sigma is None else options.corner_sigma
    poses, more = located_poses(read, marker_map, sigma)
    return poses, [*notes, *more]


def _frame_truth(bag: str, poses: RecordedPoses, options: argparse.Namespace) -> Trajectory:
    return read_frame(bag, poses.frame, options.truth_frame, poses.stamps)
