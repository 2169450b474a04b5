# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the ways to make a place map have in common: the files that they write, and what they tell of them."""

import argparse
from pathlib import Path
from typing import Dict, Optional, Sequence

from sextant.base.atomic_file import atomic_files
from sextant.commands.command_line import Answer, check_output
from sextant.place_maps.place_map import PlaceMap
from sextant.place_maps.place_map_file import read_place_map, write_place_map


def add_output_options(parser: argparse.ArgumentParser, default: str = "") -> None:
    """--output and --force. :param default: what is said of it; empty: the output has to be named"""
    parser.add_argument(
        "-o", "--output", type=Path, metavar="MAP", required=not default,
        help="map to write" + (f" (default: {default})" if default else ""),
    )  # fmt: skip
    parser.add_argument("--force", action="store_true", help="overwrite files that are there")


def existing_map(options: argparse.Namespace) -> Optional[PlaceMap]:
    """The map that --add adds to; None: a new one is begun.

    :raises OSError, ValueError: it cannot be read; or there is a map and it is not to be overwritten
    """
    if options.add:
        return read_place_map(options.output)
    check_output(options.output, options.force)
    return None


def write_map(
    options: argparse.Namespace,
    place_map: PlaceMap,
    files: Dict[str, bytes],
    left_out: Sequence[str] = (),
    notes: Sequence[str] = (),
) -> Answer:
    """The pictures that come with a map, and then the map, so that it never names what is not there.

    :param files: by name in the map's folder; those that are there already as they are to be stay untouched
    :param left_out: photos that are not in the map, each with the reason
    :param notes: what else is to be told
    :raises OSError, ValueError: nothing was written but, at most, pictures
    """
    place_map.check()
    folder = options.output.parent
    new = {name: content for name, content in files.items() if not _is(folder / name, content)}
    for name in new:
        check_output(folder / name, options.force)
    with atomic_files(folder) as temporary:
        for name, content in new.items():
            (temporary / name).write_bytes(content)
    write_place_map(options.output, place_map)
    return Answer([*notes, *left_out, f"{options.output}: {_told(place_map, len(left_out))}"])


def _is(path: Path, content: bytes) -> bool:
    return path.is_file() and path.read_bytes() == content


def _told(place_map: PlaceMap, left_out: int) -> str:
    photos, places = len(place_map.photos), len(place_map.places())
    told = f"{photos} photos of {places} places" if photos else f"no photo yet, on {place_map.overview.image}"
    return told + (f"; {left_out} left out" if left_out else "")
