# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Bags of measured distances: a folder a distance, named by it, each holding bags."""

from pathlib import Path
from typing import List, NamedTuple

from sextant.evaluation.pose_series import distance_of_folder


class DistanceBag(NamedTuple):
    """A bag, and the true value that its folder is named by: metres, radians where the axis is an angle."""

    distance: float
    path: str


class DistanceBags(NamedTuple):
    """What a folder holds."""

    bags: List[DistanceBag]  # by distance, then by name
    problems: List[str]  # of what is no distance or has no bag, one sentence each


def distance_bags(folder: Path, axis: str = "z") -> DistanceBags:
    """The bags of all distances. What begins with a dot is left alone, and so are files that are no bags.

    :raises ValueError: it is no folder, or there is not one bag in it where bags are expected
    """
    if not folder.is_dir():
        raise ValueError(f"{folder}: there is no such folder; it holds a folder a distance, named like 0.757")
    bags: List[DistanceBag] = []
    problems: List[str] = []
    for each in _seen(folder):
        if each.is_dir():
            try:
                bags += _bags_of(each, axis, problems)
            except ValueError as error:
                problems.append(f"{folder}: {error}")
        elif _is_bag(each):
            problems.append(f"{each}: is in no folder that is named by its distance")
    if not bags:
        reasons = "; ".join(problems) or "it has no folders"
        raise ValueError(f"{folder}: there is no bag in a folder that is named by its distance: {reasons}")
    return DistanceBags(sorted(bags), problems)


def _seen(folder: Path) -> List[Path]:
    return sorted(path for path in folder.iterdir() if not path.name.startswith("."))


def _is_bag(path: Path) -> bool:
    """Without what `rosbag reindex` keeps of a broken one, beside that."""
    name = path.name
    reindexed = name.endswith(".orig.bag") and path.with_name(name[: -len(".orig.bag")] + ".bag").exists()
    return path.is_file() and name.lower().endswith(".bag") and not reindexed


def _bags_of(folder: Path, axis: str, problems: List[str]) -> List[DistanceBag]:
    distance = distance_of_folder(folder.name, axis)
    bags = [each for each in _seen(folder) if _is_bag(each)]
    for each in _seen(folder):
        if each.name.endswith(".bag.active"):
            problems.append(f"{each}: its recording was not ended; take .active away and `rosbag reindex` it")
        elif each.is_dir() and any(map(_is_bag, each.iterdir())):
            problems.append(f"{each}: a folder in the folder of a distance is not looked into")
    if not bags:
        raise ValueError(f"folder '{folder.name}': there is no bag in it")
    return [DistanceBag(distance, str(bag)) for bag in bags]
