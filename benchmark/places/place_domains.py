# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Maps and queries of the external test data: a campus, a tower, a corridor and a street."""

import csv
from pathlib import Path
from typing import Dict, List, NamedTuple, Optional, Sequence

from sextant.images.photo_file import find_photos
from sextant.place_maps.exif_map import corners_around, exif_map, positions_of
from sextant.place_maps.place_map import Overview, Photo, PlaceMap
from sextant.places.place_queries import Query, leave_one_out_queries, queries_of_table

STEP = 10.0  # pixels from one photo of the corridor or of a floor to the next
APART = 1000.0  # pixels between the spots of the campus, and between the floors of the tower
NEAR, MARGIN, SCALE = 15.0, 20.0, 10.0  # tolerance, m; margin around the photos, m; pixels per metre


class QuerySet(NamedTuple):
    """Queries to a map, in the order of a walk."""

    domain: str  # campus, tower, ...
    name: str  # of the map and the walk
    place_map: PlaceMap
    queries: Sequence[Query]


def campus(data: Path) -> List[QuerySet]:
    """Five spots: for each month a map of its photos, and the photos of all other months as queries."""
    photos = find_photos(data / "campus_months")
    if not photos:
        raise FileNotFoundError(2, "there is no photo", str(data / "campus_months"))
    return [_month(photos, month) for month in sorted({photo.name[:2] for photo in photos})]


def _month(photos: Sequence[Path], month: str) -> QuerySet:
    spots: Dict[str, float] = {photo.name[2:4]: APART * int(photo.name[2:4]) for photo in photos}
    of_month = [photo for photo in photos if photo.name.startswith(month)]
    made = tuple(Photo(i, photo.name, spots[photo.name[2:4]], 0.0) for i, photo in enumerate(of_month))
    place_map = PlaceMap(photos[0].parent, Overview("none.png", int(APART * 10), 1), made)
    there = {photo.x for photo in made}
    queries = [
        Query(photo, frozenset([(spots[photo.name[2:4]], 0.0)]))
        for photo in photos
        if photo not in of_month and spots[photo.name[2:4]] in there
    ]
    return QuerySet("campus", f"campus{month}", place_map, queries)


def tower(data: Path) -> QuerySet:
    """Six nearly identical floors; each photo of the right floor is right."""
    folder, photos = data / "tower", []
    with open(folder / "truth.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    floors = sorted({row["floor"] for row in rows})
    heights = {floor: APART * number for number, floor in enumerate(floors)}
    steps = dict.fromkeys(floors, 0.0)
    for row in rows:
        if row["part"] == "gallery":
            photos.append(Photo(len(photos), row["file"], steps[row["floor"]], heights[row["floor"]]))
            steps[row["floor"]] += STEP
    of_floor = {
        floor: frozenset((photo.x, photo.y) for photo in photos if photo.y == height)
        for floor, height in heights.items()
    }
    queries = [Query(folder / row["file"], of_floor[row["floor"]]) for row in rows if row["part"] == "query"]
    overview = Overview("none.png", int(max(steps.values())) + 1, int(APART * len(floors)))
    return QuerySet("tower", "tower", PlaceMap(folder, overview, tuple(photos)), queries)


def corridor(data: Path) -> QuerySet:
    """A corridor walked twice."""
    folder = data / "corridor"
    place_map = corridor_map(folder)
    queries = queries_of_table(place_map, folder / "truth.csv", folder / "query")
    return QuerySet("corridor", "corridor", place_map, queries)


def corridor_map(corridor: Path) -> PlaceMap:
    """Map of the corridor: its reference photos on a line."""
    names = sorted(path.name for path in (corridor / "ref").iterdir())
    photos = tuple(Photo(i, name, STEP * i, 0.0) for i, name in enumerate(names))
    return PlaceMap(corridor / "ref", Overview("none.png", int(STEP * len(names)), 1), photos)


def lund(data: Path) -> List[QuerySet]:
    """A street whose photos have positions: each photo as the query to a map of the others."""
    place_map = lund_map(find_photos(data / "lund"))
    trials = leave_one_out_queries(place_map, NEAR)
    return [QuerySet("lund", photo.image, others, [query]) for photo, others, query in trials]


def lund_map(photos: Sequence[Path]) -> PlaceMap:
    """Map of the photos by their positions."""
    positions, _ = positions_of(photos)
    corners = corners_around(list(positions.values()), MARGIN)
    width, height = (int(SCALE * side) for side in corners.extent())
    empty = PlaceMap(photos[0].parent, Overview("none.png", width, height), (), corners)
    return exif_map(empty, photos)[0]


def part_of(place_map: PlaceMap, begin: int, end: Optional[int]) -> PlaceMap:
    """The map with the photos from begin up to, but not including, end."""
    return place_map._replace(photos=place_map.photos[begin:end])


def still_right(queries: Sequence[Query], place_map: PlaceMap) -> List[Query]:
    """The queries with only those true places that the map still contains."""
    there = {(photo.x, photo.y) for photo in place_map.photos}
    return [query._replace(true_places=query.true_places & there) for query in queries]
