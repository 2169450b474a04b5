# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes a marker map from recorded drives: without or with known markers, or by refining a measured map.

    map_markers drive.bag -o map.yaml --size 0.16                     one marker is the origin
    map_markers drive.bag -o map.yaml --size 0.16 --known door.yaml   in the frame of door.yaml
    map_markers *.bag -o better.yaml --refine taped.yaml              and reports wrong entries

It also writes a report next to the map, better.html.
"""

import argparse
import functools
from pathlib import Path
from typing import Callable, Dict, List, NamedTuple, Optional, Sequence

import numpy as np

import sextant
from sextant.bags.drive_reader import RecordedDrive, read_drive
from sextant.commands.bag_options import (
    add_bag_options,
    add_job_options,
    add_robot_options,
    bag_params,
    pair,
    read_bags,
)
from sextant.commands.command_line import Answer, CommandParser, check_output, run
from sextant.localization.recorded_instants import RecordedInstants, recorded_instants
from sextant.mapping.map_findings import findings, verdict
from sextant.mapping.map_quality import MapQuality, map_quality
from sextant.mapping.map_report import MapOrigin, write_map_report


class MarkerInputs(NamedTuple):
    """What is known of the markers before a drive."""

    known: "sextant.MarkerMap"  # of --known or --refine
    sizes: "sextant.MarkerSizes"  # of the others
    params: "sextant.MappingParams"  # of the map maker


class MadeMarkers(NamedTuple):
    """A marker map that was made of drives."""

    result: "sextant.MappingResult"  # the map and the path of the robot
    recorded: RecordedInstants  # from which it was made
    quality: MapQuality  # what the findings are of
    origin: MapOrigin  # for the report


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """Runs the command.

    :returns: exit code: 0, or 2 when nothing was written
    """
    return run(_parser(), arguments, _make)


def _parser() -> CommandParser:
    parser = CommandParser(prog="map_markers", description=__doc__)
    parser.add_argument("bags", nargs="+", metavar="BAG", help="bag with images or recorded markers")
    parser.add_argument("-o", "--output", type=Path, required=True, help="map to write, .yaml")
    parser.add_argument("--report", type=Path, help="report to write (default: next to the map, .html)")
    parser.add_argument("--force", action="store_true", help="overwrite existing files")
    add_frame_options(parser.add_argument_group("map frame"))
    add_marker_options(parser.add_argument_group("markers"))
    bags = parser.add_argument_group("bags")
    for add in (add_bag_options, add_robot_options, add_job_options):
        add(bags)
    return parser


def add_frame_options(group) -> None:
    """Adds the options of the map frame."""
    known = group.add_mutually_exclusive_group()
    known.add_argument(
        "--known", metavar="MAP", help="map of known markers, exact or with standard deviations"
    )
    known.add_argument("--refine", metavar="MAP", help="map to refine, e.g. measured by tape")
    group.add_argument(
        "--tape-sigma", type=float, nargs=2, default=(0.01, 0.02), metavar=("METRES", "RADIANS"),
        help="standard deviations of entries of --refine that have none (default: 0.01 0.02)",
    )  # fmt: skip
    group.add_argument(
        "--floor-sigma", type=float, metavar="METRES",
        help="the base moves on the plane z = 0 of the map, with this standard deviation",
    )  # fmt: skip
    group.add_argument(
        "--frame", default="map",
        help="tf frame of the map (default: map); ignored if the file of --known or --refine is .yaml",
    )  # fmt: skip


def add_marker_options(group) -> None:
    """Adds the options of the markers and the noise of their corners."""
    group.add_argument(
        "--families", nargs="+", help="families to detect in images (default: those of the known map)"
    )
    group.add_argument("--size", type=float, default=0.2, help="edge length, metres (default: %(default)s)")
    group.add_argument(
        "--sizes", nargs="+", type=pair, default=[], metavar="ID=METRES", help="of single markers"
    )
    group.add_argument(
        "--corner-sigma", type=float, default=sextant.MappingParams().corner_sigma, metavar="PIXELS",
        help="initial corner noise; it is estimated from the recording (default: %(default)s)",
    )  # fmt: skip
    group.add_argument(
        "--lens-sigma", type=float, default=sextant.MappingParams().lens_sigma, metavar="PIXELS",
        help="standard deviation of the errors of the calibrations, which are estimated with the map; "
        "0: the calibrations are exact (default: %(default)s)",
    )  # fmt: skip


def _make(options: argparse.Namespace) -> Answer:
    """Reads the bags, makes the map, and writes it with its report."""
    report = options.report or options.output.with_suffix(".html")
    if options.output.suffix not in (".yaml", ".yml"):
        raise ValueError(f"{options.output}: the file name of a map with covariances must end in .yaml")
    for path in (options.output, report):
        check_output(path, options.force)
    inputs = marker_inputs(options)
    read, notes = read_bags(drive_reading(options, inputs.known), options.bags, options)
    made = made_markers(options, inputs, [drive for _, drive in read])
    written = write_markers(made, options.output, report)
    return Answer([*notes, verdict(made.quality), *marker_findings(made), *written])


def marker_inputs(options: argparse.Namespace) -> MarkerInputs:
    """Checks the options before any bag is read.

    :raises ValueError, RuntimeError: one is out of range, or the known map cannot be read
    """
    params, sizes = mapping_params(options), marker_sizes(options)
    return MarkerInputs(known_markers(options), sizes, params)


def drive_reading(options: argparse.Namespace, known: "sextant.MarkerMap") -> Callable[[str], RecordedDrive]:
    """Reads the markers of one bag; for read_bags()."""
    families = options.families or sorted({marker.family for marker in known.markers})
    return functools.partial(read_drive, params=bag_params(options, families))


def made_markers(
    options: argparse.Namespace, inputs: MarkerInputs, drives: List[RecordedDrive]
) -> MadeMarkers:
    """Makes the map.

    :raises RuntimeError: no marker can be located
    """
    recorded = recorded_instants(drives)
    result = sextant.make_marker_map(recorded.instants, inputs.sizes, inputs.known, inputs.params)
    quality = map_quality(result, recorded.instants, inputs.known)
    return MadeMarkers(result, recorded, quality, _origin(options, drives, recorded))


def write_markers(made: MadeMarkers, output: Path, report: Path) -> List[str]:
    """Writes the map and its report. :returns: a line on each"""
    sextant.write_marker_map(made.result.map, str(output))
    write_map_report(report, made.result, made.quality, made.origin)
    return [f"{output}: written", f"{report}: report with plots"]


def marker_findings(made: MadeMarkers) -> List[str]:
    """Returns a line on each finding."""
    return [f"- {finding}" for finding in findings(made.quality)]


def known_markers(options: argparse.Namespace) -> "sextant.MarkerMap":
    """Reads the map of --known or --refine; empty without.

    :raises RuntimeError: the file cannot be read
    """
    path = options.known or options.refine
    if not path:
        return sextant.MarkerMap(options.frame)
    text = sextant.TextMapParams()
    text.frame, text.size = options.frame, options.size
    if options.families:
        text.family = options.families[0]
    text.sizes = {int(id): float(size) for id, size in options.sizes}
    known = sextant.read_marker_map(path, text)
    return _taped(known, options.tape_sigma) if options.refine else known


def _taped(known: "sextant.MarkerMap", tape: Sequence[float]) -> "sextant.MarkerMap":
    """Sets the standard deviations (metres, radians) of entries without a covariance."""
    if not (0.0 < tape[0] <= 1.0 and 0.0 < tape[1] <= 1.0):
        raise ValueError(f"--tape-sigma is {tape[0]} {tape[1]}, allowed is (0, 1] for both")
    result, covariance = sextant.MarkerMap(known), np.diag([tape[0] ** 2] * 3 + [tape[1] ** 2] * 3)
    for each in known.markers:
        if not np.any(each.covariance):
            place = (each.T_map_marker, each.name, covariance)
            result.set(sextant.MappedMarker(each.family, each.id, each.size, *place))
    return result


def mapping_params(options: argparse.Namespace) -> "sextant.MappingParams":
    """Returns the parameters of the map maker.

    :raises ValueError: a value out of range
    """
    params = sextant.MappingParams()
    params.corner_sigma, params.lens_sigma = options.corner_sigma, options.lens_sigma
    if options.floor_sigma is not None:
        params.floor_height_sigma = options.floor_sigma
    params.validate()
    return params


def marker_sizes(options: argparse.Namespace) -> "sextant.MarkerSizes":
    """Returns the sizes of markers without a known entry.

    :raises ValueError: a size out of range
    """
    sizes = sextant.MarkerSizes()
    sizes.size, sizes.sizes = options.size, {id: float(size) for id, size in options.sizes}
    sizes.validate()
    return sizes


def _origin(
    options: argparse.Namespace, drives: List[RecordedDrive], recorded: RecordedInstants
) -> MapOrigin:
    values: Dict[str, object] = {
        "known": options.known, "refine": options.refine, "size": options.size,
        "floor_sigma": options.floor_sigma, "every": options.every, "odometry": options.odometry,
    }  # fmt: skip
    given = {name: value for name, value in values.items() if value not in (None, "")}
    return MapOrigin([drive.name for drive in drives], recorded.cameras, options.corner_sigma, given)
