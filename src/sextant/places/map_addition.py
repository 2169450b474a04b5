# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Photos that are added to a map: their ids, and the places that they share with others."""

from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from sextant.places.place_map import Photo, PlaceMap, check_photo

DIGITS, YAW_DIGITS = 2, 4  # of a pixel and of a radian, that positions are rounded to


class NewPhoto(NamedTuple):
    """A photo without an id; the fields are those of Photo."""

    image: str
    x: float
    y: float
    yaw: Optional[float] = None


class MapAddition(NamedTuple):
    """The map with what was added, and why other photos were not, by image."""

    place_map: PlaceMap
    left_out: Dict[str, str]


def add_photos(place_map: PlaceMap, photos: Sequence[NewPhoto], merge: float = 0.0) -> MapAddition:
    """A map with more photos; those that it has already stay as they are.

    :param merge: pixels; a photo this near to a place is one more picture of it, whichever way it looks: it
        takes the position of the place's first photo. So places never wander
    """
    known = {photo.image for photo in place_map.photos}
    places = [(place[0].x, place[0].y) for place in place_map.places()]
    first = place_map.next_id()
    added: List[Photo] = []
    left_out: Dict[str, str] = {}
    for new in photos:
        position = round(new.x, DIGITS), round(new.y, DIGITS)
        x, y = _place(places, position, merge)
        photo = Photo(
            first + len(added),
            new.image,
            x,
            y,
            None if new.yaw is None else round(new.yaw, YAW_DIGITS),
        )
        try:
            if new.image in known:
                raise ValueError("is in the map already")
            check_photo(place_map.overview, photo)
        except ValueError as error:
            left_out[new.image] = str(error)
            continue
        if (x, y) == position:
            places.append(position)
        known.add(new.image)
        added.append(photo)
    return MapAddition(place_map._replace(photos=(*place_map.photos, *added)), left_out)


def _place(
    places: Sequence[Tuple[float, float]], position: Tuple[float, float], merge: float
) -> Tuple[float, float]:
    """The nearest place within merge, or the position itself."""
    if not places or merge <= 0:
        return position
    distances = np.linalg.norm(np.subtract(places, position), axis=1)
    nearest = int(np.argmin(distances))
    return places[nearest] if distances[nearest] <= merge else position
