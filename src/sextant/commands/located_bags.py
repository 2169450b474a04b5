# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Localization in bags, for accuracy_statistics."""

import argparse
from collections import Counter
from typing import Dict, List, Optional, Sequence, Tuple

import numpy as np

import sextant
from sextant.bags.bag_params import BagParams
from sextant.bags.recorded_poses import RecordedPoses
from sextant.commands.bag_options import bag_params
from sextant.localization.drive_observations import DriveObservations
from sextant.localization.located_drive import locate_drive

RARE = 0.05  # of the most frequent marker's observations; below, a marker cannot be the measured one

Key = Tuple[str, int]  # family, id of a marker


def read_map(options: argparse.Namespace) -> Optional["sextant.MarkerMap"]:
    """Reads --map; None without. --family and --size apply to the plain text format.

    :raises RuntimeError: the file cannot be read
    """
    if not options.map:
        return None
    text = sextant.TextMapParams()
    text.family, text.size = options.family, options.size
    return sextant.read_marker_map(options.map, text)


def mapped_markers(options: argparse.Namespace) -> Sequence["sextant.MappedMarker"]:
    """Returns the markers of --map; none without. Errors as read_map()."""
    marker_map = read_map(options)
    return marker_map.markers if marker_map else ()


def chosen_modes(options: argparse.Namespace) -> Dict[str, str]:
    """Returns the modes of --mode by the names under which they are compared; one alone has no name.

    :raises ValueError: a mode is unknown
    """
    modes = listed_names(options.mode)
    unknown = sorted(set(modes) - set(sextant.locator_modes()))
    if unknown or not modes:
        allowed = ", ".join(sextant.locator_modes())
        raise ValueError(f"--mode {options.mode}: allowed are {allowed}, or several, separated by commas")
    return _named_methods(modes)


def chosen_topics(options: argparse.Namespace) -> Dict[str, str]:
    """Returns the topics of --pose by the names under which they are compared; one alone has no name."""
    return _named_methods(listed_names(options.pose))


def listed_names(text: str) -> List[str]:
    """Splits at commas, without repetitions and blanks."""
    return list(dict.fromkeys(word.strip() for word in text.split(",") if word.strip()))


def _named_methods(methods: Sequence[str]) -> Dict[str, str]:
    return {method: method for method in methods} if len(methods) > 1 else {"": methods[0]}


def localization_params(corner_sigma: Optional[float], mode: str = "") -> "sextant.LocalizationParams":
    """Returns the defaults of marker_locator with this corner noise in pixels.

    :param mode: of the locator; empty: its default
    :raises ValueError: the noise is out of range
    """
    params = sextant.LocalizationParams()
    params.locator.mode = mode or params.locator.mode
    if corner_sigma is not None:
        params.locator.corner_sigma = corner_sigma
    params.validate()
    return params


def reading(options: argparse.Namespace, camera_is_base: bool) -> BagParams:
    """Returns the parameters for reading bags.

    :param camera_is_base: poses are of the camera, not of the robot's base
    :raises ValueError, RuntimeError: an option or the map is invalid
    """
    marker_map = read_map(options)
    families = {options.family} if marker_map is None else {each.family for each in marker_map.markers}
    return bag_params(options, sorted(families), camera_is_base=camera_is_base)


def marker_frame(family: str, id: int, size: float) -> "sextant.MarkerMap":
    """Returns a map of one marker, in the marker's frame.

    :raises ValueError: the size is out of range
    """
    result = sextant.MarkerMap(f"marker_{id}")
    result.add(sextant.MappedMarker(family, id, size, np.eye(4)))
    return result


def measured_marker(drives: Sequence[DriveObservations], options: argparse.Namespace) -> "sextant.MarkerMap":
    """Returns marker_frame() of --marker, or of the only marker in the drives.

    :raises ValueError: the marker was not seen, or --marker is missing although several were seen
    """
    often, rarely = _seen(drives)
    listed = ", ".join(f"{id} of {family}" for family, id in often) or "none"
    wanted = often if options.marker is None else _named([*often, *rarely], options)
    if not wanted:
        who = "no marker was seen" if options.marker is None else f"marker {options.marker} was not seen"
        raise ValueError(f"{who}: check --family and --images; markers seen: {listed}")
    if len(wanted) > 1:
        raise ValueError(f"several markers were seen: {listed}; set the measured one: --marker")
    return marker_frame(*wanted[0], options.size)


def _named(keys: Sequence[Key], options: argparse.Namespace) -> List[Key]:
    """Returns the markers with the id of --marker, preferably of --family."""
    found = [key for key in keys if key[1] == options.marker]
    return [key for key in found if key[0] == options.family] or found


def _seen(drives: Sequence[DriveObservations]) -> Tuple[List[Key], List[Key]]:
    """Returns the markers that were seen often, and rarely."""
    seen = Counter((m.family, m.id) for drive in drives for image in drive.images for m in image.markers)
    least = RARE * max(seen.values(), default=0)
    often = sorted(key for key, count in seen.items() if count >= least)
    return often, sorted(set(seen) - set(often))


def located_poses(
    drive: DriveObservations, marker_map: "sextant.MarkerMap", params: "sextant.LocalizationParams"
) -> RecordedPoses:
    """Localizes the robot on one drive; warnings give the reasons of images without a pose."""
    located = locate_drive(drive, marker_map, params)
    failures = sorted(located.failures.items())
    return RecordedPoses(
        drive.name, marker_map.frame, located.stamps, located.poses, located.covariances,
        warnings=tuple(f"{count} images have no pose: {reason}" for reason, count in failures),
        images=located.instants,
    )  # fmt: skip


def noted(poses: Sequence[RecordedPoses], method: str = "") -> List[str]:
    """Returns the warnings with their bags, and the name of the method."""
    prefix = f"{method}: " if method else ""
    return [f"{each.bag}: {prefix}{warning}" for each in poses for warning in each.warnings]
