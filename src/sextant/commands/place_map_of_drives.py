# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes a place map of recorded drives whose poses are known: by tf, or by a topic of poses.

    make_place_map drive hall.bag -o hall/map.txt                          tf knows map -> base_link
    make_place_map drive hall.bag -o hall/map.txt --pose /marker_locator/pose
    make_place_map drive *.bag -o hall/map.txt --map-yaml floor.yaml       on the map of map_server
    make_place_map drive evening.bag -o hall/map.txt --add                 more pictures of the same places

Photos go into the map's folder. Without --map-yaml a sheet is drawn that shows the paths.
"""

import argparse
import functools
import math
import os
from collections import Counter
from pathlib import Path
from typing import Dict, List, Sequence, Tuple

import numpy as np

from sextant.bags.drive_photos import DrivePhoto, DrivePhotos, PhotoParams, read_drive_photos
from sextant.commands.bag_options import add_job_options, add_mount_options, read_bags, read_mounts
from sextant.commands.command_line import Answer, CommandParser
from sextant.commands.place_map_output import add_output_options, existing_map, write_map
from sextant.place_maps.map_addition import NewPhoto, add_photos
from sextant.place_maps.overview import draw_paths
from sextant.place_maps.overview_picture import OverviewPicture, drawn_picture, map_server_picture
from sextant.place_maps.place_map import MetricFrame, PlaceMap

MARGIN = 3.0  # metres
# Of the distance: another pass is at most half of it off along the path, so that there is some for the side;
# photos of one pass are at least nine tenths apart.
MERGE = 0.75


def parser() -> CommandParser:
    """Of `make_place_map drive`."""
    result = CommandParser(prog="make_place_map drive", description=__doc__)
    result.add_argument("bags", nargs="+", metavar="BAG", help="with images and poses")
    add_output_options(result)
    begin = result.add_mutually_exclusive_group()
    begin.add_argument("--add", action="store_true", help="to the map that is there, on its overview")
    begin.add_argument(
        "--map-yaml", type=Path, metavar="YAML", help="of map_server: its picture is the overview"
    )
    begin.add_argument(
        "--margin", type=float, default=MARGIN, metavar="METRES",
        help="around the paths, of a drawn overview (default: %(default)s)",
    )  # fmt: skip
    _add_picking(result.add_argument_group("which photos"))
    _add_poses(result.add_argument_group("poses"))
    bags = result.add_argument_group("bags")
    bags.add_argument("--image", default="", metavar="TOPIC", help="default: that of the only camera")
    bags.add_argument("--every", type=int, default=1, metavar="N", help="only every n-th image")
    add_job_options(bags)
    return result


def _add_picking(group) -> None:
    group.add_argument(
        "--distance", type=float, default=PhotoParams.distance, metavar="METRES",
        help="from one to the next (default: %(default)s)",
    )  # fmt: skip
    group.add_argument(
        "--turn", type=float, default=round(math.degrees(PhotoParams.turn)), metavar="DEGREES",
        help="another one after the camera turned so far (default: %(default)s)",
    )  # fmt: skip
    group.add_argument(
        "--merge", type=float, metavar="METRES",
        help=f"this near to a place, a photo is one more picture of it (default: {MERGE:g} of --distance)",
    )  # fmt: skip


def _add_poses(group) -> None:
    group.add_argument("--frame", default="", help=f"where tf has the base (default: {PhotoParams.frame})")
    group.add_argument("--pose", default="", metavar="TOPIC", help="of the base's poses, in place of tf")
    add_mount_options(group)


def make(options: argparse.Namespace) -> Answer:
    """Reads the bags and writes their map.

    :raises OSError, ValueError, RuntimeError: an option or a bag that cannot be; there is no map of them
    """
    begun = existing_map(options)
    _check(options)
    reading = functools.partial(read_drive_photos, params=_photo_params(options))
    read, notes = read_bags(reading, options.bags, options)
    drives = [drive for _, drive in read]
    frame, files = _frame(read), {}
    if begun is None:
        picture = _overview(options, frame, drives)
        begun, files = picture.empty_map(options.output.parent), picture.files
    place = _metric(options.output, begun, frame)
    photos = _by_name(drives)
    known = [photo.image for photo in begun.photos if photos.pop(photo.image, None)]
    notes += [f"{len(known)} photos of these drives are in the map already"] if known else []
    found = [_new_photo(begun, place, photo) for photo in photos.values()]
    made, left_out = add_photos(begun, found, _merge(options) / place.resolution)
    if not made.photos:
        raise ValueError(f"no photo can be placed: {_told(left_out)[0]} (of {len(left_out)})")
    files.update({name: photo.jpeg for name, photo in photos.items() if name not in left_out})
    return write_map(options, made, files, _told(left_out), notes)


def _check(options: argparse.Namespace) -> None:
    """Before anything is read."""
    if options.pose and options.frame:
        raise ValueError("--frame means nothing with --pose: its poses say their frame")
    if not 0 < options.margin < np.inf:
        raise ValueError(f"--margin is {options.margin:g}, allowed are metres above 0")
    if options.merge is not None and not 0 <= options.merge < np.inf:
        raise ValueError(f"--merge is {options.merge:g}, allowed are metres from 0 on")
    if not 0 < options.turn <= 360:
        raise ValueError(f"--turn is {options.turn:g}, allowed are degrees above 0, up to 360")
    again = [bag for bag, count in Counter(map(os.path.realpath, options.bags)).items() if count > 1]
    if again:
        raise ValueError(f"{again[0]}: is named twice")


def _merge(options: argparse.Namespace) -> float:
    return MERGE * options.distance if options.merge is None else options.merge


def _photo_params(options: argparse.Namespace) -> PhotoParams:
    return PhotoParams(
        options.image, options.pose, options.frame or PhotoParams.frame, options.distance,
        math.radians(options.turn), options.every, options.base_frame, read_mounts(options.mounts),
    )  # fmt: skip


def _frame(read: Sequence[Tuple[str, DrivePhotos]]) -> str:
    """That all drives are in."""
    (first, drive), *others = read
    for bag, other in others:
        if other.frame != drive.frame:
            raise ValueError(f"{bag}: its poses are in '{other.frame}', those of {first} in '{drive.frame}'")
    return drive.frame


def _overview(options: argparse.Namespace, frame: str, drives: Sequence[DrivePhotos]) -> OverviewPicture:
    if options.map_yaml:
        return map_server_picture(options.output.parent, options.map_yaml, frame)
    image, place = draw_paths([path for drive in drives for path in drive.paths], frame, options.margin)
    return drawn_picture(f"{options.output.stem}.png", image, place)


def _metric(path: Path, place_map: PlaceMap, frame: str) -> MetricFrame:
    place = place_map.georeference
    if not isinstance(place, MetricFrame):
        raise ValueError(f"{path}: says nothing of a tf frame, so no pose can be placed in it")
    if place.frame != frame:
        raise ValueError(f"{path}: is in '{place.frame}', the poses of the drive are in '{frame}'")
    return place


def _by_name(drives: Sequence[DrivePhotos]) -> Dict[str, DrivePhoto]:
    photos: Dict[str, DrivePhoto] = {}
    for photo in (photo for drive in drives for photo in drive.photos):
        if photo.name in photos:
            raise ValueError(f"two bags would write {photo.name}; rename one of them")
        photos[photo.name] = photo
    return photos


def _new_photo(place_map: PlaceMap, place: MetricFrame, photo: DrivePhoto) -> NewPhoto:
    x, y = place.pixel(place_map.overview, *photo.position)
    return NewPhoto(photo.name, x, y, None if photo.yaw is None else place.photo_yaw(photo.yaw))


def _told(left_out: Dict[str, str]) -> List[str]:
    return [f"{name}: {why}" for name, why in left_out.items()]
