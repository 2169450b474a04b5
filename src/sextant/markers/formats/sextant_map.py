# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sextant's YAML and plain text formats, read and written by the core (doc/reference/marker_map.md)."""

from typing import Any, Callable, List

import numpy as np

import sextant
from sextant.markers.formats.format_types import MapFileError, MapFormatParams, ReadMap
from sextant.markers.formats.losses import lost_covariances

YAML_ENDINGS = (".yaml", ".yml")


def has_yaml_ending(path: str) -> bool:
    """Returns whether a path ends in .yaml or .yml."""
    return path.endswith(YAML_ENDINGS)


def read_yaml_map(path: str, _params: MapFormatParams) -> ReadMap:
    """Reads a YAML map.

    :raises MapFileError: another ending, or the core's "file:line: reason"
    """
    _require_ending(path, True)
    return ReadMap(_core(sextant.read_marker_map, path))


def read_text_map(path: str, params: MapFormatParams) -> ReadMap:
    """Reads a plain text map. Frames that are not markers become children of the map frame.

    :param params: family and size are required, since the file does not contain them
    :raises MapFileError: a YAML ending, or the core's "file:line: reason"
    """
    _require_ending(path, False)
    text = sextant.TextMapParams()
    text.frame, text.family, text.size = params.frame or "map", params.known_family(), params.size
    marker_map = _core(sextant.read_marker_map, path, text)
    names = ", ".join(f"'{frame.name}'" for frame in marker_map.frames)
    warning = f"the parents of the frames {names}: set to '{text.frame}'"
    return ReadMap(marker_map, [warning] if names else [])


def write_yaml_map(marker_map: sextant.MarkerMap, path: str) -> List[str]:
    """Writes a YAML map, which represents everything.

    :raises MapFileError: another ending, or the file cannot be written
    """
    _require_ending(path, True)
    _core(sextant.write_marker_map, marker_map, path)
    return []


def write_text_map(marker_map: sextant.MarkerMap, path: str) -> List[str]:
    """Writes a plain text map, without covariances.

    :returns: warnings, the first with the parameters that marker_broadcaster needs to read the file
    :raises MapFileError: a YAML ending, several families or sizes, or a name that does not end in the id
    """
    _require_ending(path, False)
    first = marker_map.markers[0]
    text = sextant.TextMapParams()
    text.frame, text.family, text.size = marker_map.frame, first.family, first.size
    text.parents = {each.name: each.parent for each in marker_map.frames if each.parent != marker_map.frame}
    _core(sextant.write_marker_map, _without_covariances(marker_map), path, text)
    needed = f"family, size and frame: marker_broadcaster needs family: {text.family}, size: {text.size:g}"
    needed += f", frame: {text.frame}" + (f", parents: {text.parents}" if text.parents else "")
    return [needed, *lost_covariances(marker_map)]


def _without_covariances(marker_map: sextant.MarkerMap) -> sextant.MarkerMap:
    exact = sextant.MarkerMap(marker_map)
    for marker in marker_map.markers:
        if np.any(marker.covariance):
            key_and_size = (marker.family, marker.id, marker.size)
            exact.set(sextant.MappedMarker(*key_and_size, marker.T_map_marker, marker.name))
    return exact


def _require_ending(path: str, yaml: bool) -> None:
    """Checks the ending, by which the core distinguishes its formats."""
    if has_yaml_ending(path) != yaml:
        wanted = "its YAML ends in .yaml or .yml" if yaml else "its plain text must not end in .yaml or .yml"
        raise MapFileError(f"{path}: not a file name of Sextant's format, {wanted}: rename it")


def _core(call: Callable[..., Any], *arguments: Any) -> Any:
    """Calls a function of the core; raises its errors as MapFileError."""
    try:
        return call(*arguments)
    except (RuntimeError, ValueError) as error:
        raise MapFileError(str(error)) from None
