# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Estimates the transforms between the frames of maps from one drive, and writes the maps in one frame.

    align_maps drive.bag -o hall/ --marker-map markers.yaml --landmark-map pillars.yaml
    align_maps drive.bag -o hall/ --marker-map markers.yaml --place-map photos/map.txt --frame places
    align_maps -o hall/ --marker-map markers.yaml --place-map photos/map.txt --given places=1.2,-3,0.52

Each map localizes the robot on the drive by itself; the trajectories are aligned. roslaunch sextant
localization.launch maps:=hall/ uses the maps. Maps that map_all made of one drive are in one frame already.
"""

import argparse
from pathlib import Path
from typing import Dict, List, NamedTuple, Optional, Sequence, Union

import numpy as np

import sextant
from sextant.base.html_report import Row, Table
from sextant.base.table_file import text_table
from sextant.commands.bag_options import add_bag_options, add_job_options, add_robot_options, pair
from sextant.commands.command_line import Answer, CommandParser, run
from sextant.commands.map_landmarks import landmark_params
from sextant.commands.maps.map_trajectories import TRAJECTORIES
from sextant.commands.maps.maps_folder import (
    LANDMARKS,
    MARKERS,
    PLACES,
    Details,
    MapPart,
    add_folder_options,
    begin_folder,
    check_folder,
    detector_arguments,
    params_arguments,
    write_folder,
)
from sextant.commands.maps.moved_maps import (
    FrameMove,
    metric_frame,
    moved_landmark_map,
    moved_marker_map,
    moved_place_map,
)
from sextant.commands.places.place_map_output import write_map
from sextant.evaluation.frame_alignment import FrameAlignment, frame_alignment
from sextant.evaluation.trajectory import Trajectory
from sextant.evaluation.trajectory_metrics import summarize
from sextant.place_maps.place_map import PlaceMap
from sextant.place_maps.place_map_file import read_place_map

FILES = {"markers": MARKERS, "landmarks": LANDMARKS, "places": PLACES}  # of the systems, in the folder
LEFT_OUT, LARGE_RMS = 0.2, 0.3  # share of the poses; metres: more than these is a finding
HEADS = (
    *("map", "x, m", "y, m", "heading, deg", "sigmas, m, m, deg"),
    *("poses", "used, %", "RMS, m", "median, m", "95 %, m", "worst, m"),
)
NOTE = (
    "Pose of the frame of each map in the frame of this folder, its standard deviations (sigmas), and "
    "distances between the positions of the robot by this map and by that of the frame at the same time. "
    "RMS is of the positions that were used, the other columns are of all. Errors are taken to be alike for "
    "ten seconds."
)


class _Map(NamedTuple):
    """A map to align."""

    path: Path  # of its file
    content: Union["sextant.MarkerMap", "sextant.LandmarkMap", PlaceMap]  # of the file
    frame: str  # tf frame


class _Aligned(NamedTuple):
    """A map and the transform of its frame to that of the reference."""

    move: FrameMove  # to the frame of the reference
    alignment: Optional[FrameAlignment]  # None: of the reference, or given
    verdict: str  # one line
    findings: Sequence[str] = ()  # one sentence each


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """:returns: exit code: 0, or 2 when nothing was written."""
    return run(_parser(), arguments, _make)


def _parser() -> CommandParser:
    parser = CommandParser(prog="align_maps", description=__doc__)
    parser.add_argument("bags", nargs="*", metavar="BAG", help="drive through the places of all maps")
    add_folder_options(parser)
    maps = parser.add_argument_group("maps").add_argument
    for name, what in (("marker", "printed markers"), ("landmark", "landmarks"), ("place", "places")):
        maps(f"--{name}-map", type=Path, metavar="MAP", help=f"map of {what}")
    text = "whose frame the maps get (default: the first one of them)"
    maps("--frame", choices=list(FILES), help=text)
    text = "pose of the frame of a map in that frame, m and rad; it is not estimated"
    maps("--given", nargs="+", type=pair, default=[], metavar="SYSTEM=X,Y,YAW", help=text)
    bags = parser.add_argument_group("bags")
    bags.add_argument(
        "--landmarks", default="", metavar="TOPIC", help="of observations (default: the only one)"
    )
    bags.add_argument("--params", metavar="YAML", help="parameters of the nodelet landmark_slam")
    bags.add_argument("--image", default="", metavar="TOPIC", help="images of places (default: the only one)")
    for add in (add_bag_options, add_robot_options, add_job_options):
        add(bags)
    parser.set_defaults(families=None)  # those of the marker map
    return parser


def _make(options: argparse.Namespace) -> Answer:
    """Localizes the robot by each map, aligns the trajectories, and writes the maps."""
    check_folder(options.output, options.force)
    landmark_params(options.params)  # refuses wrong ones before the bags are read
    maps = _read_maps(options)
    reference = options.frame or next(iter(maps))
    if reference not in maps:
        raise ValueError(f"--frame is {reference}, but there is no map of {reference}")
    given, notes = _given(options, maps, reference), []
    wanted = [system for system in maps if system not in (reference, *given)]
    if wanted and not options.bags:
        raise ValueError(f"name a bag of a drive, or the transform of {wanted[0]} by --given")
    found = {
        reference: _Aligned(_move(maps[reference].frame), None, "the frame of all maps"),
        **{
            system: _Aligned(_move(maps[reference].frame, T), None, "as given") for system, T in given.items()
        },
        **_estimated(options, maps, reference, wanted, notes),
    }
    return Answer([*notes, *_written(options, maps, {system: found[system] for system in maps})])


def _read_maps(options: argparse.Namespace) -> Dict[str, _Map]:
    """:raises ValueError, RuntimeError, OSError: a map cannot be read, or there are fewer than two"""
    maps = {}
    if options.marker_map:
        marker_map = sextant.read_marker_map(str(options.marker_map))
        if not marker_map.markers:
            raise ValueError(f"{options.marker_map}: the map has no markers")
        maps["markers"] = _Map(options.marker_map, marker_map, marker_map.frame)
    if options.landmark_map:
        landmark_map = sextant.read_landmark_map(str(options.landmark_map))
        maps["landmarks"] = _Map(options.landmark_map, landmark_map, landmark_map.frame)
    if options.place_map:
        place_map = read_place_map(options.place_map)
        frame = metric_frame(options.place_map, place_map).frame
        maps["places"] = _Map(options.place_map, place_map, frame)
    if len(maps) < 2:
        raise ValueError("name two maps or more: --marker-map, --landmark-map, --place-map")
    return maps


def _given(options: argparse.Namespace, maps: Dict[str, _Map], reference: str) -> Dict[str, np.ndarray]:
    """Transforms (3,) of --given by system."""
    result = {}
    for system, text in options.given:
        numbers = text.split(",")
        if system not in maps or system == reference:
            others = ", ".join(each for each in maps if each != reference)
            raise ValueError(f"--given {system}: allowed are {others}")
        try:
            result[system] = np.array([float(number) for number in numbers])
        except ValueError:
            result[system] = np.zeros(0)
        if result[system].shape != (3,) or not np.all(np.isfinite(result[system])):
            raise ValueError(f"--given {system} is {text!r}, allowed are three numbers: x,y,yaw")
    return result


def _move(frame: str, T: Sequence[float] = (0.0, 0.0, 0.0)) -> FrameMove:
    return FrameMove(frame, np.asarray(T), np.zeros((3, 3)))


def _estimated(
    options: argparse.Namespace, maps: Dict[str, _Map], reference: str, wanted: List[str], notes: List[str]
) -> Dict[str, _Aligned]:
    """:raises ValueError: the drive does not determine a transform, and why"""
    poses = {system: _trajectory(options, maps, system, notes) for system in (reference, *wanted) if wanted}
    found = {}
    for system in wanted:
        try:
            alignment = frame_alignment(poses[reference], poses[system])
        except ValueError as error:
            raise ValueError(f"{reference} and {system}: {error}") from None
        move = FrameMove(maps[reference].frame, alignment.T_to_from, alignment.covariance)
        share = f"{alignment.used.sum()} of {len(alignment.used)} poses fit"
        verdict = f"aligned with {reference}: {share}, {alignment.rms:.2f} m apart (RMS)"
        found[system] = _Aligned(move, alignment, verdict, _findings(reference, system, alignment))
    return found


def _trajectory(
    options: argparse.Namespace, maps: Dict[str, _Map], system: str, notes: List[str]
) -> Trajectory:
    more: List[str] = []
    poses = TRAJECTORIES[system](options, maps[system].path, more)
    notes += [f"{system}: {note}" for note in more]
    if not poses:
        raise ValueError(f"{maps[system].path}: the robot was never localized by {system} on this drive")
    return poses


def _findings(reference: str, system: str, alignment: FrameAlignment) -> List[str]:
    findings, left_out = [], 1.0 - float(np.mean(alignment.used))
    if left_out > LEFT_OUT:
        findings.append(
            f"{left_out:.0%} of the poses of {reference} and {system} contradict each other: one of them is "
            "at wrong places there; drive where both are reliable"
        )
    if alignment.rms > LARGE_RMS:
        findings.append(
            f"the poses of {reference} and {system} are {alignment.rms:.2f} m apart (RMS): a map is "
            "distorted, or its poses are rough; map_all makes all maps of one drive"
        )
    return findings


# ---- what is written


def _written(options: argparse.Namespace, maps: Dict[str, _Map], found: Dict[str, _Aligned]) -> List[str]:
    """Writes the moved maps and the page. :returns: lines for the terminal"""
    begin_folder(options.output)
    parts, arguments = [], params_arguments(options.output, options.params)
    for system, aligned in found.items():
        WRITERS[system](options, maps[system], aligned.move)
        parts.append(MapPart(system, aligned.verdict, aligned.findings, file=FILES[system]))
    if "markers" in maps:
        arguments.update(detector_arguments(maps["markers"].content))
    table = Table(HEADS, [Row(_cells(system, each)) for system, each in found.items()], (0,))
    details = Details("Transforms and residuals", NOTE, table)
    written = write_folder(options.output, "Aligned maps", parts, arguments, details)
    lines = [line for part in parts for line in part.lines()]
    return [*lines, *text_table(table).splitlines(), *written]


def _cells(system: str, aligned: _Aligned) -> Sequence[str]:
    x, y, heading = aligned.move.T_to_from
    cells = (system, f"{x:.3f}", f"{y:.3f}", f"{np.degrees(heading):.2f}")
    alignment = aligned.alignment
    if alignment is None:
        return (*cells, *[""] * (len(HEADS) - len(cells)))
    sigmas = np.sqrt(np.diag(alignment.covariance)) * [1.0, 1.0, np.degrees(1.0)]
    errors = summarize(alignment.distances)
    return (
        *cells,
        " ".join(f"{sigma:.3f}" for sigma in sigmas),
        *(str(len(alignment.used)), f"{100 * np.mean(alignment.used):.0f}"),
        *(f"{each:.3f}" for each in (alignment.rms, errors.median, errors.p95, errors.worst)),
    )


def _write_markers(options: argparse.Namespace, of: _Map, move: FrameMove) -> None:
    sextant.write_marker_map(moved_marker_map(of.content, move), str(options.output / MARKERS))


def _write_landmarks(options: argparse.Namespace, of: _Map, move: FrameMove) -> None:
    sextant.write_landmark_map(moved_landmark_map(of.content, move), str(options.output / LANDMARKS))


def _write_places(options: argparse.Namespace, of: _Map, move: FrameMove) -> None:
    path = options.output / PLACES
    path.parent.mkdir(exist_ok=True)
    moved = moved_place_map(of.path, path.parent, move)
    of_places = argparse.Namespace(output=path, force=options.force)
    write_map(of_places, moved.place_map, moved.files, poses=moved.poses)


WRITERS = {"markers": _write_markers, "landmarks": _write_landmarks, "places": _write_places}
