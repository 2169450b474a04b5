# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Content of a marker map that another format cannot represent: errors and warnings."""

from typing import Iterable, List, Set

import numpy as np

import sextant
from sextant.markers.formats.format_types import MapFileError


def only_family(marker_map: sextant.MarkerMap, known: Iterable[str], package: str) -> str:
    """Returns the family of all markers.

    :param known: canonical names (sextant.canonical_family) of the families that the package supports
    :raises MapFileError: several families, or one that the package does not support
    """
    families = sorted({marker.family for marker in marker_map.markers})
    if len(families) != 1:
        raise MapFileError(f"{package} has one family per map, this map has {', '.join(families)}")
    if families[0] not in known:
        raise MapFileError(f"{package} does not know {families[0]}, only {', '.join(sorted(known))}")
    return families[0]


def only_size(marker_map: sextant.MarkerMap, package: str) -> float:
    """Returns the edge length of all markers in metres.

    :raises MapFileError: several sizes
    """
    sizes: Set[float] = {marker.size for marker in marker_map.markers}
    if len(sizes) != 1:
        listed = ", ".join(f"{size:g} m" for size in sorted(sizes))
        raise MapFileError(f"{package} has one size per map, this map has {listed}")
    return sizes.pop()


def lost_covariances(marker_map: sextant.MarkerMap) -> List[str]:
    """Warns of covariances, if there are any."""
    uncertain = [marker for marker in marker_map.markers if np.any(marker.covariance)]
    return [f"the covariance of {_several(uncertain)}: the format has none"] if uncertain else []


def lost_names(marker_map: sextant.MarkerMap) -> List[str]:
    """Warns of names other than the default, FAMILY/ID."""
    named = [each for each in marker_map.markers if each.name != f"{each.family}/{each.id}"]
    return [f"the name of {_several(named)}: the format has none"] if named else []


def lost_frames(marker_map: sextant.MarkerMap) -> List[str]:
    """Warns of frames that are not markers."""
    names = ", ".join(f"'{frame.name}'" for frame in marker_map.frames)
    return [f"the frames that are not markers: {names}"] if names else []


def _several(markers: List[sextant.MappedMarker]) -> str:
    return f"marker '{markers[0].name}'" if len(markers) == 1 else f"{len(markers)} markers"
