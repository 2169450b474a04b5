# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Poses of bags, located or recorded, as accuracy_statistics takes them."""

import argparse
from collections import Counter
from typing import List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

import sextant
from sextant.bags.bag_params import BagParams
from sextant.bags.recorded_poses import RecordedPoses
from sextant.commands.bag_options import bag_params
from sextant.localization.drive_sightings import DriveSightings
from sextant.localization.located_drive import locate_drive

RARE = 0.05  # of the most frequent marker's sightings: below it a marker is none that was measured

Key = Tuple[str, int]  # family, id of a marker


class MapFile(NamedTuple):
    """A marker map that processes and machines can hand on."""

    path: str  # empty: none
    family: str  # what a text map does not tell
    size: float  # metres

    @classmethod
    def of(cls, options: argparse.Namespace) -> "MapFile":
        return cls(options.map or "", options.family, options.size)

    def read(self) -> Optional["sextant.MarkerMap"]:
        """:raises RuntimeError: it cannot be read"""
        if not self.path:
            return None
        text = sextant.TextMapParams()
        text.family, text.size = self.family, self.size
        return sextant.read_marker_map(self.path, text)


def localization_params(corner_sigma: Optional[float]) -> "sextant.LocalizationParams":
    """The node's own but for the noise, in pixels. :raises ValueError: it is out of range"""
    params = sextant.LocalizationParams()
    if corner_sigma is not None:
        params.locator.corner_sigma = corner_sigma
    params.validate()
    return params


def reading(options: argparse.Namespace, camera_is_base: bool) -> BagParams:
    """What is read of bags in which poses are to be located.

    :raises ValueError, RuntimeError: an option, or the map, that cannot be
    """
    marker_map = MapFile.of(options).read()
    families = {options.family} if marker_map is None else {each.family for each in marker_map.markers}
    return bag_params(options, sorted(families), camera_is_base=camera_is_base)


def marker_frame(family: str, id: int, size: float) -> "sextant.MarkerMap":
    """A map of this marker alone, whose frame is the map's. :raises ValueError: its size is out of range"""
    result = sextant.MarkerMap(f"marker_{id}")
    result.add(sextant.MappedMarker(family, id, size, np.eye(4)))
    return result


def measured_marker(drives: Sequence[DriveSightings], options: argparse.Namespace) -> "sextant.MarkerMap":
    """marker_frame() of --marker; of the only one in sight if none is named.

    :raises ValueError: it was not seen, or several were and none was named
    """
    often, rarely = _seen(drives)
    told = ", ".join(f"{id} of {family}" for family, id in often) or "none"
    wanted = often if options.marker is None else _named([*often, *rarely], options)
    if not wanted:
        who = "no marker was seen" if options.marker is None else f"marker {options.marker} was not seen"
        raise ValueError(f"{who}: is the --family right, and --images? What was seen: {told}")
    if len(wanted) > 1:
        raise ValueError(f"several markers were seen: {told}; name the one that was measured: --marker")
    return marker_frame(*wanted[0], options.size)


def _named(keys: Sequence[Key], options: argparse.Namespace) -> List[Key]:
    """Of several with the id of --marker, the one of --family."""
    found = [key for key in keys if key[1] == options.marker]
    return [key for key in found if key[0] == options.family] or found


def _seen(drives: Sequence[DriveSightings]) -> Tuple[List[Key], List[Key]]:
    """Markers that were seen often, and rarely."""
    seen = Counter((m.family, m.id) for drive in drives for image in drive.images for m in image.markers)
    least = RARE * max(seen.values(), default=0)
    often = sorted(key for key, count in seen.items() if count >= least)
    return often, sorted(set(seen) - set(often))


def located_poses(
    drive: DriveSightings, marker_map: "sextant.MarkerMap", params: "sextant.LocalizationParams"
) -> RecordedPoses:
    """Of one bag; its warnings say why images have none."""
    located = locate_drive(drive, marker_map, params)
    without = sorted(located.without.items())
    return RecordedPoses(
        drive.name, marker_map.frame, located.stamps, located.poses, located.covariances,
        warnings=tuple(f"{count} images have no pose: {reason}" for reason, count in without),
    )  # fmt: skip


def noted(poses: Sequence[RecordedPoses]) -> List[str]:
    """The warnings, each with its bag."""
    return [f"{each.bag}: {warning}" for each in poses for warning in each.warnings]
