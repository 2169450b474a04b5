# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Query images with known places, for the evaluation of a place map."""

import csv
from pathlib import Path
from typing import Dict, FrozenSet, Iterator, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from sextant.place_maps.place_map import Photo, PlaceMap
from sextant.places.place_estimate import scale_of
from sextant.places.place_spacing import spacing_of
from sextant.places.rough_pose import RoughPose

Position = Tuple[float, float]  # pixels of the overview
COLUMNS = ("query", "right_refs")
TOLERANCE = 2.0  # default tolerance, in spacings (glossary: median distance between neighbouring places)


class Query(NamedTuple):
    """An image with its ground truth."""

    path: Path  # image file
    true_places: FrozenSet[Position]  # correct places; empty: the query is not in the map
    position: Optional[Position] = None  # where it was taken; None: unknown
    rough: Optional[RoughPose] = None  # of the camera

    def distance(self, position: Position, pixels: np.ndarray) -> float:
        """Distance of a position from that of the query; if this is unknown, from the nearest correct place.

        :param pixels: (2,) metres per pixel along x and y
        :returns: in the unit of pixels; nan if neither is known
        """
        truth = [self.position] if self.position else list(self.true_places)
        distances = np.linalg.norm((np.array(truth).reshape(-1, 2) - position) * pixels, axis=1)
        return float(distances.min()) if len(distances) else np.nan


def metres_per_pixel(place_map: PlaceMap) -> np.ndarray:
    """Metres per pixel of the overview along x and y, (2,); (1, 1) if the map has no scale."""
    return np.array(scale_of(place_map) or (1.0, 1.0))


def default_tolerance(place_map: PlaceMap) -> float:
    """Maximum distance of a correct place: metres, or pixels if the map has no scale.

    :raises ValueError: the map has no photos
    """
    if not place_map.photos:
        raise ValueError("the map has no photos")
    return TOLERANCE * spacing_of(place_map.positions() * metres_per_pixel(place_map))


def default_distances(place_map: PlaceMap, has_table: bool) -> List[float]:
    """Distances of correct hypotheses that a comparison counts: metres, or pixels if the map has no scale.

    :param has_table: whether the positions of the queries are unknown: then 0 is a correct photo of the table
    """
    spacing = spacing_of(place_map.positions() * metres_per_pixel(place_map))
    return [float(f"{number * spacing:.2g}") for number in ((0, 1, 2) if has_table else (1, 2, 4))]


def places_near(place_map: PlaceMap, position: Position, tolerance: float) -> FrozenSet[Position]:
    """Places within a distance of a position.

    :param tolerance: metres, or pixels if the map has no scale
    """
    positions = place_map.positions()
    distances = np.linalg.norm((positions - position) * metres_per_pixel(place_map), axis=1)
    return frozenset((float(x), float(y)) for x, y in positions[distances <= tolerance])


def queries_of_map(place_map: PlaceMap, other: PlaceMap, tolerance: float) -> List[Query]:
    """The photos of another map as queries, in its order; both maps have the same overview.

    :param tolerance: see places_near()
    :raises ValueError: the overviews differ
    """
    size, other_size = ((each.overview.width, each.overview.height) for each in (place_map, other))
    if size != other_size or place_map.georeference != other.georeference:
        raise ValueError("the map of the queries has another overview: its size or position differs")
    return [
        Query(other.path(photo), places_near(place_map, (photo.x, photo.y), tolerance), (photo.x, photo.y))
        for photo in other.photos
    ]


def queries_of_table(place_map: PlaceMap, path: Path, folder: Path) -> List[Query]:
    """Reads a CSV file with the columns query and right_refs.

    query: file name. right_refs: file names of the map's photos that are correct answers, separated by
    blanks; empty: the query is not in the map.

    :param folder: of the query images
    :raises OSError: the CSV file cannot be read
    :raises ValueError: "file:line: reason"
    """
    places = {photo.image: (photo.x, photo.y) for photo in place_map.photos}
    with open(path, newline="", encoding="utf-8-sig") as file:
        rows = csv.DictReader(file)
        try:
            if not set(COLUMNS) <= set(rows.fieldnames or ()):
                raise ValueError(f"the columns must be {','.join(COLUMNS)}")
            return [_row_query(row, places, folder) for row in rows]
        except (ValueError, csv.Error) as error:
            raise ValueError(f"{path}:{max(rows.line_num, 1)}: {error}") from None


def _row_query(row: Dict[str, Optional[str]], places: Dict[str, Position], folder: Path) -> Query:
    name, references = ((row[column] or "").strip() for column in COLUMNS)
    if not name:
        raise ValueError("the query is missing")
    missing = [image for image in references.split() if image not in places]
    if missing:
        raise ValueError(f"{missing[0]} is not a photo of the map")
    return Query(folder / name, frozenset(places[image] for image in references.split()))


def queries_of_photos(place_map: PlaceMap) -> List[Query]:
    """The photos of a map as queries of their own places, in its order."""
    return [
        Query(place_map.path(photo), frozenset([(photo.x, photo.y)]), (photo.x, photo.y))
        for photo in place_map.photos
    ]


def leave_one_out_queries(
    place_map: PlaceMap, tolerance: float, clusters: Optional[PlaceMap] = None
) -> Iterator[Tuple[Photo, PlaceMap, Query]]:
    """Yields each photo, the map without it, and the photo as a query.

    :param clusters: if set, the map without the photo is one of these, see queries_in_clusters()
    """
    for photo in place_map.photos:
        position, others = (photo.x, photo.y), _without(place_map, photo)
        true_places = places_near(others, position, tolerance)
        query = Query(place_map.path(photo), true_places, position)
        if clusters:
            (query,), others = queries_in_clusters([query], place_map, clusters), _without(clusters, photo)
        yield photo, others, query


def _without(place_map: PlaceMap, photo: Photo) -> PlaceMap:
    return place_map._replace(photos=tuple(each for each in place_map.photos if each.image != photo.image))


def queries_in_clusters(queries: Sequence[Query], place_map: PlaceMap, clusters: PlaceMap) -> List[Query]:
    """The queries for a map of clusters: correct are the clusters of the correct places.

    :param place_map: map of the queries' places
    :param clusters: the same map with its places merged, see sextant.place_maps.place_clusters
    """
    pairs = zip(place_map.photos, clusters.photos)
    cluster_of = {(photo.x, photo.y): (merged.x, merged.y) for photo, merged in pairs}
    return [
        query._replace(true_places=frozenset(cluster_of[place] for place in query.true_places))
        for query in queries
    ]
