# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes a map of landmarks of recorded drives: what the nodelet landmark_slam makes of the same messages.

map_landmarks drive.bag -o map.yaml --plot map.png           the robot's first place is the origin
map_landmarks drive.bag --start-map map.yaml --read-only --trajectory poses.tum     only finds the robot
map_landmarks next.bag -o better.yaml --start-map map.yaml --lost                   from wherever it is
"""

import argparse
from pathlib import Path
from typing import List, Optional, Sequence

from tqdm import tqdm

import sextant
from sextant.bags.landmark_reader import LandmarkTopics, run_on_bags
from sextant.base.strict_params import parse_struct
from sextant.commands.bag_options import pair, read_mounts
from sextant.commands.command_line import Answer, CommandParser, check_output, run
from sextant.evaluation.trajectory_files import WRITTEN, write_trajectory
from sextant.landmarks.landmark_plan import ENDINGS, write_plan
from sextant.landmarks.slam_params import read_values
from sextant.landmarks.slam_run import SlamRun
from sextant.landmarks.slam_summary import summary, warnings


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """:returns: exit code: 0, or 2 when nothing was written."""
    return run(_parser(), arguments, _make)


def _parser() -> CommandParser:
    parser = CommandParser(prog="map_landmarks", description=__doc__)
    parser.add_argument("bags", nargs="+", metavar="BAG", help="with odometry and landmarks, or markers")
    parser.add_argument("--params", metavar="YAML", help="the nodelet's parameters, by its names for them")
    parser.add_argument("--force", action="store_true", help="overwrite files that are there")
    _add_outputs(parser.add_argument_group("what is written"))
    _add_start(parser.add_argument_group("what is known"))
    _add_bags(parser.add_argument_group("bags"))
    return parser


def _add_outputs(group) -> None:
    group.add_argument("-o", "--output", type=Path, metavar="MAP", help="landmark map, .yaml")
    group.add_argument(
        "--trajectory", type=Path, metavar="FILE", help=f"where the robot was: {', '.join(WRITTEN)}"
    )
    group.add_argument("--plot", type=Path, metavar="PICTURE", help=f"seen from above: {', '.join(ENDINGS)}")


def _add_start(group) -> None:
    group.add_argument(
        "--start-map", metavar="MAP", help="landmarks that are known; the robot is where it was"
    )
    group.add_argument("--lost", action="store_true", help="or it may be anywhere in that map")
    group.add_argument("--read-only", action="store_true", help="no landmark comes or goes")
    group.add_argument("--marker-map", default="", metavar="MAP", help="where printed markers hang")


def _add_bags(group) -> None:
    group.add_argument("--odometry", default="", metavar="TOPIC", help="default: the only one")
    group.add_argument("--landmarks", default="", metavar="TOPIC", help="default: the only one")
    group.add_argument(
        "--markers", nargs="+", default=[], metavar="TOPIC",
        help="of cameras; default: `cameras` of the parameters, or all where there are no landmarks",
    )  # fmt: skip
    group.add_argument(
        "--mounts", nargs="+", type=pair, default=[], metavar="FRAME=X,Y,Z,ROLL,PITCH,YAW",
        help="of a sensor's frame on the base, where the bag has no tf",
    )  # fmt: skip
    group.add_argument("--base-frame", default="", metavar="FRAME", help="default: that of odometry")
    group.add_argument("--start", type=float, default=0.0, metavar="SECONDS", help="of each bag to leave out")
    group.add_argument("--end", type=float, default=float("inf"), metavar="SECONDS", help="and where to stop")


def _make(options: argparse.Namespace) -> Answer:
    """Runs the filter over the bags, and writes what was asked for."""
    _check_outputs(options)
    params = _params(options)
    slam_run = SlamRun(params, _start_map(options), _marker_map(params))
    with tqdm(total=100, desc="bags", unit="%", disable=None, bar_format="{l_bar}{bar}| {elapsed}") as bar:
        notes = run_on_bags(
            options.bags, _topics(options, params), slam_run, lambda share: bar.update(100 * share - bar.n)
        )
    told = [f"warning: {warning}" for warning in warnings(slam_run)]
    return Answer([*notes, *summary(slam_run), *told, *_written(options, slam_run)])


def _check_outputs(options: argparse.Namespace) -> None:
    """:raises ValueError: before anything is read, one that cannot be written"""
    if not options.output and not options.read_only:
        raise ValueError("name the map to write: -o map.yaml; only with --read-only it may be left out")
    if options.output and options.output.suffix not in (".yaml", ".yml"):
        raise ValueError(f"{options.output}: a landmark map is .yaml")
    for path, endings in ((options.trajectory, WRITTEN), (options.plot, ENDINGS)):
        if path and path.suffix.lower() not in endings:
            raise ValueError(f"{path}: its ending must be one of {', '.join(endings)}")
    for path in filter(None, (options.output, options.trajectory, options.plot)):
        check_output(path, options.force)


def _params(options: argparse.Namespace) -> "sextant.LandmarkSlamNodeParams":
    """:raises ValueError: as parse_struct(), or options that do not fit together"""
    values = read_values(options.params) if options.params else {}
    params = parse_struct(sextant.LandmarkSlamNodeParams, values, str(options.params), ": ")
    params.marker_map_file = options.marker_map or params.marker_map_file
    if options.lost and not options.start_map:
        raise ValueError("--lost: the robot is to be found in a map, name one by --start-map")
    if options.read_only and not (options.start_map or params.marker_map_file):
        raise ValueError("--read-only: name the map that is only read by --start-map or --marker-map")
    params.read_only |= options.read_only
    params.start = "unknown" if options.lost else values.get("start", "map")
    return params


def _start_map(options: argparse.Namespace) -> Optional["sextant.LandmarkMap"]:
    return sextant.read_landmark_map(options.start_map) if options.start_map else None


def _marker_map(params: "sextant.LandmarkSlamNodeParams") -> Optional["sextant.MarkerMap"]:
    return sextant.read_marker_map(params.marker_map_file) if params.marker_map_file else None


def _topics(options: argparse.Namespace, params: "sextant.LandmarkSlamNodeParams") -> LandmarkTopics:
    return LandmarkTopics(
        odometry=options.odometry, landmarks=options.landmarks,
        cameras=tuple(options.markers or params.cameras),
        base_frame=options.base_frame or params.base_frame,
        mounts=read_mounts(options.mounts), start=options.start, end=options.end,
    )  # fmt: skip


def _written(options: argparse.Namespace, slam_run: SlamRun) -> List[str]:
    """Writes what was asked for, and tells it."""
    lines = []
    if options.output:
        sextant.write_landmark_map(slam_run.map(), str(options.output))
        lines.append(f"{options.output}: written")
    if options.trajectory:
        poses = {
            stamp: sextant.pose_from_xyz_rpy([x, y, 0.0], [0.0, 0.0, heading])
            for leg in slam_run.legs
            for stamp, (x, y, heading) in leg.robot.items()
        }
        write_trajectory(options.trajectory, poses)
        lines.append(f"{options.trajectory}: {len(poses)} poses, as they were known at the time")
    if options.plot:
        write_plan(options.plot, slam_run)
        lines.append(f"{options.plot}: seen from above")
    return lines
