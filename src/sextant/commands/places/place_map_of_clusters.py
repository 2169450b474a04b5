# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes a place map whose places are clusters of those of another map; both share the photos.

    make_place_map clusters park/map.txt -o park/parts.txt --count 12      twelve parts of the park
    make_place_map clusters park/map.txt -o park/spots.txt --size 3        photos within 3 m are one spot

All photos of a cluster get the position of its middle place.
"""

import argparse
from pathlib import Path

from sextant.commands.command_line import Answer, CommandParser, check_output
from sextant.commands.places.place_map_output import add_output_options, write_map
from sextant.place_maps.place_clusters import clustered, clustered_by_size
from sextant.place_maps.place_map_file import read_place_map
from sextant.places.place_estimate import scale_of


def parser() -> CommandParser:
    """Parser of `make_place_map clusters`."""
    result = CommandParser(prog="make_place_map clusters", description=__doc__)
    result.add_argument("map", type=Path, metavar="MAP")
    clusters = result.add_mutually_exclusive_group(required=True)
    clusters.add_argument("--count", type=int, metavar="N", help="number of clusters")
    text = "largest diameter of a cluster; pixels if the map has no scale"
    clusters.add_argument("--size", type=float, metavar="METRES", help=text)
    add_output_options(result)
    return result


def make(options: argparse.Namespace) -> Answer:
    """Writes the map.

    :raises OSError, ValueError: the map cannot be read, divided or written
    """
    check_output(options.output, options.force)
    place_map = read_place_map(options.map)
    if not place_map.photos:
        raise ValueError(f"{options.map}: the map has no photos")
    scale = scale_of(place_map) or (1.0, 1.0)
    if options.count is None:
        return write_map(options, clustered_by_size(place_map, options.size, scale), {})
    return write_map(options, clustered(place_map, options.count, scale), {})
