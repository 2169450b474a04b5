# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sextant's YAML and plain text formats, read and written by the core (doc/reference/marker_map.md).

Plain text files written for other broadcasters of static transforms may contain more than the format: a line
of the map's own frame, and an eighth field. Nodes refuse both; a conversion leaves them out and warns.
"""

from typing import Any, Callable, List, Tuple

import numpy as np

import sextant
from sextant.markers.formats.format_types import (
    MapFileError,
    MapFormatParams,
    ReadMap,
    fields_of,
    finite,
    read_text,
)
from sextant.markers.formats.losses import lost_covariances

YAML_ENDINGS = (".yaml", ".yml")
TEXT_FIELDS = 7  # name Tx Ty Tz Rx Ry Rz


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
    :raises MapFileError: a YAML ending, a line with a pose of the map frame in itself, or the core's
        "file:line: reason"
    """
    _require_ending(path, False)
    text = sextant.TextMapParams()
    text.frame, text.family, text.size = params.frame or "map", params.known_family(), params.size
    content, warnings = _without_additions(path, text.frame)
    marker_map = _core(sextant.parse_marker_map, content, path, text)
    names = ", ".join(f"'{frame.name}'" for frame in marker_map.frames)
    if names:
        warnings.append(f"the parents of the frames {names}: set to '{text.frame}'")
    return ReadMap(marker_map, warnings)


def _without_additions(path: str, frame: str) -> Tuple[str, List[str]]:
    """Returns the content without the line of the map frame and eighth fields, and a warning of each.

    Lines keep their numbers, for the errors of the core.
    """
    lines = read_text(path).split("\n")
    warnings, eighths = [], []
    for index, words in enumerate(map(fields_of, lines)):
        if len(words) == TEXT_FIELDS + 1:
            eighths.append(f"'{words.pop()}' in line {index + 1}")
            lines[index] = " ".join(words)
        if len(words) == TEXT_FIELDS and words[0] == frame:
            _require_identity(words, f"{path}:{index + 1}")
            lines[index] = ""
            warnings.append(f"line {index + 1}, the frame of the map: it has no pose in itself")
    if eighths:
        more = f" and {len(eighths) - 1} more" if len(eighths) > 1 else ""
        warnings.append(f"the eighth field, {eighths[0]}{more}: the format has {TEXT_FIELDS}, it is ignored")
    return "\n".join(lines), warnings


def _require_identity(words: List[str], place: str) -> None:
    """:raises MapFileError: the line has a pose other than the identity, or no pose"""
    try:
        is_identity = not any(map(finite, words[1:]))
    except ValueError as error:
        raise MapFileError(f"{place}: {error}") from None
    if not is_identity:
        raise MapFileError(
            f"{place}: the frame of the map, '{words[0]}', cannot have a pose in itself; set another name for"
            " the frame that all poses are in (--frame), or remove the line"
        )


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
