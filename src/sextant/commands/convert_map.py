# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Turns a marker map into another format: fiducial_slam, apriltag_ros, tagslam, Sextant's YAML or text."""

import argparse
import os
import sys
from typing import List, Optional, Sequence

import sextant
from sextant.markers.formats.map_file import MapFileError, MapOptions
from sextant.markers.map_formats import (
    FORMATS,
    guess_read_format,
    guess_write_format,
    read_map,
    write_map,
)


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> None:
        self.exit(2, f"{self.prog}: {message} (--help tells more)\n")


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="convert_map", description=__doc__)
    parser.add_argument("input", metavar="IN", help="the map to read")
    parser.add_argument("output", metavar="OUT", help="the file to write")
    parser.add_argument("--from", dest="source", choices=FORMATS, help="default: what IN looks like")
    parser.add_argument("--to", dest="target", choices=FORMATS, help="default: yaml for .yaml and .yml")
    parser.add_argument("--family", help="of the markers, e.g. tag36h11, where IN does not say it")
    parser.add_argument("--size", type=float, help="edge of the markers in metres, where IN does not say it")
    parser.add_argument("--bundle", help="the bundle (apriltag_ros) or body (tagslam) to read, of several")
    parser.add_argument("--frame", help="tf frame of the map, where IN does not say it (default: map)")
    parser.add_argument("--force", action="store_true", help="overwrite OUT")
    return parser


def convert(arguments: argparse.Namespace) -> List[str]:
    """Reads, writes, and tells what.

    :returns: the lines to print; those that begin with "lost:" were not converted
    :raises MapFileError: what stops it, in one line
    """
    source = arguments.source or guess_read_format(arguments.input)
    target = arguments.target or guess_write_format(arguments.output)
    if os.path.lexists(arguments.output) and not arguments.force:
        raise MapFileError(f"{arguments.output}: is there already, --force overwrites it")
    options = MapOptions(arguments.frame, arguments.family, arguments.size, arguments.bundle)
    read = read_map(arguments.input, source, options)
    lost = write_map(read.marker_map, arguments.output, target)
    return [
        f"{arguments.input}: read {_summary(read.marker_map)} ({source})",
        *(f"lost: {warning}" for warning in read.warnings),
        f"{arguments.output}: written ({target})",
        *(f"lost: {warning}" for warning in lost),
    ]


def _summary(marker_map: sextant.MarkerMap) -> str:
    """E.g. 12 markers of tag36h11, 0.2 m, in frame 'map'."""
    count = len(marker_map.markers)
    families = ", ".join(sorted({marker.family for marker in marker_map.markers}))
    sizes = ", ".join(f"{size:g} m" for size in sorted({marker.size for marker in marker_map.markers}))
    return f"{count} marker{'s' * (count != 1)} of {families}, {sizes}, in frame '{marker_map.frame}'"


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """The command line.

    :returns: 0, or 2 when nothing was written; wrong arguments end with SystemExit(2)
    """
    parsed = _parser().parse_args(arguments)
    try:
        lines = convert(parsed)
    except MapFileError as error:
        print(f"convert_map: {error}", file=sys.stderr)
        return 2
    print("\n".join(lines))
    return 0
