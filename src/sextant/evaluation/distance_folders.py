# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Finds bags of measured distances in folders that are named by the distance."""

from pathlib import Path
from typing import List, NamedTuple

from sextant.evaluation.pose_series import distance_of_folder


class DistanceBag(NamedTuple):
    """A bag and its true distance."""

    distance: float  # name of the folder: metres, or radians for an angle; or number of the surveyed point
    path: str  # of the bag


class DistanceBags(NamedTuple):
    """Bags in the folders of distances."""

    bags: List[DistanceBag]  # by distance, then by name
    problems: List[str]  # one sentence per folder without a distance or bag


def distance_bags(folder: Path, axis: str = "z") -> DistanceBags:
    """Finds the bags of all distances. Hidden files, and files that are not bags, are ignored.

    :param axis: in AXES, whose values the folder names are
    :raises ValueError: folder does not exist, or contains no bag in a folder of a distance
    """
    if not folder.is_dir():
        raise ValueError(f"{folder}: no such folder; it must contain folders named by distance, e.g. 0.757")
    bags: List[DistanceBag] = []
    problems: List[str] = []
    for each in _seen(folder):
        if each.is_dir():
            try:
                bags += _bags_of(each, axis, problems)
            except ValueError as error:
                problems.append(f"{folder}: {error}")
        elif is_bag(each):
            problems.append(f"{each}: is not in a folder named by its distance")
    if not bags:
        reasons = "; ".join(problems) or "it has no folders"
        raise ValueError(f"{folder}: there is no bag in a folder named by its distance: {reasons}")
    return DistanceBags(sorted(bags), problems)


def _seen(folder: Path) -> List[Path]:
    return sorted(path for path in folder.iterdir() if not path.name.startswith("."))


def is_bag(path: Path) -> bool:
    """Returns whether a file is a bag, but not the backup copy of `rosbag reindex`."""
    name = path.name
    reindexed = name.endswith(".orig.bag") and path.with_name(name[: -len(".orig.bag")] + ".bag").exists()
    return path.is_file() and name.lower().endswith(".bag") and not reindexed


def _bags_of(folder: Path, axis: str, problems: List[str]) -> List[DistanceBag]:
    distance = distance_of_folder(folder.name, axis)
    return [DistanceBag(distance, str(bag)) for bag in bags_in(folder, problems)]


def bags_in(folder: Path, problems: List[str]) -> List[Path]:
    """Returns the bags of a folder by name, and appends one sentence per unfinished bag or inner folder.

    :raises ValueError: there is none
    """
    bags = [each for each in _seen(folder) if is_bag(each)]
    for each in _seen(folder):
        if each.name.endswith(".bag.active"):
            problems.append(f"{each}: the recording was not finished; remove .active and `rosbag reindex` it")
        elif each.is_dir() and any(map(is_bag, each.iterdir())):
            problems.append(f"{each}: folders in a folder of bags are not searched")
    if not bags:
        raise ValueError(f"folder '{folder.name}': there is no bag in it")
    return bags
