# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Marker maps of other packages, read and written by the name of their format."""

from dataclasses import dataclass
from typing import Callable, Dict, List, Tuple

import sextant
from sextant.base.atomic_file import atomic_file
from sextant.markers.formats.apriltag_ros import format_apriltag_ros, read_apriltag_ros
from sextant.markers.formats.fiducial_slam import FIELDS as FIDUCIAL_SLAM_FIELDS
from sextant.markers.formats.fiducial_slam import format_fiducial_slam, read_fiducial_slam
from sextant.markers.formats.located_yaml import read_yaml
from sextant.markers.formats.map_file import MapFileError, MapFormatParams, ReadMap, WrittenMap, read_text
from sextant.markers.formats.sextant_map import (
    has_yaml_ending,
    read_text_map,
    read_yaml_map,
    write_text_map,
    write_yaml_map,
)
from sextant.markers.formats.tagslam import read_tagslam
from sextant.markers.formats.tagslam_writer import format_tagslam

Reader = Callable[[str, MapFormatParams], ReadMap]
Writer = Callable[[sextant.MarkerMap, str], List[str]]


@dataclass(frozen=True)
class MapFormat:
    """How a format is read and written, and which options its reader needs, and which it takes besides."""

    read: Reader
    write: Writer
    needs: Tuple[str, ...] = ()
    takes: Tuple[str, ...] = ("frame",)


def _atomic(format_map: Callable[[sextant.MarkerMap], WrittenMap]) -> Writer:
    def write(marker_map: sextant.MarkerMap, path: str) -> List[str]:
        written = format_map(marker_map)
        try:
            with atomic_file(path) as file:
                file.write(written.text)
        except OSError as error:
            raise MapFileError(f"{path}: cannot be written: {error.strerror}") from None
        return written.warnings

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
# what only one of the YAML formats has at its top
YAML_SIGNS = {
    "yaml": {"frame", "markers"},
    "apriltag_ros": {"standalone_tags", "tag_bundles"},
    "tagslam": {"bodies"},
}
THEIR_NAMES = {"tags.yaml": "apriltag_ros", "tagslam.yaml": "tagslam", "poses.yaml": "tagslam"}
TEXT_FIELDS = 7


def read_map(path: str, name: str, params: MapFormatParams) -> ReadMap:
    """The map of a file in the format of a name in FORMATS.

    :raises MapFileError: the file is none, "file:line: reason"; an option that the format needs is not there;
        one is there that the file says itself
    """
    given = {key for key, value in vars(params).items() if value is not None}
    wanted = FORMATS[name]
    missing = [key for key in wanted.needs if key not in given]
    if missing:
        told = " and ".join(missing)
        raise MapFileError(f"{path}: {name} does not say the markers' {told}: give {_flags(missing)}")
    idle = sorted(given.difference(wanted.needs, wanted.takes))
    if idle:
        raise MapFileError(f"{path}: {name} has no use for {_flags(idle)}")
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
    """Writes the file whole or not at all, in the format of a name in FORMATS.

    :returns: what the file does not hold, a sentence each
    :raises MapFileError: the format cannot hold the map, or the file cannot be written
    """
    return FORMATS[name].write(marker_map, path)


def guess_read_format(path: str) -> str:
    """Name of the format that the content is of.

    :raises MapFileError: no file, or none or several formats that it could be
    """
    found = _guess_yaml(path) if has_yaml_ending(path) else _guess_lines(path)
    if len(found) != 1:
        told = " and ".join(found) or "no format that is known"
        raise MapFileError(f"{path}: looks like {told}; say which it is: --from {'|'.join(FORMATS)}")
    return found[0]


def _guess_yaml(path: str) -> List[str]:
    names = set(read_yaml(path))
    return [name for name, signs in YAML_SIGNS.items() if names & signs]


def _guess_lines(path: str) -> List[str]:
    lines = [line.partition("#")[0].split() for line in read_text(path).split("\n")]
    lengths = [len(words) for words in lines if words]
    fits = {
        "text": all(length == TEXT_FIELDS for length in lengths),
        "fiducial_slam": all(length >= FIDUCIAL_SLAM_FIELDS for length in lengths),
    }
    return [name for name, fit in fits.items() if fit and lengths]


def guess_write_format(path: str) -> str:
    """Sextant's YAML by its ending; other endings, and other packages' names, are not guessed.

    :raises MapFileError: it could be another format
    """
    base = path.rpartition("/")[2]
    if base in THEIR_NAMES:
        raise MapFileError(f"{path}: say --to {THEIR_NAMES[base]}, whose name this is, or --to yaml")
    if not has_yaml_ending(path):
        raise MapFileError(f"{path}: the ending does not tell the format; say --to {'|'.join(FORMATS)}")
    return "yaml"


def _flags(names: List[str]) -> str:
    return " and ".join(f"--{name}" for name in names)
