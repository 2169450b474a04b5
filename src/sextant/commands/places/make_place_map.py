# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes a place map: photos and their positions in an overview image.

    make_place_map exif      from photos with GPS positions in their EXIF data
    make_place_map drive     from bags of drives with known poses
    make_place_map image     an overview without photos, to be placed by clicks with place_map_maker
    make_place_map clusters  from another map: neighbouring places become one

Options: make_place_map COMMAND --help. place_map_maker edits a map by clicks on a web page.
"""

import argparse
import sys
from typing import Optional, Sequence

from sextant.commands.command_line import Answer, CommandParser, run
from sextant.commands.places import (
    place_map_of_clusters,
    place_map_of_drives,
    place_map_of_image,
    place_map_of_photos,
)

COMMANDS = {
    "exif": place_map_of_photos,
    "drive": place_map_of_drives,
    "image": place_map_of_image,
    "clusters": place_map_of_clusters,
}


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """:returns: exit code: 0, or 2 if no map was written."""
    arguments = sys.argv[1:] if arguments is None else list(arguments)
    if arguments and arguments[0] in COMMANDS:
        command = COMMANDS[arguments[0]]
        return run(command.parser(), arguments[1:], command.make)
    return run(_parser(), arguments, _misplaced)


def _parser() -> CommandParser:
    parser = CommandParser(prog="make_place_map", description=__doc__)
    parser.add_argument("command", metavar="COMMAND", choices=COMMANDS, help=", ".join(COMMANDS))
    return parser


def _misplaced(options: argparse.Namespace) -> Answer:
    raise ValueError(f"{options.command} must be the first argument (see --help)")
