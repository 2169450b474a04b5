# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads and writes marker maps in the formats of Sextant and of other packages."""

from dataclasses import dataclass
from typing import Callable, Dict, List, Tuple

import sextant
from sextant.base.atomic_file import atomic_file
from sextant.markers.formats.apriltag_ros import format_apriltag_ros, read_apriltag_ros
from sextant.markers.formats.fiducial_slam import FIELDS as FIDUCIAL_SLAM_FIELDS
from sextant.markers.formats.fiducial_slam import format_fiducial_slam, read_fiducial_slam
from sextant.markers.formats.format_types import (
    MapFileError,
    MapFormatParams,
    ReadMap,
    WrittenMap,
    fields_of,
    read_text,
)
from sextant.markers.formats.sextant_map import (
    TEXT_FIELDS,
    has_yaml_ending,
    read_text_map,
    read_yaml_map,
    write_text_map,
    write_yaml_map,
)
from sextant.markers.formats.tagslam import read_tagslam
from sextant.markers.formats.tagslam_writer import format_tagslam
from sextant.markers.formats.yaml_table import read_yaml

Reader = Callable[[str, MapFormatParams], ReadMap]
Writer = Callable[[sextant.MarkerMap, str], List[str]]


@dataclass(frozen=True)
class MapFormat:
    """Reader and writer of a format, and the fields of MapFormatParams that the reader uses."""

    read: Reader  # reads a file
    write: Writer  # writes a file
    needs: Tuple[str, ...] = ()  # required fields
    takes: Tuple[str, ...] = ("frame",)  # optional fields


def _atomic(format_map: Callable[[sextant.MarkerMap], WrittenMap]) -> Writer:
    def write(marker_map: sextant.MarkerMap, path: str) -> List[str]:
        text, warnings = format_map(marker_map)
        try:
            with atomic_file(path) as file:
                file.write(text)
        except OSError as error:
            raise MapFileError(f"{path}: cannot be written: {error.strerror}") from None
        return warnings

    return write


FORMATS: Dict[str, MapFormat] = {
    "yaml": MapFormat(read_yaml_map, write_yaml_map, takes=()),
    "text": MapFormat(read_text_map, write_text_map, needs=("family", "size")),
    "fiducial_slam": MapFormat(read_fiducial_slam, _atomic(format_fiducial_slam), needs=("family", "size")),
    "apriltag_ros": MapFormat(
        read_apriltag_ros, _atomic(format_apriltag_ros), takes=("frame", "family", "bundle")
    ),
    "tagslam": MapFormat(read_tagslam, _atomic(format_tagslam), takes=("frame", "family", "bundle")),
}
# top-level keys that identify a YAML format
YAML_KEYS = {
    "yaml": {"frame", "markers"},
    "apriltag_ros": {"standalone_tags", "tag_bundles"},
    "tagslam": {"bodies"},
}
FORMAT_OF_FILE_NAME = {"tags.yaml": "apriltag_ros", "tagslam.yaml": "tagslam", "poses.yaml": "tagslam"}


def read_map(path: str, name: str, params: MapFormatParams) -> ReadMap:
    """Reads a map file.

    :param name: name of the format in FORMATS
    :raises MapFileError: the file is malformed ("file:line: reason"), an option that the format needs is
        missing, or an option is set that the file itself defines
    """
    given = {key for key, value in vars(params).items() if value is not None}
    wanted = FORMATS[name]
    missing = [key for key in wanted.needs if key not in given]
    if missing:
        lacking = " and ".join(missing)
        raise MapFileError(f"{path}: {name} does not contain the markers' {lacking}: set {_flags(missing)}")
    unused = sorted(given.difference(wanted.needs, wanted.takes))
    if unused:
        raise MapFileError(f"{path}: {name} does not use {_flags(unused)}")
    _require_in_range(params)
    read = wanted.read(path, params)
    if not read.marker_map.markers:
        raise MapFileError(f"{path}: has no markers")
    return read


def _require_in_range(params: MapFormatParams) -> None:
    if params.size is not None and not 0 < params.size <= 100:
        raise MapFileError(f"--size must be in (0, 100] m, not {params.size:g}")
    frame = params.frame
    if frame is not None and (frame.split() != [frame] or frame.startswith("/")):
        raise MapFileError(f"--frame: '{frame}' cannot name a tf frame")


def write_map(marker_map: sextant.MarkerMap, path: str, name: str) -> List[str]:
    """Writes a map file atomically.

    :param name: name of the format in FORMATS
    :returns: warnings, one for each kind of information that the format cannot represent
    :raises MapFileError: the format cannot represent the map (an empty one only YAML), or the file cannot be
        written
    """
    if name != "yaml" and not marker_map.markers:
        raise MapFileError("the map has no markers")
    return FORMATS[name].write(marker_map, path)


def guess_read_format(path: str) -> str:
    """Guesses the format of a file from its content.

    :returns: name in FORMATS
    :raises MapFileError: the file cannot be read, or no format or several fit
    """
    found = _guess_yaml(path) if has_yaml_ending(path) else _guess_lines(path)
    if len(found) != 1:
        candidates = " and ".join(found) or "no known format"
        raise MapFileError(f"{path}: looks like {candidates}; name the format: --from {'|'.join(FORMATS)}")
    return found[0]


def _guess_yaml(path: str) -> List[str]:
    names = set(read_yaml(path))
    return [name for name, signs in YAML_KEYS.items() if names & signs]


def _guess_lines(path: str) -> List[str]:
    lengths = [len(words) for words in map(fields_of, read_text(path).split("\n")) if words]
    fits = {
        "text": all(length in (TEXT_FIELDS, TEXT_FIELDS + 1) for length in lengths),
        "fiducial_slam": all(length >= FIDUCIAL_SLAM_FIELDS for length in lengths),
    }
    return [name for name, fit in fits.items() if fit and lengths]


def guess_write_format(path: str) -> str:
    """Guesses Sextant's YAML from the ending; file names of other packages and other endings are refused.

    :returns: name in FORMATS
    :raises MapFileError: the format is ambiguous
    """
    base = path.rpartition("/")[2]
    if base in FORMAT_OF_FILE_NAME:
        package = FORMAT_OF_FILE_NAME[base]
        raise MapFileError(f"{path}: is a file name of {package}; set --to {package} or --to yaml")
    if not has_yaml_ending(path):
        raise MapFileError(f"{path}: the ending does not define the format; set --to {'|'.join(FORMATS)}")
    return "yaml"


def _flags(names: List[str]) -> str:
    return " and ".join(f"--{name}" for name in names)
