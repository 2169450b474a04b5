# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Merges neighbouring places of a map into clusters: the parts of a park, or spots with several photos.

Complete linkage: the two clusters whose union has the smallest diameter are merged first.
"""

from typing import Dict, Tuple

import numpy as np
from scipy.cluster.hierarchy import cut_tree, fcluster, linkage

from sextant.place_maps.place_map import PlaceMap

MAX_PLACES = 10_000  # the distances of all pairs are held in memory, 8 bytes each
Scale = Tuple[float, float]  # metres per pixel along x and y


def clustered(place_map: PlaceMap, count: int, scale: Scale = (1.0, 1.0)) -> PlaceMap:
    """Merges places into clusters; all photos of a cluster get the position of its middle place.

    :param count: number of clusters
    :param scale: distances of the places, on which the clusters depend, are measured with it
    :raises ValueError: count is below 1 or above the number of places, or the map is too large
    """
    places = len(place_map.places())
    if not 1 <= count <= places:
        raise ValueError(f"{places} places cannot be divided into {count} clusters, allowed is [1, {places}]")
    if places == 1:
        return place_map
    return _merged(place_map, cut_tree(_linkage(place_map, scale), n_clusters=count).ravel())


def clustered_by_size(place_map: PlaceMap, size: float, scale: Scale = (1.0, 1.0)) -> PlaceMap:
    """Merges places into clusters, as clustered() does, while their diameters are at most a size.

    :param size: metres, or pixels if scale is (1, 1)
    :raises ValueError: the size is negative, the map has no places, or it is too large
    """
    if not 0 <= size < np.inf:
        raise ValueError(f"the size of a cluster is {size:g}, it must be at least 0")
    if len(place_map.places()) < 2:
        return place_map
    return _merged(place_map, fcluster(_linkage(place_map, scale), size, "distance"))


def _linkage(place_map: PlaceMap, scale: Scale) -> np.ndarray:
    positions = place_map.positions() * scale
    if len(positions) > MAX_PLACES:
        raise ValueError(f"{len(positions)} places cannot be clustered, allowed are {MAX_PLACES}")
    return linkage(positions, "complete")


def _merged(place_map: PlaceMap, clusters: np.ndarray) -> PlaceMap:
    """:param clusters: (places,) number of the cluster of each place"""
    positions = place_map.positions()
    middle: Dict[Tuple[float, float], np.ndarray] = {}
    for cluster in np.unique(clusters):
        members = positions[clusters == cluster]
        nearest = np.linalg.norm(members - members.mean(axis=0), axis=1).argmin()
        middle.update({tuple(position): members[nearest] for position in members})
    photos = []
    for photo in place_map.photos:
        x, y = middle[photo.x, photo.y]
        photos.append(photo._replace(x=float(x), y=float(y)))
    return place_map._replace(photos=tuple(photos))
