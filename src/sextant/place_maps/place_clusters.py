# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A coarser map of the same photos: parts of the way in place of exact positions."""

from sextant.place_maps.place_map import PlaceMap


def clustered(place_map: PlaceMap, count: int) -> PlaceMap:
    """A map that has successive places in one, that in their middle. Ids and photos stay.

    :param count: of the parts that the places are divided into, in the order of the map
    :raises ValueError: there are not as many places
    """
    places = place_map.places()
    if not 1 <= count <= len(places):
        raise ValueError(f"{len(places)} places cannot be {count} parts, allowed is [1, {len(places)}]")
    bounds = [round(part * len(places) / count) for part in range(count + 1)]
    position = {}
    for begin, end in zip(bounds, bounds[1:]):
        x, y = places[(begin + end) // 2][0][2:4]
        position.update({photo.id: (x, y) for place in places[begin:end] for photo in place})
    photos = (photo._replace(x=position[photo.id][0], y=position[photo.id][1]) for photo in place_map.photos)
    return place_map._replace(photos=tuple(photos))
