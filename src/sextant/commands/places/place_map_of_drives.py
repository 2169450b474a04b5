# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes a place map from bags of drives with known poses: by tf, or by a topic of poses.

    make_place_map drive hall.bag -o hall/map.txt                          by tf from map to base_link
    make_place_map drive hall.bag -o hall/map.txt --pose /marker_locator/pose
    make_place_map drive hall.bag -o hall/map.txt --depth /camera/depth/image_raw
    make_place_map drive *.bag -o hall/map.txt --map-yaml floor.yaml       on the map of map_server
    make_place_map drive evening.bag -o hall/map.txt --add                 more photos of the same places

Photos are written to the map's folder, and their poses beside the map if the bags have camera_info. With
depth images, metric poses use their points, too, also where there is little parallax.
Without --map-yaml an overview with the paths is drawn.
"""

import argparse
import functools
import math
import os
from collections import Counter
from pathlib import Path
from typing import Dict, Iterable, Iterator, List, Optional, Sequence, Tuple

import numpy as np

from sextant.bags.drive_photos import DrivePhoto, DrivePhotos, PhotoParams, read_drive_photos
from sextant.commands.bag_options import add_job_options, add_mount_options, read_bags, read_mounts
from sextant.commands.command_line import Answer, CommandParser
from sextant.commands.places.place_map_output import add_output_options, existing_map, write_map
from sextant.images.photo_depth import depth_path
from sextant.place_maps.overview import draw_paths
from sextant.place_maps.overview_image import OverviewImage, drawn_overview, overview_from_map_server
from sextant.place_maps.photo_poses import PhotoPoses, PosedPhoto, poses_path, read_photo_poses
from sextant.place_maps.place_map import MetricFrame, PlaceMap
from sextant.place_maps.place_map_addition import NewPhoto, add_photos

MARGIN = 3.0  # metres
# Relative to --distance: photos of another pass are at most half of it off along the path, which leaves some
# for the lateral offset; photos of one pass are at least nine tenths apart.
MERGE = 0.75


def parser() -> CommandParser:
    """Parser of `make_place_map drive`."""
    result = CommandParser(prog="make_place_map drive", description=__doc__)
    result.add_argument("bags", nargs="+", metavar="BAG", help="with images and poses")
    add_output_options(result)
    begin = result.add_mutually_exclusive_group().add_argument
    begin("--add", action="store_true", help="add to the existing map, on its overview")
    begin("--map-yaml", type=Path, metavar="YAML", help="map_server map whose image is the overview")
    text = "around the paths of a drawn overview (default: %(default)s)"
    begin("--margin", type=float, default=MARGIN, metavar="METRES", help=text)
    add_photo_options(result.add_argument_group("which photos"))
    _add_poses(result.add_argument_group("poses"))
    bags = result.add_argument_group("bags")
    add_image_options(bags)
    bags.add_argument("--every", type=int, default=1, metavar="N", help="use every n-th image")
    add_job_options(bags)
    return result


def add_photo_options(group) -> None:
    """Adds the options of the selection of photos."""
    add, distance, turn = group.add_argument, PhotoParams.distance, round(math.degrees(PhotoParams.turn))
    text = "between photos (default: %(default)s)"
    add("--distance", type=float, default=distance, metavar="METRES", help=text)
    text = "rotation between photos (default: %(default)s)"
    add("--turn", type=float, default=turn, metavar="DEGREES", help=text)
    text = f"a photo within this distance of a place is added to it (default: {MERGE:g} of --distance)"
    add("--merge", type=float, metavar="METRES", help=text)


def add_image_options(group) -> None:
    """Adds the options of the topics of images and depth."""
    add = group.add_argument
    add("--image", default="", metavar="TOPIC", help="image topic (default: the only one)")
    text = "depth images with camera_info beside them, aligned with the images or with tf (default: none)"
    add("--depth", default="", metavar="TOPIC", help=text)
    text = "factor that corrects the depths; estimate_depth_scale estimates it (default: %(default)s)"
    add("--depth-scale", type=float, default=1.0, metavar="FACTOR", help=text)


def _add_poses(group) -> None:
    group.add_argument("--frame", default="", help=f"frame of tf poses (default: {PhotoParams.frame})")
    group.add_argument("--pose", default="", metavar="TOPIC", help="poses of the base instead of tf")
    add_mount_options(group)


def make(options: argparse.Namespace) -> Answer:
    """Reads the bags and writes their map.

    :raises OSError, ValueError, RuntimeError: an option or a bag is invalid; no map was written
    """
    base_map = existing_map(options)
    check(options)
    reading = functools.partial(read_drive_photos, params=photo_params(options))
    read, notes = read_bags(reading, options.bags, options)
    return write_photos(options, read, notes, base_map)


def write_photos(
    options: argparse.Namespace,
    read: Sequence[Tuple[str, DrivePhotos]],
    notes: List[str],
    base_map: Optional[PlaceMap] = None,
) -> Answer:
    """Makes the map of the drives that were read, and writes it.

    :param read: (bag, drive)
    :param base_map: that is extended; None: a new one
    :raises OSError, ValueError: no map was written
    """
    drives = [drive for _, drive in read]
    frame, files = _frame(read), {}
    if base_map is None:
        overview = _overview(options, frame, drives)
        base_map, files = overview.empty_map(options.output.parent), overview.files
    place = _metric(options.output, base_map, frame)
    photos = _by_name(drives)
    known = [photo.image for photo in base_map.photos if photos.pop(photo.image, None)]
    notes = [*notes, *([f"{len(known)} photos of these drives are already in the map"] if known else [])]
    found = [_new_photo(base_map, place, photo) for photo in photos.values()]
    made, left_out = add_photos(base_map, found, _merge(options) / place.resolution)
    reasons = list(map(": ".join, left_out.items()))
    if not made.photos:
        raise ValueError(f"no photo can be placed: {reasons[0]} (the first of {len(reasons)} reasons)")
    files.update(_files(photo for name, photo in photos.items() if name not in left_out))
    return write_map(options, made, files, reasons, notes, _poses(options, made, drives))


def check(options: argparse.Namespace) -> None:
    """Checks the options before any bag is read. :raises ValueError: one is invalid, or a bag a duplicate"""
    if options.pose and options.frame:
        raise ValueError("--frame cannot be used with --pose: the poses have a frame")
    if not 0 < options.margin < np.inf:
        raise ValueError(f"--margin is {options.margin:g}, it must be above 0 metres")
    if options.merge is not None and not 0 <= options.merge < np.inf:
        raise ValueError(f"--merge is {options.merge:g}, it must be at least 0 metres")
    if not 0 < options.turn <= 360:
        raise ValueError(f"--turn is {options.turn:g}, allowed is (0, 360] degrees")
    again = [bag for bag, count in Counter(map(os.path.realpath, options.bags)).items() if count > 1]
    if again:
        raise ValueError(f"{again[0]}: duplicate bag")


def _merge(options: argparse.Namespace) -> float:
    return MERGE * options.distance if options.merge is None else options.merge


def photo_params(options: argparse.Namespace) -> PhotoParams:
    """Returns the parameters of the selection of photos. :raises ValueError: one is out of range"""
    return PhotoParams(
        options.image, options.depth, options.depth_scale, options.pose,
        options.frame or PhotoParams.frame, options.distance, math.radians(options.turn), options.every,
        options.base_frame, read_mounts(options.mounts),
    )  # fmt: skip


def _frame(read: Sequence[Tuple[str, DrivePhotos]]) -> str:
    """Common frame of the drives."""
    (first, drive), *others = read
    for bag, other in others:
        if other.frame != drive.frame:
            raise ValueError(f"{bag}: its poses are in '{other.frame}', those of {first} in '{drive.frame}'")
    return drive.frame


def _overview(options: argparse.Namespace, frame: str, drives: Sequence[DrivePhotos]) -> OverviewImage:
    if options.map_yaml:
        return overview_from_map_server(options.output.parent, options.map_yaml, frame)
    image, place = draw_paths([path for drive in drives for path in drive.paths], frame, options.margin)
    return drawn_overview(f"{options.output.stem}.png", image, place)


def _metric(path: Path, place_map: PlaceMap, frame: str) -> MetricFrame:
    place = place_map.georeference
    if not isinstance(place, MetricFrame):
        raise ValueError(f"{path}: has no tf frame, so poses cannot be placed in it")
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


def _files(photos: Iterable[DrivePhoto]) -> Iterator[Tuple[str, bytes]]:
    """Names and contents of the files of photos."""
    for photo in photos:
        yield photo.name, photo.jpeg
        if photo.depth is not None:
            yield depth_path(Path(photo.name)).name, photo.depth


def _poses(options: argparse.Namespace, place_map: PlaceMap, drives: Sequence[DrivePhotos]) -> PhotoPoses:
    """Poses of the photos in the map: those of the drives with a calibrated camera, and the earlier ones."""
    path = poses_path(options.output)
    photos = {
        photo.name: PosedPhoto(drive.camera, photo.T_map_camera)
        for drive in drives
        if drive.camera
        for photo in drive.photos
    }
    if options.add and path.exists():
        photos.update(read_photo_poses(path).photos)
    images = {photo.image for photo in place_map.photos}
    known = {image: photo for image, photo in photos.items() if image in images}
    return PhotoPoses(place_map.georeference.frame, known)


def _new_photo(place_map: PlaceMap, place: MetricFrame, photo: DrivePhoto) -> NewPhoto:
    x, y = place.pixel(place_map.overview, *photo.position)
    return NewPhoto(photo.name, x, y, None if photo.yaw is None else place.photo_yaw(photo.yaw))
