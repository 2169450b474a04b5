# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Computes the accuracy of poses: at measured distances, at surveyed points, or along drives.

    accuracy_statistics series --size 0.2     series/0.757, series/1.256, ... contain bags of a static camera
                                              at these distances in front of a marker, in metres
    accuracy_statistics --points points.csv --map map.yaml --mode nearest,average,joint
    accuracy_statistics drive.bag --truth truth.tum --map map.yaml
    accuracy_statistics drive.bag --truth-frame base_truth --pose /marker_locator/pose
    accuracy_statistics drive.bag --truth-topic /ground_truth --pose /marker_locator/pose
    accuracy_statistics drive.bag --pose /odom,/odometry/filtered,/marker_locator/pose --align-start /odom

Poses are computed from the bags' images or recorded markers, or read from topics (--pose); several modes of
the locator or several topics are compared. For a series or points, the command writes a workbook, a page,
plots and parameters of the locator; for drives, errors and plots. points.csv has the columns bag,x,y,z,yaw.
"""

import argparse
from pathlib import Path
from typing import Dict, Optional, Sequence

import sextant
from sextant.commands.accuracy_of_drives import accuracy_of_drives
from sextant.commands.accuracy_of_series import accuracy_of_series
from sextant.commands.bag_options import add_bag_options, add_job_options, add_robot_options, pair
from sextant.commands.command_line import Answer, CommandParser, run
from sextant.evaluation.pose_series import AXES
from sextant.evaluation.trajectory_metrics import RPE, RPE_UNITS


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """Runs the command.

    :returns: exit code: 0, or 2 when nothing was written
    """
    return run(_parser(), arguments, _answer)


def _answer(options: argparse.Namespace) -> Answer:
    kind = _kind(options)
    if options.output.name in ("", "..") or str(options.output).endswith("."):
        raise ValueError(f"--output {options.output}: is not a prefix of file names")
    for name, why in _unused(options, kind).items():
        if getattr(options, name) != _parser().get_default(name):
            raise ValueError(f"--{name.replace('_', '-')} has no effect {why}")
    return accuracy_of_drives(options) if kind == "drives" else accuracy_of_series(options)


def _kind(options: argparse.Namespace) -> str:
    if options.points is not None:
        return "points"
    are_bags = all(path.suffix == ".bag" and not path.is_dir() for path in options.inputs)
    return "drives" if _has_truth(options) or (options.inputs and are_bags) else "series"


def _has_truth(options: argparse.Namespace) -> bool:
    return options.truth is not None or bool(options.truth_frame or options.truth_topic)


def _unused(options: argparse.Namespace, kind: str) -> Dict[str, str]:
    """Returns unused options with the reason."""
    robot = ("mounts", "base_frame", "odometry")
    of_bags = ("images", "markers", "calibrations", "rectified", "every", "corner_sigma", "mode")
    of_truth = ("truth", "truth_frame", "truth_topic", "align", "rpe")
    rules = (
        (kind == "drives", "for drives: their ground truth is a trajectory", ("axis", "true")),
        (kind == "drives" and not _has_truth(options), "without ground truth", of_truth),
        (kind == "points", "for surveyed points", ("axis", *of_truth, "align_start")),
        (kind == "series", "for a series", (*of_truth, "align_start")),
        (kind == "series", "for a series: its poses are the camera's", robot),
        (options.pose, "with --pose: poses are recorded", (*of_bags, *robot, "marker")),
        (options.pose and kind == "series", "with --pose: poses are recorded", ("map",)),
        (not options.pose, "without --pose", ("align_start",)),
        (options.pose and not options.map, "without a map", ("family", "size")),
        (options.map, "with --map, which has all markers", ("marker",)),
    )
    return {name: why for holds, why, names in rules if holds for name in names}


def _parser() -> CommandParser:
    parser = CommandParser(prog="accuracy_statistics", description=__doc__)
    parser.add_argument(
        "inputs", nargs="*", type=Path, metavar="INPUT", help="folder of a series, or bags of drives"
    )
    parser.add_argument(
        "-o", "--output", type=Path, default=Path("accuracy"), metavar="NAME",
        help="prefix of the files to write (default: %(default)s)",
    )  # fmt: skip
    parser.add_argument("--force", action="store_true", help="overwrite existing files")
    _add_poses(parser.add_argument_group("poses"))
    _add_series(parser.add_argument_group("ground truth of a series or of surveyed points"))
    _add_drive(parser.add_argument_group("ground truth of a drive"))
    bags = parser.add_argument_group("bags")
    for add in (add_bag_options, add_robot_options, add_job_options):
        add(bags)
    return parser


def _add_poses(group) -> None:
    group.add_argument(
        "--pose", default="", metavar="TOPIC[,TOPIC]", help="topics of recorded poses, separated by commas"
    )
    group.add_argument(
        "--mode", default=sextant.LocatorParams().mode, metavar="MODE[,MODE]",
        help=f"modes of the locator, separated by commas: {', '.join(sextant.locator_modes())}"
        " (default: %(default)s)",
    )  # fmt: skip
    group.add_argument("--map", metavar="FILE", help="marker map; poses are in its frame")
    group.add_argument(
        "--marker", type=int, metavar="ID",
        help="without a map: the measured marker; poses are in its frame (default: the only one)",
    )  # fmt: skip
    group.add_argument("--family", default=sextant.DetectorParams().families[0], help="default: %(default)s")
    group.add_argument(
        "--size", type=float, default=0.2, metavar="METRES", help="edge length (default: %(default)s)"
    )
    group.add_argument(
        "--corner-sigma", type=float, metavar="PIXELS",
        help="corner noise (default: for a series its own estimate, for drives the locator's default)",
    )  # fmt: skip


def _add_series(group) -> None:
    group.add_argument(
        "--points", type=Path, metavar="FILE",
        help="surveyed points, .csv with the columns bag,x,y,z,yaw (m, rad) in the frame of the map",
    )  # fmt: skip
    group.add_argument(
        "--axis", choices=AXES, default="z", help="measured axis: folder names are its values (default: z)"
    )
    group.add_argument(
        "--true", nargs="+", type=pair, default=[], metavar="AXIS=VALUE",
        help="true values of the other axes, m and rad, or `unknown` (default: in a marker's frame 0, and"
        " roll pi, since the camera faces the marker; else unknown)",
    )  # fmt: skip


def _add_drive(group) -> None:
    truth = group.add_mutually_exclusive_group()
    truth.add_argument("--truth", type=Path, metavar="FILE", help="trajectory, .tum, .txt or .csv")
    truth.add_argument("--truth-frame", default="", metavar="FRAME", help="tf frame of the true pose")
    truth.add_argument("--truth-topic", default="", metavar="TOPIC", help="topic of the true poses")
    group.add_argument("--align", action="store_true", help="align poses with the truth first (Umeyama)")
    group.add_argument(
        "--align-start", default="", metavar="TOPIC[,TOPIC]",
        help="topics of --pose whose first pose is put on the truth, or on the first other topic: odometry",
    )  # fmt: skip
    group.add_argument(
        "--rpe", nargs=2, default=[f"{RPE[0]:g}", RPE[1]], metavar=("DELTA", "UNIT"),
        help=f"of relative pose errors; units: {', '.join(RPE_UNITS)} (default: {RPE[0]:g} {RPE[1]})",
    )  # fmt: skip
