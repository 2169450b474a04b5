# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes a place map from a folder of photos with GPS positions in their EXIF data.

    make_place_map exif photos/          write photos/map.txt, with an overview drawn around the photos
    make_place_map exif photos/ --add    add photos that are not in the map yet
    make_place_map exif photos/ --overview park.png --north-west 55.62,13.01 --south-east 55.61,13.03

Without --north-west and --south-east, an --overview needs a world file in degrees beside it (park.pgw for
park.png).
"""

import argparse
from pathlib import Path
from typing import List

import numpy as np

from sextant.commands.command_line import Answer, CommandParser
from sextant.commands.places.georeference_options import add_corner_options, corners_of
from sextant.commands.places.place_map_output import add_output_options, existing_map, write_map
from sextant.images.photo_file import find_photos
from sextant.place_maps.exif_map import corners_around, exif_map, positions_of
from sextant.place_maps.overview import draw_overview
from sextant.place_maps.overview_image import OverviewImage, drawn_overview, overview_from_file
from sextant.place_maps.place_map import image_in
from sextant.place_maps.world_file import corners_beside

MARGIN = 20.0  # metres


def parser() -> CommandParser:
    """Parser of `make_place_map exif`."""
    result = CommandParser(prog="make_place_map exif", description=__doc__)
    result.add_argument("folder", type=Path, metavar="PHOTOS", help="folder of photos, with subfolders")
    add_output_options(result, "PHOTOS/map.txt")
    exclusive = result.add_mutually_exclusive_group()
    exclusive.add_argument("--add", action="store_true", help="add to the existing map, on its overview")
    exclusive.add_argument(
        "--overview", type=Path, metavar="IMAGE", help="north-up image (default: one is drawn)"
    )
    text = "width of the border around the photos in a drawn overview (default: %(default)s)"
    exclusive.add_argument("--margin", type=float, default=MARGIN, metavar="METRES", help=text)
    add_corner_options(result)
    return result


def make(options: argparse.Namespace) -> Answer:
    """Writes the map.

    :raises OSError, ValueError: no map can be made of the photos
    """
    if not options.folder.is_dir():
        raise NotADirectoryError(20, "is not a folder", str(options.folder))
    options.output = options.output or options.folder / "map.txt"
    base_map, files = existing_map(options), {}
    photos = find_photos(options.folder)
    if base_map is None:
        overview = _overview(options, photos)
        base_map, files = overview.empty_map(options.output.parent), overview.files
    elif corners_of(options):
        raise ValueError(f"{options.output}: already has corners, they cannot be set with --add")
    known = {base_map.overview.image, *(photo.image for photo in base_map.photos)}
    new = [path for path in photos if image_in(base_map.folder, path) not in known]
    made, left_out = exif_map(base_map, new)
    reasons = list(left_out.values())
    if not made.photos:
        reason = f"{reasons[0]} (the first of {len(reasons)} reasons)" if reasons else "there is none"
        raise ValueError(f"{options.folder}: no photo can be placed: {reason}")
    return write_map(options, made, files, reasons)


def _overview(options: argparse.Namespace, photos: List[Path]) -> OverviewImage:
    corners = corners_of(options)
    if options.overview:
        corners = corners or corners_beside(options.overview)
        if corners is None:
            raise ValueError(f"{options.overview}: has no corners; set --north-west and --south-east")
        return overview_from_file(options.output.parent, options.overview, corners)
    if not 0 < options.margin < np.inf:
        raise ValueError(f"--margin is {options.margin:g}, it must be above 0 metres")
    positions, _ = positions_of(photos)
    corners = corners or corners_around(list(positions.values()), options.margin)
    image, _ = draw_overview([], *corners.extent())
    return drawn_overview(f"{options.output.stem}.png", image, corners)
