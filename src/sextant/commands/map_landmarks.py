# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Builds a landmark map from recorded drives, by all observations together.

map_landmarks drive.bag -o map.yaml --plot map.png             the initial pose is the origin of the map
map_landmarks drive.bag --start-map map.yaml --read-only --trajectory poses.tum        only localizes
map_landmarks next.bag -o better.yaml --start-map map.yaml --lost         starts at an unknown pose

It runs the filter of the nodelet landmark_slam first; --online gives its results. It also writes a report
next to the map, map.html.
"""

import argparse
import functools
from pathlib import Path
from typing import Callable, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from tqdm import tqdm

import sextant
from sextant.bags.landmark_reader import LandmarkTopics, RecordedLandmarks, read_landmarks, run_on_recorded
from sextant.base.params_file import read_params_file
from sextant.base.strict_params import parse_struct
from sextant.commands.bag_options import add_job_options, pair, read_bags, read_mounts
from sextant.commands.command_line import Answer, CommandParser, check_output, run
from sextant.evaluation.trajectory_files import SEPARATORS, write_trajectory
from sextant.landmarks.batch_map import ROUNDS, batch_map
from sextant.landmarks.landmark_drawing import ENDINGS, write_plot
from sextant.landmarks.landmark_findings import list_findings, verdict
from sextant.landmarks.landmark_report import write_landmark_report
from sextant.landmarks.slam_run import LandmarkResult, SlamRun
from sextant.landmarks.slam_summary import summary, warnings


class MadeLandmarks(NamedTuple):
    """A landmark map that was made of drives."""

    slam_run: SlamRun  # of the filter
    result: LandmarkResult  # map and poses
    notes: List[str]  # on the order of the bags
    problems: List[str]  # of the drive and the adjustment


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """:returns: exit code: 0, or 2 when nothing was written."""
    return run(_parser(), arguments, _make)


def _parser() -> CommandParser:
    parser = CommandParser(prog="map_landmarks", description=__doc__)
    parser.add_argument("bags", nargs="+", metavar="BAG", help="bag with odometry, and landmarks or markers")
    parser.add_argument("--params", metavar="YAML", help="parameters of the nodelet landmark_slam")
    parser.add_argument(
        "--online", action="store_true", help="the map and the poses of landmark_slam, without an adjustment"
    )
    parser.add_argument("--force", action="store_true", help="overwrite existing files")
    _add_outputs(parser.add_argument_group("outputs"))
    _add_start(parser.add_argument_group("initial map"))
    bags = parser.add_argument_group("bags")
    for add in (_add_bags, add_job_options):
        add(bags)
    return parser


def _add_outputs(group) -> None:
    group.add_argument("-o", "--output", type=Path, metavar="MAP", help="landmark map, .yaml")
    group.add_argument(
        "--trajectory", type=Path, metavar="FILE", help=f"poses of the robot: {', '.join(SEPARATORS)}"
    )
    group.add_argument(
        "--report", type=Path, metavar="PAGE", help="report to write (default: next to the map, .html)"
    )
    group.add_argument("--plot", type=Path, metavar="IMAGE", help=f"plot from above: {', '.join(ENDINGS)}")


def _add_start(group) -> None:
    group.add_argument(
        "--start-map", metavar="MAP", help="landmark map to continue; the robot is at its saved pose"
    )
    group.add_argument("--lost", action="store_true", help="the robot is at an unknown pose in it")
    group.add_argument(
        "--read-only",
        action="store_true",
        help="no landmark is added, merged or removed; the positions of mapped landmarks are still refined",
    )
    group.add_argument("--marker-map", default="", metavar="MAP", help="map of printed markers")


def _add_bags(group) -> None:
    group.add_argument("--odometry", default="", metavar="TOPIC", help="default: the only one")
    group.add_argument("--landmarks", default="", metavar="TOPIC", help="default: the only one")
    group.add_argument(
        "--markers", nargs="+", default=[], metavar="TOPIC",
        help="marker topics; default: `cameras` of the parameters, or all if there are no landmarks",
    )  # fmt: skip
    group.add_argument(
        "--mounts", nargs="+", type=pair, default=[], metavar="FRAME=X,Y,Z,ROLL,PITCH,YAW",
        help="pose of a sensor frame on the base, if the bag has no tf",
    )  # fmt: skip
    group.add_argument(
        "--base-frame", default="", metavar="FRAME", help="default: child_frame_id of odometry"
    )
    group.add_argument(
        "--start", type=float, default=0.0, metavar="SECONDS", help="after the start of each bag"
    )
    group.add_argument(
        "--end", type=float, default=float("inf"), metavar="SECONDS", help="after the start of each bag"
    )


def _make(options: argparse.Namespace) -> Answer:
    """Reads the bags, runs the filter over them, and writes the outputs."""
    _check_outputs(options)
    params = _params(options)
    slam_run = SlamRun(params)
    reading = functools.partial(read_landmarks, topics=_topics(options, params), paths=options.bags)
    read, notes = read_bags(reading, options.bags, options)
    made = made_landmarks([recorded for _, recorded in read], slam_run, options.online or params.read_only)
    lines = [*notes, *landmark_lines(made), *_written(options, made.result)]
    return Answer([*lines, *_reported(options, made)])


def observation_reading(options: argparse.Namespace) -> Callable[[str], RecordedLandmarks]:
    """Reads odometry and landmarks of one bag; for read_bags().

    :param options: bags, landmarks, and those of add_robot_options()
    """
    topics = LandmarkTopics(
        odometry=options.odometry, landmarks=options.landmarks, base_frame=options.base_frame,
        mounts=read_mounts(options.mounts),
    )  # fmt: skip
    return functools.partial(read_landmarks, topics=topics, paths=options.bags)


def made_landmarks(
    recorded: Sequence[RecordedLandmarks], slam_run: SlamRun, is_online: bool = False
) -> MadeLandmarks:
    """Runs the filter over the bags, and estimates map and poses by all observations.

    :param is_online: the map and the poses are those of the filter
    :raises ValueError: two bags overlap in time
    """
    with _bar("filter", 100, "%") as bar:
        notes = run_on_recorded(recorded, slam_run, lambda share: bar.update(100 * share - bar.n))
    result, problems = _result(slam_run, is_online)
    return MadeLandmarks(slam_run, result, notes, [*warnings(slam_run), *problems])


def landmark_lines(made: MadeLandmarks) -> List[str]:
    """Returns lines on the drive, the map, its problems and its findings."""
    lines = [*made.notes, *summary(made.slam_run, made.result)]
    lines += [f"warning: {problem}" for problem in made.problems]
    if made.result.sightings:
        lines += [verdict(made.result), *(f"- {finding}" for finding in list_findings(made.result))]
    return lines


def _bar(name: str, total: int, unit: str) -> tqdm:
    return tqdm(total=total, desc=name, unit=unit, disable=None, bar_format="{l_bar}{bar}| {elapsed}")


def _result(slam_run: SlamRun, is_online: bool) -> Tuple[LandmarkResult, List[str]]:
    """And what prevented an adjustment."""
    if is_online or not slam_run.session.map.landmarks:
        return slam_run.result(), []
    try:
        with _bar("adjustment", ROUNDS, "round") as bar:
            return batch_map(slam_run, bar.update), []
    except RuntimeError as error:
        return slam_run.result(), [f"{error}: the map is that of the filter"]


def _check_outputs(options: argparse.Namespace) -> None:
    """Checks before anything is read. :raises ValueError: an output cannot be written"""
    if not options.output and not options.read_only:
        raise ValueError("specify the map to write: -o map.yaml; it is optional with --read-only only")
    if options.output and options.output.suffix not in (".yaml", ".yml"):
        raise ValueError(f"{options.output}: the file name of a landmark map must end in .yaml")
    for path, endings in ((options.trajectory, SEPARATORS), (options.plot, ENDINGS)):
        if path and path.suffix.lower() not in endings:
            raise ValueError(f"{path}: its ending must be one of {', '.join(endings)}")
    for path in filter(None, (options.output, options.trajectory, options.plot, _report(options))):
        check_output(path, options.force)


def _report(options: argparse.Namespace) -> Optional[Path]:
    """Nothing if there will be none. :raises ValueError: there will be none, but a file is named"""
    if not (options.online or options.read_only):
        return options.report or options.output.with_suffix(".html")
    if options.report:
        raise ValueError("--report is of maps by all observations: leave out --online and --read-only")
    return None


def _params(options: argparse.Namespace) -> "sextant.LandmarkSlamNodeParams":
    """:raises ValueError: as parse_struct(), or options that contradict one another"""
    params, start = landmark_params(options.params)
    params.map_file = options.start_map or ""
    params.marker_map_file = options.marker_map or params.marker_map_file
    if options.lost and not options.start_map:
        raise ValueError("--lost: specify the map to localize in by --start-map")
    if options.read_only and not (options.start_map or params.marker_map_file):
        raise ValueError("--read-only: specify a map by --start-map or --marker-map")
    params.read_only |= options.read_only
    params.start = "unknown" if options.lost else start or "map"
    return params


def landmark_params(path: Optional[str]) -> Tuple["sextant.LandmarkSlamNodeParams", Optional[str]]:
    """Reads a file of parameters of the nodelet; None: its defaults.

    :returns: the parameters, and `start` if the file sets it
    :raises OSError, ValueError: the file cannot be read, or a parameter is unknown or out of range
    """
    values = read_params_file(path) if path else {}
    return parse_struct(sextant.LandmarkSlamNodeParams, values, str(path), ": "), values.get("start")


def _topics(options: argparse.Namespace, params: "sextant.LandmarkSlamNodeParams") -> LandmarkTopics:
    return LandmarkTopics(
        odometry=options.odometry, landmarks=options.landmarks,
        cameras=tuple(options.markers or params.cameras),
        base_frame=options.base_frame or params.base_frame,
        mounts=read_mounts(options.mounts), start=options.start, end=options.end,
        marker_params={
            name: getattr(params.markers, name) for name, *_ in sextant.MarkerLandmarkParams.fields()
        },
        marker_map=params.marker_map_file,
    )  # fmt: skip


def _written(options: argparse.Namespace, result: LandmarkResult) -> List[str]:
    """Writes the outputs. :returns: a line on each"""
    lines = []
    if options.output:
        sextant.write_landmark_map(result.map, str(options.output))
        lines.append(f"{options.output}: written")
    if options.trajectory:
        poses = robot_poses(result)
        write_trajectory(options.trajectory, poses)
        lines.append(f"{options.trajectory}: {len(poses)} poses")
    if options.plot:
        write_plot(options.plot, result)
        lines.append(f"{options.plot}: plot from above")
    return lines


def robot_poses(result: LandmarkResult) -> Dict[int, np.ndarray]:
    """Returns T_map_base (4, 4) of all drives, by stamp in nanoseconds."""
    return {
        stamp: sextant.pose_from_xyz_rpy([x, y, 0.0], [0.0, 0.0, heading])
        for segment in result.segments
        for stamp, (x, y, heading) in segment.robot.items()
    }


def _reported(options: argparse.Namespace, made: MadeLandmarks) -> List[str]:
    """Writes the report. :returns: a line on it; none without an adjustment"""
    path = _report(options)
    if not (path and made.result.sightings):
        return []
    values: Dict[str, object] = {
        "recording": ", ".join(options.bags), "params": options.params, "start_map": options.start_map,
        "lost": options.lost, "marker_map": options.marker_map,
    }  # fmt: skip
    return report_landmarks(made, path, values)


def report_landmarks(made: MadeLandmarks, path: Path, values: Mapping[str, object]) -> List[str]:
    """Writes the report of an adjusted map. :returns: a line on it

    :param values: bags and options by name; empty ones are left out
    """
    origin = {name: value for name, value in values.items() if value}
    lines = summary(made.slam_run, made.result)
    write_landmark_report(path, made.result, lines, made.problems, origin)
    return [f"{path}: report with a plot"]
