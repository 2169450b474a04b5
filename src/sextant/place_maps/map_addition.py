# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Photos that are added to a map: their ids, and the places that they share with others."""

import math
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

from sextant.place_maps.place_map import Photo, PlaceMap, check_photo

DIGITS, YAW_DIGITS = 2, 4  # of a pixel and of a radian, that positions are rounded to

Position = Tuple[float, float]  # pixels of the overview


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
    places = _Places(merge)
    for place in place_map.places():
        places.add((place[0].x, place[0].y))
    first = place_map.next_id()
    added: List[Photo] = []
    left_out: Dict[str, str] = {}
    for new in photos:
        position = round(new.x, DIGITS), round(new.y, DIGITS)
        x, y = places.nearest(position)
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
            places.add(position)
        known.add(new.image)
        added.append(photo)
    return MapAddition(place_map._replace(photos=(*place_map.photos, *added)), left_out)


class _Places:
    """Positions in squares, so that of many only those near by are looked at."""

    def __init__(self, merge: float):
        self._merge = merge
        self._side = 2 * merge  # what is within merge is in this square or in one beside it, rounded or not
        self._squares: Dict[Position, Dict[Position, int]] = {}  # number of each in the order of coming
        self._count = 0

    def add(self, position: Position) -> None:
        if self._merge > 0:
            self._squares.setdefault(self._square(*position), {}).setdefault(position, self._count)
            self._count += 1

    def nearest(self, position: Position) -> Position:
        """The nearest within merge, of several the first; or the position itself."""
        if self._merge <= 0:
            return position
        column, row = self._square(*position)
        beside = ((column + i, row + j) for i in (-1, 0, 1) for j in (-1, 0, 1))
        near = [
            (math.dist(place, position), number, place)
            for square in beside
            for place, number in self._squares.get(square, {}).items()
        ]
        distance, _, place = min(near, default=(math.inf, 0, position))
        return place if distance <= self._merge else position

    def _square(self, x: float, y: float) -> Position:
        return x // self._side, y // self._side  # nan where one is not finite: a square without a place
