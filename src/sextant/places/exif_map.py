# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A map of photos whose EXIF says where they were taken."""

import math
from pathlib import Path
from typing import Dict, List, NamedTuple, Sequence, Tuple

from sextant.places.photo_file import SUFFIXES, GeoPosition, geo_position
from sextant.places.place_map import GeoCorners, Overview, Photo, PlaceMap, check_photo

METRES_A_DEGREE = 111_320.0  # of latitude, within half a percent everywhere


class ExifMap(NamedTuple):
    """The map, and photos that are not in it, each with the reason."""

    place_map: PlaceMap
    left_out: Dict[Path, str]


def find_photos(folder: Path) -> List[Path]:
    """The pictures in a folder and those below it, sorted by name."""
    return sorted(path for path in folder.rglob("*") if path.suffix.lower() in SUFFIXES and path.is_file())


def positions_of(photos: Sequence[Path]) -> Tuple[Dict[Path, GeoPosition], Dict[Path, str]]:
    """Where photos were taken, and of the others why that is not known."""
    positions: Dict[Path, GeoPosition] = {}
    unknown: Dict[Path, str] = {}
    for path in photos:
        try:
            position = geo_position(path)
        except (OSError, ValueError) as error:
            unknown[path] = str(error)
            continue
        if position is None:
            unknown[path] = f"{path}: its EXIF does not say where it was taken"
        else:
            positions[path] = position
    return positions, unknown


def exif_map(folder: Path, photos: Sequence[Path], overview: Overview, corners: GeoCorners) -> ExifMap:
    """A map in a folder of photos there or below, with ids from 0 on in their order."""
    positions, left_out = positions_of(photos)
    placed: List[Photo] = []
    for path, position in positions.items():
        x, y = corners.pixel(overview, position.latitude, position.longitude)
        photo = Photo(len(placed), path.relative_to(folder).as_posix(), x, y, position.yaw)
        try:
            check_photo(overview, photo)
        except ValueError as error:
            left_out[path] = f"{path}: {error}"
            continue
        placed.append(photo)
    return ExifMap(PlaceMap(folder, overview, tuple(placed), corners), left_out)


def corners_around(positions: Sequence[GeoPosition], margin: float) -> GeoCorners:
    """Those of an overview that shows all positions, and margin metres around them.

    :raises ValueError: there is no position
    """
    if not positions:
        raise ValueError("no photo says where it was taken")
    latitudes = [position.latitude for position in positions]
    longitudes = [position.longitude for position in positions]
    up = margin / METRES_A_DEGREE
    right = up / math.cos(math.radians(sum(latitudes) / len(latitudes)))
    return GeoCorners(
        (max(latitudes) + up, min(longitudes) - right), (min(latitudes) - up, max(longitudes) + right)
    )


def extent(corners: GeoCorners) -> Tuple[float, float]:
    """Metres from west to east, and from south to north, between corners."""
    (north, west), (south, east) = corners
    up = (north - south) * METRES_A_DEGREE
    return (east - west) * METRES_A_DEGREE * math.cos(math.radians((north + south) / 2)), up
