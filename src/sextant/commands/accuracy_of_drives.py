# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""accuracy_statistics for drives, with or without ground truth."""

import argparse
import functools
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from sextant.bags.bag_params import BagParams
from sextant.bags.drive_reader import read_drive
from sextant.bags.recorded_poses import RecordedPoses, read_frame, read_poses
from sextant.base.atomic_file import atomic_files
from sextant.commands.bag_options import read_bags
from sextant.commands.command_line import Answer, check_output
from sextant.commands.located_bags import (
    chosen_modes,
    chosen_topics,
    listed_names,
    localization_params,
    located_poses,
    mapped_markers,
    read_map,
    reading,
)
from sextant.evaluation.drive_accuracy import DriveAccuracy, compare, drive_table, write_errors
from sextant.evaluation.drive_bands import DriveEstimate, plot_bands
from sextant.evaluation.drive_plot import plot_drive
from sextant.evaluation.trajectory import Trajectory
from sextant.evaluation.trajectory_files import read_trajectory
from sextant.evaluation.trajectory_metrics import (
    RPE_UNITS,
    aligned_covariances,
    alignment,
    interpolated_truth,
    start_alignment,
)

Poses = Dict[str, RecordedPoses]  # by method: a topic or a mode of the locator; one alone has no name


@dataclass(frozen=True)
class MeasuredDrive:
    """Result of measure(), by method."""

    estimates: Dict[str, DriveEstimate]  # poses, aligned as asked
    accuracy: Dict[str, DriveAccuracy]  # errors of the poses; empty without ground truth
    warnings: Tuple[str, ...]  # of reading the bag

    @property
    def truth(self) -> Trajectory:
        """The true poses at the stamps of all estimates."""
        return {stamp: T for each in self.accuracy.values() for stamp, T in each.truth.items()}


class _Files(NamedTuple):
    errors: Path
    plots: Dict[str, Path]  # by bag
    bands: Dict[str, Path]  # by bag


def accuracy_of_drives(options: argparse.Namespace) -> Answer:
    """Reads the bags, compares poses with ground truth and with one another, and writes errors and plots.

    :raises ValueError, RuntimeError: an option, bag or ground truth is invalid; nothing was written
    """
    bags = _bags(options)
    files = _files(options.output, bags)
    for path in (files.errors, *files.plots.values(), *files.bands.values()):
        check_output(path, options.force)
    rpe = _rpe(*options.rpe)
    measured = functools.partial(_measured(options), rpe=rpe)
    markers = mapped_markers(options)
    read, notes = read_bags(measured, bags, options)
    written = _write(files, dict(read), () if options.align else markers)  # aligned: in the truth's frame
    drives = _by_name(dict(read))
    table = drive_table(drives, rpe) if drives else _lengths(dict(read))
    return Answer([*notes, *table, *written])


def _write(files: _Files, measured: Dict[str, MeasuredDrive], markers: Sequence) -> List[str]:
    """Writes all files atomically; returns lines that list them."""
    drives = _by_name(measured)
    lines = [f"{files.errors}: errors of every pose"] if drives else []
    with atomic_files(files.errors.parent) as folder:
        if drives:
            write_errors(folder / files.errors.name, drives)
        for bag, of in measured.items():
            estimates = {method or bag: each for method, each in of.estimates.items()}
            bands, plot = files.bands[bag], files.plots[bag]
            plot_bands(str(folder / bands.name), estimates, of.truth or None, markers)
            if of.accuracy:
                poses = {name: each.poses for name, each in estimates.items()}
                plot_drive(str(folder / plot.name), of.truth, poses, markers)
                lines.append(f"{plot}: plot of {bag}")
            lines.append(f"{bands}: x, y and yaw over time with their published deviations")
    return lines


def _by_name(measured: Dict[str, MeasuredDrive]) -> Dict[str, DriveAccuracy]:
    return {
        f"{bag} {method}".strip(): accuracy
        for bag, each in measured.items()
        for method, accuracy in each.accuracy.items()
    }


def _lengths(measured: Dict[str, MeasuredDrive]) -> List[str]:
    """Describes drives without ground truth."""
    lines = []
    for bag, each in measured.items():
        for method, of in each.estimates.items():
            seconds = 1e-9 * (max(of.poses) - min(of.poses))
            lines.append(f"{' '.join(filter(None, (bag, method)))}: {len(of.poses)} poses in {seconds:.1f} s")
    return lines


def _bags(options: argparse.Namespace) -> List[str]:
    named = Counter(path.resolve() for path in options.inputs)
    again = [str(bag) for bag, count in named.items() if count > 1]
    if again:
        raise ValueError(f"{again[0]}: is given twice")
    return [str(path) for path in options.inputs]


def _files(name: Path, bags: Sequence[str]) -> _Files:
    """Returns NAME.csv and, by bag, NAME.png and NAME_bands.png, or NAME_1.png, NAME_1_bands.png, ..."""
    numbers = [""] if len(bags) == 1 else [f"_{number}" for number in range(1, len(bags) + 1)]
    plots, bands = (
        {bag: name.with_name(f"{name.name}{number}{end}") for bag, number in zip(bags, numbers)}
        for end in (".png", "_bands.png")
    )
    return _Files(name.with_name(f"{name.name}.csv"), plots, bands)


def _measured(options: argparse.Namespace) -> Callable[..., MeasuredDrive]:
    """Reads and checks everything but the bags; returns measure() as a function of a bag."""
    if not (options.pose or options.map):
        raise ValueError("set a marker map (--map) or topics of poses (--pose)")
    chosen_modes(options)
    localization_params(options.corner_sigma)
    unknown = set(listed_names(options.align_start)) - set(listed_names(options.pose))
    if unknown:
        raise ValueError(f"--align-start {sorted(unknown)[0]}: is not a topic of --pose")
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
    """Compares the poses of one drive with its ground truth, if there is any.

    :param params: None: poses are recorded, on the topics options.pose
    :param truth: None: from tf if options.truth_frame is set, from options.truth_topic, else there is none
    :param rpe: delta and unit of sextant.evaluation.trajectory_metrics.relative_errors()
    :raises ValueError, RuntimeError: the bag cannot be read, has no pose, or no ground truth
    """
    poses, notes = _located(bag, options, params) if params else _recorded(bag, options)
    started = _started(poses, options)
    first = _first(poses, started)
    if options.truth_frame or options.truth_topic:
        aligned = options.align or len(started) == len(poses)
        truth, of_truth = _recorded_truth(bag, options, first.frame, aligned, _stamps(poses))
        notes += of_truth
    poses = _aligned(poses, truth or _trajectory(first), started, options.align)
    accuracy: Dict[str, DriveAccuracy] = {}
    if truth is not None:
        accuracy = {
            name: compare(truth, of.stamps, of.poses, of.covariances, rpe) for name, of in poses.items()
        }
    estimates = {method: _estimate(of, accuracy.get(method)) for method, of in poses.items()}
    return MeasuredDrive(estimates, accuracy, tuple(dict.fromkeys(notes)))


def _first(poses: Poses, started: List[str]) -> RecordedPoses:
    """Returns the first poses that are in the reference's frame; if there are none, the first."""
    fixed = (each for method, each in poses.items() if method not in started)
    return next(fixed, next(iter(poses.values())))


def _recorded_truth(
    bag: str, options: argparse.Namespace, frame: str, aligned: bool, stamps: List[int]
) -> Tuple[Trajectory, List[str]]:
    """:raises ValueError: the topic's poses are in another frame than the others, which are not aligned"""
    if options.truth_frame:
        return read_frame(bag, frame, options.truth_frame, stamps)
    of = read_poses(bag, options.truth_topic)
    if of.frame != frame and not aligned:
        raise ValueError(f"{options.truth_topic} is in '{of.frame}', the poses in '{frame}'; add --align")
    return _trajectory(of), list(of.warnings)


def _stamps(poses: Poses) -> List[int]:
    return sorted({int(stamp) for each in poses.values() for stamp in each.stamps})


def _located(bag: str, options: argparse.Namespace, params: BagParams) -> Tuple[Poses, List[str]]:
    """:raises ValueError: a mode has no pose"""
    drive = read_drive(bag, params)
    poses: Poses = {}
    notes = list(drive.warnings)
    for method, mode in chosen_modes(options).items():
        located = located_poses(drive, read_map(options), localization_params(options.corner_sigma, mode))
        notes += [f"{method}: {warning}" if method else warning for warning in located.warnings]
        if not len(located.stamps):
            raise ValueError("; ".join(notes) or "no marker was seen")
        poses[method] = located
    return poses, notes


def _recorded(bag: str, options: argparse.Namespace) -> Tuple[Poses, List[str]]:
    poses = {method: read_poses(bag, topic) for method, topic in chosen_topics(options).items()}
    return poses, [warning for each in poses.values() for warning in each.warnings]


def _started(poses: Poses, options: argparse.Namespace) -> List[str]:
    """Returns the methods that are aligned at their start.

    :raises ValueError: poses that are not aligned are in several frames
    """
    names = listed_names(options.align_start)
    started = [method for method in poses if (method or options.pose) in names]
    frames = {each.frame: method for method, each in poses.items() if method not in started}
    if len(frames) > 1 and not options.align:
        listed = ", ".join(f"{method} in '{frame}'" for frame, method in frames.items())
        raise ValueError(f"the poses are not all in one frame: {listed}; align odometry with --align-start")
    return started


def _aligned(poses: Poses, reference: Trajectory, started: Sequence[str], align: bool) -> Poses:
    """Transforms poses to the frame of the reference: at their start, or their whole path."""
    result: Poses = {}
    for method, of in poses.items():
        estimate = _trajectory(of)
        if method in started:
            result[method] = _moved(of, start_alignment(reference, estimate))
        elif align:
            result[method] = _moved(of, alignment(interpolated_truth(reference, estimate), estimate))
        else:
            result[method] = of
    return result


def _moved(of: RecordedPoses, T: np.ndarray) -> RecordedPoses:
    covariances = aligned_covariances(T, dict(enumerate(of.covariances)))
    return replace(of, poses=T @ of.poses, covariances=np.array(list(covariances.values())))


def _trajectory(of: RecordedPoses) -> Trajectory:
    return {int(stamp): T for stamp, T in zip(of.stamps, of.poses)}


def _estimate(of: RecordedPoses, accuracy: Optional[DriveAccuracy]) -> DriveEstimate:
    """Returns the poses, with ground truth only those that have it."""
    given = {int(stamp): P for stamp, P in zip(of.stamps, of.covariances) if np.isfinite(P).all() and P.any()}
    return DriveEstimate(_trajectory(of) if accuracy is None else accuracy.estimate, given)
