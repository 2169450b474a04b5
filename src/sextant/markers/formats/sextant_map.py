# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sextant's own two formats, which the core reads and writes (doc/marker_map.md)."""

from typing import Any, Callable, List

import numpy as np

import sextant
from sextant.markers.formats.losses import lost_covariances
from sextant.markers.formats.map_file import MapFileError, MapFormatParams, ReadMap

YAML_ENDINGS = (".yaml", ".yml")


def has_yaml_ending(path: str) -> bool:
    return path.endswith(YAML_ENDINGS)


def read_yaml_map(path: str, _params: MapFormatParams) -> ReadMap:
    """:raises MapFileError: not the ending, or the core's "file:line: reason" """
    _require_ending(path, True)
    return ReadMap(_core(sextant.read_marker_map, path))


def read_text_map(path: str, params: MapFormatParams) -> ReadMap:
    """Options give family and size, which the lines do not say; other frames become children of the map's.

    :raises MapFileError: a YAML ending, or the core's "file:line: reason"
    """
    _require_ending(path, False)
    text = sextant.TextMapParams()
    text.frame, text.family, text.size = params.frame or "map", params.known_family(), params.size
    marker_map = _core(sextant.read_marker_map, path, text)
    names = ", ".join(f"'{frame.name}'" for frame in marker_map.frames)
    told = f"the parents of the frames {names}: taken as '{text.frame}'"
    return ReadMap(marker_map, [told] if names else [])


def write_yaml_map(marker_map: sextant.MarkerMap, path: str) -> List[str]:
    """Nothing is lost.

    :raises MapFileError: not the ending, or the file cannot be written
    """
    _require_ending(path, True)
    _core(sextant.write_marker_map, marker_map, path)
    return []


def write_text_map(marker_map: sextant.MarkerMap, path: str) -> List[str]:
    """Without the covariances; what marker_broadcaster must be told to read it is told.

    :raises MapFileError: a YAML ending, several families or sizes, a name that does not end in its id
    """
    _require_ending(path, False)
    if not marker_map.markers:
        raise MapFileError("the map has no markers, from which the plain text would take family and size")
    first = marker_map.markers[0]
    text = sextant.TextMapParams()
    text.frame, text.family, text.size = marker_map.frame, first.family, first.size
    text.parents = {each.name: each.parent for each in marker_map.frames if each.parent != marker_map.frame}
    _core(sextant.write_marker_map, _without_covariances(marker_map), path, text)
    told = f"family, size and frame: marker_broadcaster needs family: {text.family}, size: {text.size:g}"
    told += f", frame: {text.frame}" + (f", parents: {text.parents}" if text.parents else "")
    return [told, *lost_covariances(marker_map)]


def _without_covariances(marker_map: sextant.MarkerMap) -> sextant.MarkerMap:
    exact = sextant.MarkerMap(marker_map)
    for marker in marker_map.markers:
        if np.any(marker.covariance):
            key_and_size = (marker.family, marker.id, marker.size)
            exact.set(sextant.MappedMarker(*key_and_size, marker.T_map_marker, marker.name))
    return exact


def _require_ending(path: str, yaml: bool) -> None:
    """The core tells its formats by the ending."""
    if has_yaml_ending(path) != yaml:
        wanted = "its YAML by .yaml or .yml" if yaml else "its plain text by any ending but .yaml or .yml"
        raise MapFileError(f"{path}: Sextant knows {wanted}: rename it")


def _core(call: Callable[..., Any], *arguments: Any) -> Any:
    """What the core refuses, as an error of this library."""
    try:
        return call(*arguments)
    except (RuntimeError, ValueError) as error:
        raise MapFileError(str(error)) from None
