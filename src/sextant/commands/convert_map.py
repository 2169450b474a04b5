# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Converts marker maps between fiducial_slam, apriltag_ros, tagslam, and Sextant's YAML and text formats."""

import argparse
from pathlib import Path
from typing import Optional, Sequence

import sextant
from sextant.commands.command_line import Answer, CommandParser, check_output, run
from sextant.markers.formats.format_types import MapFormatParams
from sextant.markers.map_formats import (
    FORMATS,
    guess_read_format,
    guess_write_format,
    read_map,
    write_map,
)


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """Runs the command.

    :returns: exit code: 0, or 2 when nothing was written
    """
    return run(_parser(), arguments, _convert)


def _parser() -> CommandParser:
    parser = CommandParser(prog="convert_map", description=__doc__)
    parser.add_argument("input", metavar="IN", help="map to read")
    parser.add_argument("output", metavar="OUT", help="file to write")
    parser.add_argument(
        "--from", dest="source", choices=FORMATS, help="format of IN (default: guessed from its content)"
    )
    parser.add_argument(
        "--to", dest="target", choices=FORMATS, help="format of OUT (default: yaml for .yaml and .yml)"
    )
    parser.add_argument("--family", help="family of the markers, e.g. tag36h11, if IN does not contain it")
    parser.add_argument(
        "--size", type=float, help="edge length of the markers in metres, if IN does not contain it"
    )
    parser.add_argument("--bundle", help="bundle (apriltag_ros) or body (tagslam) to read, if IN has several")
    parser.add_argument("--frame", help="tf frame of the map, if IN does not contain it (default: map)")
    parser.add_argument("--force", action="store_true", help="overwrite OUT")
    return parser


def _convert(options: argparse.Namespace) -> Answer:
    """Converts the map; lines that begin with "lost:" list what was not converted."""
    source = options.source or guess_read_format(options.input)
    target = options.target or guess_write_format(options.output)
    check_output(Path(options.output), options.force)
    read = read_map(
        options.input, source, MapFormatParams(options.frame, options.family, options.size, options.bundle)
    )
    lost = write_map(read.marker_map, options.output, target)
    return Answer(
        [
            f"{options.input}: read {_summary(read.marker_map)} ({source})",
            *(f"lost: {warning}" for warning in read.warnings),
            f"{options.output}: written ({target})",
            *(f"lost: {warning}" for warning in lost),
        ]
    )


def _summary(marker_map: sextant.MarkerMap) -> str:
    """Summarizes a map, e.g. 12 markers of tag36h11, 0.2 m, in frame 'map'."""
    count = len(marker_map.markers)
    families = ", ".join(sorted({marker.family for marker in marker_map.markers}))
    sizes = ", ".join(f"{size:g} m" for size in sorted({marker.size for marker in marker_map.markers}))
    return f"{count} marker{'s' * (count != 1)} of {families}, {sizes}, in frame '{marker_map.frame}'"
