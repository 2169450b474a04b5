# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A map of photos whose EXIF says where they were taken."""

import math
from pathlib import Path
from typing import Dict, List, NamedTuple, Sequence, Tuple

from sextant.place_maps.map_addition import NewPhoto, add_photos
from sextant.place_maps.photo_file import SUFFIXES, GeoPosition, geo_position
from sextant.place_maps.place_map import GeoCorners, PlaceMap, image_in

METRES_A_DEGREE = 111_320.0  # of latitude, within half a percent everywhere
DIGITS = 7  # of a degree, that drawn corners are rounded to: a centimetre


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


def exif_map(place_map: PlaceMap, photos: Sequence[Path]) -> ExifMap:
    """A map whose corners are known, with photos of its folder, or of those below, added in their order.

    :raises ValueError: the map has no corners, or a photo lies elsewhere
    """
    if not isinstance(place_map.georeference, GeoCorners):
        raise ValueError("where the overview's corners lie on the earth is not known")
    files = {_image(place_map.folder, path): path for path in photos}
    positions, left_out = positions_of(photos)
    found = []
    for image, path in files.items():
        if path in positions:
            position = positions[path]
            x, y = place_map.georeference.pixel(place_map.overview, position.latitude, position.longitude)
            found.append(NewPhoto(image, x, y, position.yaw))
    added = add_photos(place_map, found)
    left_out.update({files[image]: f"{files[image]}: {why}" for image, why in added.left_out.items()})
    return ExifMap(added.place_map, left_out)


def _image(folder: Path, path: Path) -> str:
    image = image_in(folder, path)
    if image is None:
        raise ValueError(f"{path}: photos have to lie in {folder}, that of the map, or below")
    return image


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
    north, west = max(latitudes) + up, min(longitudes) - right
    south, east = min(latitudes) - up, max(longitudes) + right
    return GeoCorners(
        (round(north, DIGITS), round(west, DIGITS)), (round(south, DIGITS), round(east, DIGITS))
    )


def extent(corners: GeoCorners) -> Tuple[float, float]:
    """Metres from west to east, and from south to north, between corners."""
    (north, west), (south, east) = corners
    up = (north - south) * METRES_A_DEGREE
    return (east - west) * METRES_A_DEGREE * math.cos(math.radians((north + south) / 2)), up
