# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes a place map without photos from a georeferenced overview, for place_map_maker.

    make_place_map image floor.yaml -o hall/map.txt             map_server: frame, resolution and origin
    make_place_map image plan.png -o hall/map.txt --resolution 0.05 --origin=-10,-5,0
    make_place_map image park.png -o park/map.txt --north-west 55.62,13.01 --south-east 55.61,13.03

An image in another folder is copied beside the map; formats that browsers do not show (.pgm) become PNG.
"""

import argparse
from pathlib import Path
from typing import Union

from sextant.commands.command_line import Answer, CommandParser, check_output
from sextant.commands.places.georeference_options import add_corner_options, corners_of
from sextant.commands.places.place_map_output import add_output_options, write_map
from sextant.place_maps.overview_image import overview_from_file, overview_from_map_server
from sextant.place_maps.place_map import GeoCorners, MetricFrame
from sextant.place_maps.world_file import corners_beside

FRAME = "map"


def parser() -> CommandParser:
    """Parser of `make_place_map image`."""
    result = CommandParser(prog="make_place_map image", description=__doc__)
    result.add_argument("image", type=Path, metavar="IMAGE", help="image, or YAML file of map_server")
    add_output_options(result)
    group = result.add_argument_group("position in a tf frame")
    group.add_argument("--frame", default="", help=f"default: {FRAME}")
    group.add_argument("--resolution", type=float, metavar="METRES", help="metres per pixel")
    group.add_argument("--origin", metavar="X,Y,YAW", help="pose of its lower left corner (default: 0,0,0)")
    add_corner_options(result)
    return result


def make(options: argparse.Namespace) -> Answer:
    """Writes the map.

    :raises OSError, ValueError: the image or its position is invalid
    """
    check_output(options.output, options.force)
    folder, place = options.output.parent, _place(options)
    is_yaml = options.image.suffix in (".yaml", ".yml")
    if options.frame and options.resolution is None and not is_yaml:
        raise ValueError("--frame needs a --resolution")
    if is_yaml:
        if place:
            raise ValueError(f"{options.image}: contains its position; only --frame can be set")
        overview = overview_from_map_server(folder, options.image, options.frame or FRAME)
    else:
        overview = overview_from_file(folder, options.image, place or corners_beside(options.image))
    return write_map(options, overview.empty_map(folder), overview.files)


def _place(options: argparse.Namespace) -> Union[MetricFrame, GeoCorners, None]:
    """Position of the overview by the options; None if there is none."""
    corners = corners_of(options)
    if options.resolution is None:
        if options.origin:
            raise ValueError("--origin needs a --resolution")
        return corners
    if corners:
        raise ValueError("set a tf frame (--resolution) or geographic corners, not both")
    try:
        x, y, yaw = (float(word) for word in (options.origin or "0,0,0").split(","))
    except ValueError:
        raise ValueError(f"--origin is '{options.origin}', expected X,Y,YAW in metres and radians") from None
    place = MetricFrame(options.frame or FRAME, options.resolution, (x, y, yaw))
    place.check()
    return place
