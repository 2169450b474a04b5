# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes a place map of a folder of photos whose EXIF says where they were taken.

    make_place_map exif photos/                                   photos/map.txt, on a sheet that is drawn
    make_place_map exif photos/ --overview park.png --north-west 55.62,13.01 --south-east 55.61,13.03
    make_place_map exif photos/ --add                             those that are not in the map yet

Corners that are not named are those of a world file in degrees (park.pgw beside park.png).
"""

import argparse
from pathlib import Path
from typing import List

import numpy as np

from sextant.commands.command_line import Answer, CommandParser
from sextant.commands.georeference_options import add_corner_options, corners_of
from sextant.commands.place_map_output import add_output_options, existing_map, write_map
from sextant.place_maps.exif_map import corners_around, exif_map, extent, find_photos, positions_of
from sextant.place_maps.overview import draw_overview
from sextant.place_maps.overview_picture import OverviewPicture, drawn_picture, taken_picture
from sextant.place_maps.place_map import image_in
from sextant.place_maps.world_file import corners_beside

MARGIN = 20.0  # metres


def parser() -> CommandParser:
    """Of `make_place_map exif`."""
    result = CommandParser(prog="make_place_map exif", description=__doc__)
    result.add_argument("folder", type=Path, metavar="PHOTOS", help="folder; those below it count, too")
    add_output_options(result, "PHOTOS/map.txt")
    begin = result.add_mutually_exclusive_group()
    begin.add_argument("--add", action="store_true", help="to the map that is there, on its overview")
    begin.add_argument("--overview", type=Path, metavar="PICTURE", help="default: one is drawn")
    begin.add_argument(
        "--margin", type=float, default=MARGIN, metavar="METRES",
        help="around the photos, of a drawn overview (default: %(default)s)",
    )  # fmt: skip
    add_corner_options(result)
    return result


def make(options: argparse.Namespace) -> Answer:
    """Places the photos. :raises OSError, ValueError: there is no map of them"""
    if not options.folder.is_dir():
        raise NotADirectoryError(20, "is no folder", str(options.folder))
    options.output = options.output or options.folder / "map.txt"
    begun, files = existing_map(options), {}
    photos = find_photos(options.folder)
    if begun is None:
        picture = _overview(options, photos)
        begun, files = picture.empty_map(options.output.parent), picture.files
    elif corners_of(options):
        raise ValueError(f"{options.output}: has its corners already, none can be named with --add")
    known = {begun.overview.image, *(photo.image for photo in begun.photos)}
    made = exif_map(begun, [path for path in photos if image_in(begun.folder, path) not in known])
    if not made.place_map.photos:
        reasons = list(made.left_out.values()) or ["there is none"]
        raise ValueError(f"{options.folder}: no photo can be placed: {reasons[0]} (of {len(reasons)})")
    return write_map(options, made.place_map, files, list(made.left_out.values()))


def _overview(options: argparse.Namespace, photos: List[Path]) -> OverviewPicture:
    corners = corners_of(options)
    if options.overview:
        corners = corners or corners_beside(options.overview)
        if corners is None:
            raise ValueError(f"{options.overview}: where does it lie? Name --north-west and --south-east")
        return taken_picture(options.output.parent, options.overview, corners)
    if not 0 < options.margin < np.inf:
        raise ValueError(f"--margin is {options.margin:g}, allowed are metres above 0")
    positions, _ = positions_of(photos)
    corners = corners or corners_around(list(positions.values()), options.margin)
    image, _ = draw_overview([], *extent(corners))
    return drawn_picture(f"{options.output.stem}.png", image, corners)
