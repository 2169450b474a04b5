# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The drive through Victoria Park, Sydney (Guivant and Nebot 2001), as a graph of steps and observations."""

from pathlib import Path
from typing import Dict, List, NamedTuple, Tuple

import numpy as np

import sextant
from sextant.geometry.plane_poses import rotation

FILE = "victoria_park.txt"
TreeObservation = Tuple[int, object]  # id of a tree in the data; sextant.Observation2D


class RecordedDrive(NamedTuple):
    """A recorded drive: one pose and one scan more than steps."""

    steps: np.ndarray  # (n, 3) in the frame where each begins
    noises: np.ndarray  # (n, 3, 3)
    scans: List[List[TreeObservation]]  # n + 1


def read_drive(folder: Path) -> RecordedDrive:
    """Lines `ODOMETRY i j x y heading` and `LANDMARK i id x y` with the upper triangle of the covariance.

    :raises OSError: the file does not exist
    """
    steps, noises, scans, number_of = [], [], [[]], {"0": 0}
    for line in (folder / FILE).read_text().splitlines():
        kind, first, second, *figures = line.split()
        numbers = np.array(figures, dtype=float)
        if kind == "ODOMETRY":
            steps.append(numbers[:3])
            noises.append(_symmetric(numbers[3:], 3))
            number_of[second] = len(scans)
            scans.append([])
        else:
            observation = sextant.Observation2D(numbers[:2], _symmetric(numbers[2:], 2))
            scans[number_of[first]].append((int(second), observation))
    return RecordedDrive(np.array(steps), np.array(noises), scans)


def _symmetric(upper: np.ndarray, size: int) -> np.ndarray:
    matrix = np.zeros((size, size))
    matrix[np.triu_indices(size)] = upper
    return matrix + np.triu(matrix, 1).T


# Conventions for the frame of the odometry noise; the core uses the frame at the beginning of a step.


def _noise_at_end(step: np.ndarray) -> np.ndarray:
    """X' = X U exp(w) = X exp(Ad w) U."""
    return _adjoint(step, rotation(step[2]))


def _noise_in_components(step: np.ndarray) -> np.ndarray:
    """U + w: translation noise in the frame at the beginning of the step, then the rotation noise."""
    return _adjoint(step, np.eye(2))


def _adjoint(step: np.ndarray, axes: np.ndarray) -> np.ndarray:
    turned = np.eye(3)
    turned[:2, :2], turned[:2, 2] = axes, (step[1], -step[0])
    return turned


NOISE_FRAMES = {
    "at the step's end": _noise_at_end,
    "in its components": _noise_in_components,
    "at its beginning": lambda step: np.eye(3),
}


def with_noise_frame(drive: RecordedDrive, where: str) -> RecordedDrive:
    """The drive with the noise transformed to the frame that the core uses.

    :param where: one of NOISE_FRAMES, the convention of the data
    """
    turned = [NOISE_FRAMES[where](step) for step in drive.steps]
    noises = [T @ noise @ T.T for T, noise in zip(turned, drive.noises)]
    return drive._replace(noises=np.array(noises))


def tree_counts(drive: RecordedDrive) -> Dict[int, int]:
    """Number of observations by id."""
    ids, counts = np.unique([tree for scan in drive.scans for tree, _ in scan], return_counts=True)
    return dict(zip(map(int, ids), map(int, counts)))
