# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pictures whose places are known, to measure how well a map of places tells them."""

import csv
from pathlib import Path
from typing import Dict, FrozenSet, Iterator, List, NamedTuple, Optional, Tuple

import numpy as np

from sextant.place_maps.place_map import Photo, PlaceMap
from sextant.places.place_belief import PlaceBelief
from sextant.places.place_estimate import scale_of

Position = Tuple[float, float]  # pixels of the overview
COLUMNS = ("query", "right_refs")
TOLERANCE = 2.0  # spacings of places


class Query(NamedTuple):
    """A picture, and what is true of it."""

    path: Path
    right: FrozenSet[Position]  # places that are right answers; empty: it is nowhere that the map knows
    position: Optional[Position] = None  # where it was taken; None: nobody knows


def pixels_of(place_map: PlaceMap) -> np.ndarray:
    """(2,) units a pixel of the overview along x and y: metres, or where nobody knows them pixels."""
    return np.array(scale_of(place_map) or (1.0, 1.0))


def default_tolerance(place_map: PlaceMap) -> float:
    """Metres, or pixels where the map has no scale.

    :raises ValueError: there is no photo
    """
    if not place_map.photos:
        raise ValueError("there is no photo in the map")
    return TOLERANCE * PlaceBelief(_positions(place_map) * pixels_of(place_map)).spacing


def places_near(place_map: PlaceMap, position: Position, tolerance: float) -> FrozenSet[Position]:
    """:param tolerance: metres, or pixels where the map has no scale"""
    if not place_map.photos:
        return frozenset()
    positions = _positions(place_map)
    away = np.linalg.norm((positions - position) * pixels_of(place_map), axis=1)
    return frozenset((float(x), float(y)) for x, y in positions[away <= tolerance])


def queries_of_map(place_map: PlaceMap, other: PlaceMap, tolerance: float) -> List[Query]:
    """The photos of another map on the same overview, in its order.

    :raises ValueError: the overviews differ
    """
    size, of_other = (each.overview[1:] for each in (place_map, other))
    if size != of_other or place_map.georeference != other.georeference:
        raise ValueError("the queries lie on another overview: its size or where it lies differ")
    return [
        Query(other.path(photo), places_near(place_map, (photo.x, photo.y), tolerance), (photo.x, photo.y))
        for photo in other.photos
    ]


def queries_of_table(place_map: PlaceMap, path: Path, folder: Path) -> List[Query]:
    """Of a CSV with the columns query and right_refs: photos of the map with blanks between; none: nowhere.

    :param folder: of the queries
    :raises OSError: it cannot be read
    :raises ValueError: "file:line: reason"
    """
    places = {photo.image: (photo.x, photo.y) for photo in place_map.photos}
    with open(path, newline="", encoding="utf-8-sig") as file:
        rows = csv.DictReader(file)
        try:
            if not set(COLUMNS) <= set(rows.fieldnames or ()):
                raise ValueError(f"the columns have to be {','.join(COLUMNS)}")
            return [_row_query(row, places, folder) for row in rows]
        except (ValueError, csv.Error) as error:
            raise ValueError(f"{path}:{max(rows.line_num, 1)}: {error}") from None


def _row_query(row: Dict[str, Optional[str]], places: Dict[str, Position], folder: Path) -> Query:
    name, references = ((row[column] or "").strip() for column in COLUMNS)
    if not name:
        raise ValueError("there is no query")
    lacking = [image for image in references.split() if image not in places]
    if lacking:
        raise ValueError(f"{lacking[0]} is no photo of the map")
    return Query(folder / name, frozenset(places[image] for image in references.split()))


def left_out_queries(place_map: PlaceMap, tolerance: float) -> Iterator[Tuple[Photo, PlaceMap, Query]]:
    """Every photo, the map without it, and the photo as a query to that."""
    for photo in place_map.photos:
        others = place_map._replace(photos=tuple(p for p in place_map.photos if p.image != photo.image))
        position = photo.x, photo.y
        yield photo, others, Query(place_map.path(photo), places_near(others, position, tolerance), position)


def _positions(place_map: PlaceMap) -> np.ndarray:
    """(places, 2)"""
    return np.array([(photos[0].x, photos[0].y) for photos in place_map.places()])
