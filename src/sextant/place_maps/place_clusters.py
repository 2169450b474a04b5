# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Merges the places of a map into clusters of successive places."""

from sextant.place_maps.place_map import PlaceMap


def clustered(place_map: PlaceMap, count: int) -> PlaceMap:
    """Merges successive places into clusters; all photos of a cluster get the position of its middle place.

    :param count: number of clusters
    :raises ValueError: count is below 1 or above the number of places
    """
    places = place_map.places()
    if not 1 <= count <= len(places):
        raise ValueError(
            f"{len(places)} places cannot be divided into {count} clusters, allowed is [1, {len(places)}]"
        )
    bounds = [round(cluster * len(places) / count) for cluster in range(count + 1)]
    position = {}
    for begin, end in zip(bounds, bounds[1:]):
        x, y = places[(begin + end) // 2][0][2:4]
        position.update({photo.id: (x, y) for place in places[begin:end] for photo in place})
    photos = (photo._replace(x=position[photo.id][0], y=position[photo.id][1]) for photo in place_map.photos)
    return place_map._replace(photos=tuple(photos))
