# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a foreign format cannot hold of a map: refused, or told in a sentence."""

from typing import Iterable, List, Set

import numpy as np

import sextant
from sextant.markers.formats.map_file import MapFileError


def require_markers(marker_map: sextant.MarkerMap) -> None:
    """:raises MapFileError: an empty map, which nobody means to convert"""
    if not marker_map.markers:
        raise MapFileError("the map has no markers")


def only_family(marker_map: sextant.MarkerMap, known: Iterable[str], package: str) -> str:
    """The family of all markers.

    :param known: canonical names (sextant.canonical_family) of those that the package can detect
    :raises MapFileError: markers of several families, or of one that the package does not know
    """
    families = sorted({marker.family for marker in marker_map.markers})
    if len(families) != 1:
        raise MapFileError(f"{package} has one family a map, this map has {', '.join(families)}")
    if families[0] not in known:
        raise MapFileError(f"{package} does not know {families[0]}, only {', '.join(sorted(known))}")
    return families[0]


def only_size(marker_map: sextant.MarkerMap, package: str) -> float:
    """Edge length of all markers in metres.

    :raises MapFileError: markers of several sizes
    """
    sizes: Set[float] = {marker.size for marker in marker_map.markers}
    if len(sizes) != 1:
        told = ", ".join(f"{size:g} m" for size in sorted(sizes))
        raise MapFileError(f"{package} has one size a map, this map has {told}")
    return sizes.pop()


def lost_covariances(marker_map: sextant.MarkerMap) -> List[str]:
    uncertain = [marker for marker in marker_map.markers if np.any(marker.covariance)]
    return [f"the covariance of {_several(uncertain)}: the format has none"] if uncertain else []


def lost_names(marker_map: sextant.MarkerMap) -> List[str]:
    """Names other than the default, FAMILY/ID."""
    named = [each for each in marker_map.markers if each.name != f"{each.family}/{each.id}"]
    return [f"the name of {_several(named)}: the format has none"] if named else []


def lost_frames(marker_map: sextant.MarkerMap) -> List[str]:
    names = ", ".join(f"'{frame.name}'" for frame in marker_map.frames)
    return [f"the frames that are no markers: {names}"] if names else []


def _several(markers: List[sextant.MappedMarker]) -> str:
    return f"marker '{markers[0].name}'" if len(markers) == 1 else f"{len(markers)} markers"
