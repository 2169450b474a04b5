# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes a place map from photos with GPS positions in their EXIF data."""

import math
from pathlib import Path
from typing import Dict, Sequence, Tuple

from sextant.images.photo_file import GeoPosition, geo_position
from sextant.place_maps.place_map import METRES_PER_DEGREE, GeoCorners, PlaceMap, image_in
from sextant.place_maps.place_map_addition import NewPhoto, add_photos

DIGITS = 7  # decimals of the corners of drawn overviews, degrees: a centimetre


def positions_of(photos: Sequence[Path]) -> Tuple[Dict[Path, GeoPosition], Dict[Path, str]]:
    """Positions of photos from their EXIF data, and the reason for each photo without one."""
    positions: Dict[Path, GeoPosition] = {}
    unknown: Dict[Path, str] = {}
    for path in photos:
        try:
            position = geo_position(path)
            if position is None:
                raise ValueError(f"{path}: its EXIF has no GPS position")
            positions[path] = position
        except (OSError, ValueError) as error:
            unknown[path] = str(error)
    return positions, unknown


def exif_map(place_map: PlaceMap, photos: Sequence[Path]) -> Tuple[PlaceMap, Dict[Path, str]]:
    """Adds photos in the map's folder or its subfolders to a georeferenced map.

    :returns: the map, and the reason for each photo that was not added
    :raises ValueError: the map is not georeferenced, or a photo is outside of its folder
    """
    if not isinstance(place_map.georeference, GeoCorners):
        raise ValueError("the geographic coordinates of the overview's corners are unknown")
    files = {_image(place_map.folder, path): path for path in photos}
    positions, left_out = positions_of(photos)
    new_photos = []
    for image, path in files.items():
        if path in positions:
            position = positions[path]
            x, y = place_map.georeference.pixel(place_map.overview, position.latitude, position.longitude)
            new_photos.append(NewPhoto(image, x, y, position.yaw))
    made, reasons = add_photos(place_map, new_photos)
    left_out.update({files[image]: f"{files[image]}: {why}" for image, why in reasons.items()})
    return made, left_out


def _image(folder: Path, path: Path) -> str:
    image = image_in(folder, path)
    if image is None:
        raise ValueError(f"{path}: photos must be in the map's folder {folder} or below")
    return image


def corners_around(positions: Sequence[GeoPosition], margin: float) -> GeoCorners:
    """Corners of an overview that contains all positions with a margin in metres.

    :raises ValueError: there is no position
    """
    if not positions:
        raise ValueError("no photo has a GPS position")
    latitudes = [position.latitude for position in positions]
    longitudes = [position.longitude for position in positions]
    up = margin / METRES_PER_DEGREE
    right = up / math.cos(math.radians(sum(latitudes) / len(latitudes)))
    north, west = max(latitudes) + up, min(longitudes) - right
    south, east = min(latitudes) - up, max(longitudes) + right
    return GeoCorners(
        (round(north, DIGITS), round(west, DIGITS)), (round(south, DIGITS), round(east, DIGITS))
    )
