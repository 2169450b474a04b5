# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes a place map: photos, and where in an overview picture each was taken.

    make_place_map exif      of photos whose EXIF says where they were taken
    make_place_map drive     of recorded drives whose poses are known
    make_place_map picture   without photos: an overview, on which place_map_maker places them by clicks

What each takes: make_place_map WAY --help
"""

import argparse
import sys
from typing import Optional, Sequence

from sextant.commands import place_map_of_drives, place_map_of_photos, place_map_of_picture
from sextant.commands.command_line import Answer, CommandParser, run

WAYS = {"exif": place_map_of_photos, "drive": place_map_of_drives, "picture": place_map_of_picture}


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """:returns: exit code: 0, or 2 when no map was written."""
    arguments = sys.argv[1:] if arguments is None else list(arguments)
    if arguments and arguments[0] in WAYS:
        way = WAYS[arguments[0]]
        return run(way.parser(), arguments[1:], way.make)
    return run(_parser(), arguments, _misplaced)


def _parser() -> CommandParser:
    parser = CommandParser(prog="make_place_map", description=__doc__)
    parser.add_argument("way", metavar="WAY", choices=WAYS, help=", ".join(WAYS))
    return parser


def _misplaced(options: argparse.Namespace) -> Answer:
    raise ValueError(f"{options.way} has to come first (--help tells more)")
