# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Poses of bags, located or recorded, as accuracy_statistics takes them."""

import argparse
import functools
from collections import Counter
from typing import Any, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

import sextant
from sextant.bags.drive_reader import RecordedDrive, read_drive
from sextant.bags.recorded_poses import RecordedPoses, read_poses
from sextant.commands.bag_options import read_bags, read_options
from sextant.mapping.located_drive import locate_drive

RARE = 0.05  # of the most frequent marker's sightings: below it a marker is none that was measured


class LocatedBags(NamedTuple):
    """Poses bag by bag, and what was noted on the way."""

    poses: List[Tuple[str, RecordedPoses]]  # by bag
    notes: List[str]
    drives: List[RecordedDrive]  # that they were located in; none where they were recorded


def recorded_poses(bags: Sequence[str], options: argparse.Namespace) -> LocatedBags:
    """Those that were published. :raises RuntimeError, ValueError: as read_bags()"""
    read, notes = read_bags(functools.partial(read_poses, topic=options.pose), bags, options)
    return LocatedBags(read, notes, [])


def read_drives(bags: Sequence[str], options: argparse.Namespace, camera_is_base: bool) -> Tuple[Any, ...]:
    """((bag, RecordedDrive), notes). :raises RuntimeError, ValueError: as read_bags()"""
    given = known_map(options)
    families = [options.family] if given is None else sorted({marker.family for marker in given.markers})
    reading = read_options(options, families, camera_is_base=camera_is_base)
    return read_bags(functools.partial(read_drive, options=reading), bags, options)


def known_map(options: argparse.Namespace) -> Optional["sextant.MarkerMap"]:
    """:raises RuntimeError: it cannot be read"""
    if not options.map:
        return None
    text = sextant.TextMapParams()
    text.family, text.size = options.family, options.size
    return sextant.read_marker_map(options.map, text)


def reference_map(options: argparse.Namespace, drives: Sequence[RecordedDrive]) -> "sextant.MarkerMap":
    """The map that was named, or one of the marker that was measured, whose frame is the map's.

    :raises ValueError: several markers were seen, or none, and none was named
    """
    given = known_map(options)
    if given is not None:
        return given
    id = options.marker if options.marker is not None else _only_marker(drives)
    result = sextant.MarkerMap(f"marker_{id}")
    family = sextant.canonical_family(options.family)
    result.add(sextant.MappedMarker(family, id, options.size, np.eye(4)))
    return result


def _only_marker(drives: Sequence[RecordedDrive]) -> int:
    seen = Counter(marker.id for drive in drives for image in drive.images for marker in image.markers)
    if not seen:
        raise ValueError("no marker was seen; look at --family, or name --images")
    often = sorted(id for id, count in seen.items() if count >= RARE * max(seen.values()))
    if len(often) > 1:
        told = ", ".join(map(str, often))
        raise ValueError(f"the markers {told} were seen: name the one that was measured with --marker")
    return often[0]


def located_poses(
    read: Sequence[Tuple[str, RecordedDrive]], marker_map: "sextant.MarkerMap", corner_sigma: float
) -> Tuple[List[Tuple[str, RecordedPoses]], List[str]]:
    """Poses by bag, and what was noted. :raises ValueError: corner_sigma is out of range"""
    params = sextant.LocalizationParams()
    params.locator.corner_sigma = corner_sigma
    poses, notes = [], []
    for bag, drive in read:
        located = locate_drive(drive, marker_map, params)
        without = sorted(located.without.items())
        notes += [f"{bag}: no pose of {count} images: {reason}" for reason, count in without]
        recorded = RecordedPoses(
            bag, marker_map.frame, located.stamps, located.poses, located.covariances, drive.start
        )
        poses.append((bag, recorded))
    return poses, notes
