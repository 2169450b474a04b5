# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Bags of measured distances: a folder a distance, named by it, each holding bags."""

from pathlib import Path
from typing import List, NamedTuple

from sextant.statistics.pose_series import distance_of_folder


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
    for each in sorted(path for path in folder.iterdir() if not path.name.startswith(".")):
        if each.is_dir():
            try:
                bags += _bags_of(each, axis)
            except ValueError as error:
                problems.append(f"{folder}: {error}")
        elif each.suffix == ".bag":
            problems.append(f"{each}: is in no folder that is named by its distance")
    if not bags:
        reasons = "; ".join(problems) or "it has no folders"
        raise ValueError(f"{folder}: there is no bag in a folder that is named by its distance: {reasons}")
    return DistanceBags(sorted(bags), problems)


def _bags_of(folder: Path, axis: str) -> List[DistanceBag]:
    distance = distance_of_folder(folder.name, axis)
    bags = sorted(folder.glob("*.bag"))
    if not bags:
        raise ValueError(f"folder '{folder.name}': there is no bag in it")
    return [DistanceBag(distance, str(bag)) for bag in bags]
