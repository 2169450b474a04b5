# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tells how exact poses are: by measured distances, or along a drive whose truth is known.

    accuracy_statistics series --size 0.2     series/0.757, series/1.256, ... each hold bags of a camera that
                                              stands still so many metres in front of a marker
    accuracy_statistics drive.bag --truth truth.tum --map map.yaml
    accuracy_statistics drive.bag --truth-frame base_truth --pose /marker_locator/pose

Poses are located in the bags' images or recorded markers, or those that the robot published (--pose). Of a
series it writes a workbook, plots, and what the locator takes as parameters; of a drive its errors.
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
    """:returns: exit code: 0, or 2 when nothing was written."""
    return run(_parser(), arguments, _answer)


def _answer(options: argparse.Namespace) -> Answer:
    of_drives = options.truth is not None or bool(options.truth_frame)
    if options.output.name in ("", "..") or str(options.output).endswith("."):
        raise ValueError(f"--output {options.output}: is no name that files can begin with")
    for name, why in _meaningless(options, of_drives).items():
        if getattr(options, name) != _parser().get_default(name):
            raise ValueError(f"--{name.replace('_', '-')} means nothing {why}")
    return accuracy_of_drives(options) if of_drives else accuracy_of_series(options)


def _meaningless(options: argparse.Namespace, of_drives: bool) -> Dict[str, str]:
    """Options that nobody would look at, and why."""
    robot = ("mounts", "base_frame", "odometry")
    chosen = {
        "of drives, whose truth is a trajectory": ("axis", "true") if of_drives else (),
        "of a series: its poses are the camera's": () if of_drives else ("align", "rpe", *robot),
        "with --pose: nothing is located": (
            *("images", "markers", "calibrations", "rectified", "every", "corner_sigma", "marker"),
            *(robot if of_drives else ("map",)),
        ) if options.pose else (),
        "without a map": ("family", "size") if options.pose and not options.map else (),
        "with --map, which says where all markers are": ("marker",) if options.map else (),
    }  # fmt: skip
    return {name: why for why, names in chosen.items() for name in names}


def _parser() -> CommandParser:
    parser = CommandParser(prog="accuracy_statistics", description=__doc__)
    parser.add_argument(
        "inputs", nargs="+", type=Path, metavar="INPUT", help="the folder of a series, or bags of drives"
    )
    parser.add_argument(
        "-o", "--output", type=Path, default=Path("accuracy"), metavar="NAME",
        help="files to write begin with it (default: %(default)s)",
    )  # fmt: skip
    parser.add_argument("--force", action="store_true", help="overwrite files that are there")
    _add_poses(parser.add_argument_group("which poses"))
    _add_series(parser.add_argument_group("truth of a series"))
    _add_drive(parser.add_argument_group("truth of a drive"))
    bags = parser.add_argument_group("bags")
    for add in (add_bag_options, add_robot_options, add_job_options):
        add(bags)
    return parser


def _add_poses(group) -> None:
    group.add_argument("--pose", default="", metavar="TOPIC", help="recorded ones; none is located then")
    group.add_argument("--map", metavar="FILE", help="marker map; its frame is the poses' frame")
    group.add_argument(
        "--marker", type=int, metavar="ID",
        help="without a map: the marker that was measured, whose frame is the poses' (default: the only one)",
    )  # fmt: skip
    group.add_argument("--family", default=sextant.DetectorParams().families[0], help="default: %(default)s")
    group.add_argument(
        "--size", type=float, default=0.2, metavar="METRES", help="edge (default: %(default)s)"
    )
    group.add_argument(
        "--corner-sigma", type=float, metavar="PIXELS",
        help="noise of a corner (default: of a series what it shows itself, of a drive the locator's own)",
    )  # fmt: skip


def _add_series(group) -> None:
    group.add_argument(
        "--axis", choices=AXES, default="z", help="what the folders' names are values of (default: z)"
    )
    group.add_argument(
        "--true", nargs="+", type=pair, default=[], metavar="AXIS=VALUE",
        help="of the other axes, m and rad, or `unknown` (default: in a marker's frame 0, but roll pi, since"
        " the camera looks at it; else unknown)",
    )  # fmt: skip


def _add_drive(group) -> None:
    truth = group.add_mutually_exclusive_group()
    truth.add_argument("--truth", type=Path, metavar="FILE", help="trajectory: .tum, .txt, or .csv")
    truth.add_argument("--truth-frame", default="", metavar="FRAME", help="that tf has in the poses' frame")
    group.add_argument("--align", action="store_true", help="move the poses onto the truth first (Umeyama)")
    group.add_argument(
        "--rpe", nargs=2, default=[f"{RPE[0]:g}", RPE[1]], metavar=("DELTA", "UNIT"),
        help=f"of relative errors; units are {', '.join(RPE_UNITS)} (default: {RPE[0]:g} {RPE[1]})",
    )  # fmt: skip
