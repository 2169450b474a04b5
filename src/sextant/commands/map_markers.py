# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes a marker map of recorded drives: with one known marker, with none, or of a taped map to be refined.

    map_markers drive.bag -o map.yaml --size 0.16                     the first marker is the origin
    map_markers drive.bag -o map.yaml --size 0.16 --known door.yaml   the map's frame is that of door.yaml
    map_markers *.bag -o better.yaml --refine taped.yaml              and tells which entries are wrong

Beside the map it writes a report, better.html.
"""

import argparse
import functools
from pathlib import Path
from typing import Dict, List, Optional, Sequence

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


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """:returns: exit code: 0, or 2 when nothing was written."""
    return run(_parser(), arguments, _make)


def _parser() -> CommandParser:
    parser = CommandParser(prog="map_markers", description=__doc__)
    parser.add_argument("bags", nargs="+", metavar="BAG", help="with images, or with recorded markers")
    parser.add_argument("-o", "--output", type=Path, required=True, help="map to write, .yaml")
    parser.add_argument("--report", type=Path, help="report to write (default: beside the map, .html)")
    parser.add_argument("--force", action="store_true", help="overwrite files that are there")
    _add_frame(parser.add_argument_group("what holds the frame"))
    _add_markers(parser.add_argument_group("markers"))
    bags = parser.add_argument_group("bags")
    for add in (add_bag_options, add_robot_options, add_job_options):
        add(bags)
    return parser


def _add_frame(group) -> None:
    known = group.add_mutually_exclusive_group()
    known.add_argument(
        "--known", metavar="MAP", help="markers whose places are known, exactly or by their sigmas"
    )
    known.add_argument("--refine", metavar="MAP", help="measured by tape: all of it is to get better")
    group.add_argument(
        "--tape", type=float, nargs=2, default=(0.01, 0.02), metavar=("METRES", "RADIANS"),
        help="deviations of --refine's entries that do not tell their own (default: 0.01 0.02)",
    )  # fmt: skip
    group.add_argument(
        "--floor", type=float, metavar="METRES", help="the base stays on the map's plane z = 0 so exactly"
    )
    group.add_argument("--frame", default="map", help="tf frame, where no map tells it (default: map)")


def _add_markers(group) -> None:
    group.add_argument(
        "--families", nargs="+", help="to look for in images (default: those of the known map)"
    )
    group.add_argument("--size", type=float, default=0.2, help="edge, metres (default: %(default)s)")
    group.add_argument(
        "--sizes", nargs="+", type=pair, default=[], metavar="ID=METRES", help="of single markers"
    )
    group.add_argument(
        "--corner-sigma", type=float, default=sextant.MappingParams().corner_sigma, metavar="PIXELS",
        help="noise of a corner to begin with; the recording tells its own (default: %(default)s)",
    )  # fmt: skip


def _make(options: argparse.Namespace) -> Answer:
    """Reads the bags, makes the map, writes it and its report."""
    report = options.report or options.output.with_suffix(".html")
    if options.output.suffix not in (".yaml", ".yml"):
        raise ValueError(f"{options.output}: a map with covariances is .yaml")
    for path in (options.output, report):
        check_output(path, options.force)
    params, sizes, known = mapping_params(options), marker_sizes(options), known_markers(options)
    families = options.families or sorted({marker.family for marker in known.markers})
    reading = functools.partial(read_drive, params=bag_params(options, families))
    read, notes = read_bags(reading, options.bags, options)
    drives = [drive for _, drive in read]
    recorded = recorded_instants(drives)
    made = sextant.make_marker_map(recorded.instants, sizes, known, params)
    quality = map_quality(made, recorded.instants, _seen(recorded), known)
    sextant.write_marker_map(_named(made.map, options), str(options.output))
    write_map_report(report, made, quality, _origin(options, drives, recorded))
    written = [f"{options.output}: written", f"{report}: what it was made of, with pictures"]
    return Answer([*notes, *_told(quality), *written])


def known_markers(options: argparse.Namespace) -> "sextant.MarkerMap":
    """The map that holds the frame; empty if there is none. :raises RuntimeError: it cannot be read"""
    path = options.known or options.refine
    if not path:
        return sextant.MarkerMap(options.frame)
    text = sextant.TextMapParams()
    text.frame, text.size = options.frame, options.size
    if options.families:
        text.family = options.families[0]
    text.sizes = {int(id): float(size) for id, size in options.sizes}
    known = sextant.read_marker_map(path, text)
    return _taped(known, options.tape) if options.refine else known


def _taped(known: "sextant.MarkerMap", tape: Sequence[float]) -> "sextant.MarkerMap":
    """With these deviations (metres, radians) where an entry does not tell its own."""
    if not (0.0 < tape[0] <= 1.0 and 0.0 < tape[1] <= 1.0):
        raise ValueError(f"--tape is {tape[0]} {tape[1]}, allowed is (0, 1] for both")
    result, covariance = sextant.MarkerMap(known.frame), np.diag([tape[0] ** 2] * 3 + [tape[1] ** 2] * 3)
    for marker in known.markers:
        own = np.any(marker.covariance)
        result.add(
            sextant.MappedMarker(
                marker.family, marker.id, marker.size, marker.T_map_marker, marker.name,
                marker.covariance if own else covariance,
            )
        )  # fmt: skip
    return result


def mapping_params(options: argparse.Namespace) -> "sextant.MappingParams":
    """:raises ValueError: one out of range"""
    params = sextant.MappingParams()
    params.corner_sigma = options.corner_sigma
    if options.floor is not None:
        params.floor_height_sigma = options.floor
    params.validate()
    return params


def marker_sizes(options: argparse.Namespace) -> "sextant.MarkerSizes":
    """Of the markers that are not known. :raises ValueError: one out of range"""
    sizes = sextant.MarkerSizes()
    sizes.size, sizes.sizes = options.size, {id: float(size) for id, size in options.sizes}
    sizes.validate()
    return sizes


def _seen(recorded: RecordedInstants) -> list:
    """(family, id) of every detection, by instant and view."""
    return [
        [[(each.family, each.id) for each in view.detections] for view in instant.views]
        for instant in recorded.instants
    ]


def _named(marker_map: "sextant.MarkerMap", options: argparse.Namespace) -> "sextant.MarkerMap":
    """In the frame that the known map has, or that was asked for."""
    if options.known or options.refine or marker_map.frame == options.frame:
        return marker_map
    result = sextant.MarkerMap(options.frame)
    for marker in marker_map.markers:
        result.add(marker)
    return result


def _origin(
    options: argparse.Namespace, drives: List[RecordedDrive], recorded: RecordedInstants
) -> MapOrigin:
    told: Dict[str, object] = {
        "known": options.known, "refine": options.refine, "size": options.size, "floor": options.floor,
        "every": options.every, "odometry": options.odometry,
    }  # fmt: skip
    given = {name: value for name, value in told.items() if value not in (None, "")}
    return MapOrigin([drive.name for drive in drives], recorded.cameras, options.corner_sigma, given)


def _told(quality: MapQuality) -> List[str]:
    return [verdict(quality), *(f"- {finding}" for finding in findings(quality))]
