# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Adds photos to a map: assigns ids and merges nearby positions into places."""

import math
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from sextant.place_maps.place_map import Photo, PlaceMap, check_photo

DIGITS, YAW_DIGITS = 2, 4  # decimals of positions in pixels and of yaws in radians

Position = Tuple[float, float]  # pixels of the overview


class NewPhoto(NamedTuple):
    """A photo that has no id yet, otherwise as Photo."""

    image: str  # file, relative to the map's folder, with /
    x: float  # pixels of the overview
    y: float  # pixels of the overview
    yaw: Optional[float] = None  # radians; None: unknown


def add_photos(
    place_map: PlaceMap, photos: Sequence[NewPhoto], merge: float = 0.0
) -> Tuple[PlaceMap, Dict[str, str]]:
    """Adds photos to a map; existing photos are unchanged.

    :param merge: pixels; a photo within this distance of a place, whatever its yaw, is added to that place
        and takes its position
    :returns: the map, and the reason for each photo that was not added, by image
    """
    known = {photo.image for photo in place_map.photos}
    places = place_map.positions()
    first = place_map.next_id()
    added: List[Photo] = []
    left_out: Dict[str, str] = {}
    for new in photos:
        position = round(new.x, DIGITS), round(new.y, DIGITS)
        x, y = _nearest(places, position, merge)
        yaw = None if new.yaw is None else round(new.yaw, YAW_DIGITS)
        photo = Photo(first + len(added), new.image, x, y, yaw)
        try:
            if new.image in known:
                raise ValueError("is already in the map")
            check_photo(place_map.overview, photo)
        except ValueError as error:
            left_out[new.image] = str(error)
            continue
        if (x, y) == position:
            places = np.vstack([places, position])
        known.add(new.image)
        added.append(photo)
    return place_map._replace(photos=(*place_map.photos, *added)), left_out


def _nearest(places: np.ndarray, position: Position, merge: float) -> Position:
    """The nearest of the places (n, 2) if it is within merge pixels; otherwise the position."""
    if merge > 0 and len(places):
        x, y = places[np.hypot(*(places - position).T).argmin()].tolist()
        if math.dist((x, y), position) <= merge:
            return x, y
    return position
