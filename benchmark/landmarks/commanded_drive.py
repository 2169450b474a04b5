# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Recorded drives of the UTIAS MRCLAM dataset (Leung, Halpern, Barfoot and Liu 2011): odometry is the
command, landmarks are tubes with barcodes, so that their ids are known."""

import csv
import gzip
from pathlib import Path
from typing import Dict, List, Tuple

import numpy as np

from landmarks.stamped_drive import FIRST_LANDMARK, Sighting, StampedDrive, observation_of
from sextant.geometry.plane_poses import composed

SETS, ROBOTS, QUICK = (1, 2, 4), range(1, 6), 1  # of a quick run: drives
MARGIN = 2.0  # seconds between the last sighting and the last command
LONGEST_COMMAND = 0.5  # seconds that a command lasts
# The survey of this set has these two the wrong way round: each is 6.04 m off in all five drives.
EXCHANGED: Dict[int, Tuple[int, int]] = {1: (11, 17)}


def recorded_drives(folder: Path, quick: bool) -> List[Tuple[Path, int, int]]:
    """Arguments of read_commanded_drive() for each drive."""
    return [(folder, number, robot) for number in SETS for robot in ROBOTS][: QUICK if quick else None]


def read_commanded_drive(folder: Path, number: int, robot: int) -> StampedDrive:
    """:raises OSError: a file does not exist"""
    commands = _table(folder / str(number) / f"robot{robot}_odometry.csv.gz")
    sightings = _table(folder / str(number) / f"robot{robot}_sightings.csv.gz")
    first, scans = commands[0, 0], {}
    used = (sightings[:, 1] >= FIRST_LANDMARK) & (sightings[:, 0] < commands[-1, 0] - MARGIN)
    for stamp, subject, distance, bearing in sightings[used]:
        scans.setdefault(stamp - first, []).append(Sighting(int(subject), observation_of(distance, bearing)))
    surveyed = _table(folder / str(number) / "landmarks.csv")
    positions = {int(subject): np.array(xy) for subject, *xy in surveyed}
    if number in EXCHANGED:
        one, other = EXCHANGED[number]
        positions[one], positions[other] = positions[other], positions[one]
    return StampedDrive(commands[:, 0] - first, _added_up(commands), sorted(scans.items()), positions)


def _table(path: Path) -> np.ndarray:
    with gzip.open(path, "rt") if path.suffix == ".gz" else open(path) as file:
        return np.array(list(csv.reader(file))[1:], dtype=float)


def _added_up(commands: np.ndarray) -> np.ndarray:
    poses = [np.zeros(3)]
    for (stamp, speed, turn_rate), after in zip(commands, commands[1:, 0]):
        duration = min(after - stamp, LONGEST_COMMAND)
        half = 0.5 * turn_rate * duration
        step = np.array([speed * duration * np.cos(half), speed * duration * np.sin(half), 2 * half])
        poses.append(composed(poses[-1], step))
    return np.array(poses)
