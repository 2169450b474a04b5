# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Begins a place map without photos, of an overview that says where it lies; place_map_maker goes on with it.

    make_place_map picture floor.yaml -o hall/map.txt             of map_server: frame, resolution and origin
    make_place_map picture plan.png -o hall/map.txt --resolution 0.05 --origin=-10,-5,0
    make_place_map picture park.png -o park/map.txt --north-west 55.62,13.01 --south-east 55.61,13.03

A picture that lies elsewhere is copied beside the map, one that browsers do not show (.pgm) as PNG.
"""

import argparse
from pathlib import Path
from typing import Union

from sextant.commands.command_line import Answer, CommandParser, check_output
from sextant.commands.georeference_options import add_corner_options, corners_of
from sextant.commands.place_map_output import add_output_options, write_map
from sextant.place_maps.overview_picture import map_server_picture, taken_picture
from sextant.place_maps.place_map import GeoCorners, MetricFrame, check_georeference
from sextant.place_maps.world_file import corners_beside

FRAME = "map"


def parser() -> CommandParser:
    """Of `make_place_map picture`."""
    result = CommandParser(prog="make_place_map picture", description=__doc__)
    result.add_argument("picture", type=Path, metavar="PICTURE", help="or YAML of map_server")
    add_output_options(result)
    group = result.add_argument_group("where it lies in a tf frame")
    group.add_argument("--frame", default="", help=f"default: {FRAME}")
    group.add_argument("--resolution", type=float, metavar="METRES", help="a pixel")
    group.add_argument("--origin", metavar="X,Y,YAW", help="of its lower left corner (default: 0,0,0)")
    add_corner_options(result)
    return result


def make(options: argparse.Namespace) -> Answer:
    """Writes the map. :raises OSError, ValueError: the picture, or what is said of it, cannot be"""
    check_output(options.output, options.force)
    folder, place = options.output.parent, _place(options)
    is_yaml = options.picture.suffix in (".yaml", ".yml")
    if options.frame and options.resolution is None and not is_yaml:
        raise ValueError("--frame needs a --resolution")
    if is_yaml:
        if place:
            raise ValueError(f"{options.picture}: says itself where it lies; only --frame can be named")
        picture = map_server_picture(folder, options.picture, options.frame or FRAME)
    else:
        picture = taken_picture(folder, options.picture, place or corners_beside(options.picture))
    return write_map(options, picture.empty_map(folder), picture.files)


def _place(options: argparse.Namespace) -> Union[MetricFrame, GeoCorners, None]:
    """What the options say, but for a --frame alone."""
    corners = corners_of(options)
    if options.resolution is None:
        if options.origin:
            raise ValueError("--origin needs a --resolution")
        return corners
    if corners:
        raise ValueError("it lies in a tf frame (--resolution) or on the earth (corners), not in both")
    try:
        x, y, yaw = (float(word) for word in (options.origin or "0,0,0").split(","))
    except ValueError:
        raise ValueError(f"--origin is '{options.origin}', expected X,Y,YAW in metres and radians") from None
    place = MetricFrame(options.frame or FRAME, options.resolution, (x, y, yaw))
    check_georeference(place)
    return place
