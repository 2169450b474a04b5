# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The drive through Victoria Park, Sydney (Guivant and Nebot 2001), as a graph of steps and sightings."""

from pathlib import Path
from typing import Dict, List, NamedTuple, Tuple

import numpy as np

import sextant
from sextant.geometry.plane_poses import rotation

FILE = "victoria_park.txt"
Sighted = Tuple[int, object]  # id of a tree, from the data's makers; sextant.PlaneSighting


class RecordedDrive(NamedTuple):
    """Poses are one more than the steps between them; looks are of the poses."""

    steps: np.ndarray  # (n, 3) in the frame where each begins
    noises: np.ndarray  # (n, 3, 3)
    looks: List[List[Sighted]]  # n + 1


def read_drive(folder: Path) -> RecordedDrive:
    """Lines `ODOMETRY i j x y heading` and `LANDMARK i id x y` with the upper triangle of the covariance.

    :raises OSError: the file is not there
    """
    steps, noises, looks, number_of = [], [], [[]], {"0": 0}
    for line in (folder / FILE).read_text().splitlines():
        kind, first, second, *figures = line.split()
        numbers = np.array(figures, dtype=float)
        if kind == "ODOMETRY":
            steps.append(numbers[:3])
            noises.append(_symmetric(numbers[3:], 3))
            number_of[second] = len(looks)
            looks.append([])
        else:
            sighting = sextant.PlaneSighting(numbers[:2], _symmetric(numbers[2:], 2))
            looks[number_of[first]].append((int(second), sighting))
    return RecordedDrive(np.array(steps), np.array(noises), looks)


def _symmetric(upper: np.ndarray, size: int) -> np.ndarray:
    matrix = np.zeros((size, size))
    matrix[np.triu_indices(size)] = upper
    return matrix + np.triu(matrix, 1).T


# Where a step's noise is felt; the core takes it where the step begins, so its covariance is turned to there.


def _felt_at_end(step: np.ndarray) -> np.ndarray:
    """X' = X U exp(w) = X exp(Ad w) U."""
    return _lever(step, rotation(step[2]))


def _felt_in_components(step: np.ndarray) -> np.ndarray:
    """U + w: the way is as it was measured, along the axes where the step begins, the turn comes after it."""
    return _lever(step, np.eye(2))


def _lever(step: np.ndarray, axes: np.ndarray) -> np.ndarray:
    turned = np.eye(3)
    turned[:2, :2], turned[:2, 2] = axes, (step[1], -step[0])
    return turned


FELT = {
    "at the step's end": _felt_at_end,
    "in its components": _felt_in_components,
    "where it begins": lambda step: np.eye(3),
}


def with_noise_felt(drive: RecordedDrive, where: str) -> RecordedDrive:
    """The drive with its noises as the core takes them.

    :param where: one of FELT, as the data is understood
    """
    turned = [FELT[where](step) for step in drive.steps]
    noises = [T @ noise @ T.T for T, noise in zip(turned, drive.noises)]
    return drive._replace(noises=np.array(noises))


def tree_counts(drive: RecordedDrive) -> Dict[int, int]:
    """Number of sightings by id."""
    ids, counts = np.unique([tree for look in drive.looks for tree, _ in look], return_counts=True)
    return dict(zip(map(int, ids), map(int, counts)))
