# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Maps of the recorded drives by all observations, as map_landmarks makes them without the ids.

The reference is the most probable map with known ids, by another implementation. A landmark is that of the
reference which is nearest. Positions are those of the survey.
"""

import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import List, NamedTuple

import numpy as np
from tables import Table, Value

from landmarks.commanded_drive import read_commanded_drive, recorded_drives
from landmarks.landmark_drives import rms
from landmarks.landmark_real_drives import most_probable_drive
from landmarks.stamped_drive import (
    KNOWN,
    LABELS,
    RIGHT,
    StampedDrive,
    aligned,
    arriving,
    estimated,
    labelled,
    slam_params,
)
from sextant.landmarks.batch_map import batch_map
from sextant.landmarks.slam_run import SlamRun

COLUMNS = [
    "maps exact",
    "landmarks, m (median)",
    "over known ids: median",
    "worst",
    "s a drive (median)",
    "worst",
]
LARGEST_RATIO = 1.05  # of the errors over those with known ids


class MapScore(NamedTuple):
    """Of one drive."""

    is_exact: bool
    landmarks: float  # RMSE, m
    ratio: float  # over that with known ids
    seconds: float


def batch_tables(folder: Path, quick: bool) -> List[Table]:
    """One table; a quick run is of one drive, without bars. :raises OSError: there is no data"""
    drives = recorded_drives(folder, quick)
    with ProcessPoolExecutor() as pool:
        scores = list(pool.map(_scores, *zip(*drives)))
    names = [name for name in LABELS if name != KNOWN]
    rows = [(name, _figures(MapScore(*zip(*of)), quick)) for name, of in zip(names, zip(*scores))]
    return [Table(f"maps of {len(drives)} recorded drives by all observations", COLUMNS, rows)]


def _figures(of: MapScore, quick: bool) -> List[Value]:
    return [
        Value(sum(of.is_exact), 0),
        Value(np.median(of.landmarks), 3),
        Value(np.median(of.ratio), 3, at_most=None if quick else LARGEST_RATIO),
        Value(np.max(of.ratio), 3),
        Value(np.median(of.seconds), 1),
        Value(np.max(of.seconds), 1),
    ]


def _scores(folder: Path, number: int, robot: int) -> List[MapScore]:
    drive = read_commanded_drive(folder, number, robot)
    _, known = most_probable_drive(drive, estimated(drive, LABELS[KNOWN]))
    surveyed = np.array([drive.positions[subject] for subject in known])
    reference = rms(aligned(np.array(list(known.values())), surveyed)[1] ** 2)
    return [_score(drive, known, reference, label) for name, label in LABELS.items() if name != KNOWN]


def _score(drive: StampedDrive, known: dict, reference: float, label) -> MapScore:
    run, begin = _run(drive, label), time.process_time()
    found = np.array([each.position for each in batch_map(run).map.landmarks])
    seconds = time.process_time() - begin
    subjects = list(known)
    nearest = [int(np.hypot(*(np.array(list(known.values())) - each).T).argmin()) for each in found]
    surveyed = np.array([drive.positions[subjects[index]] for index in nearest])
    _, distances = aligned(found, surveyed)
    right = {index for index, distance in zip(nearest, distances) if distance < RIGHT}
    error = rms(distances**2)
    return MapScore(len(right) == len(found) == len(drive.positions), error, error / reference, seconds)


def _run(drive: StampedDrive, label) -> SlamRun:
    run = SlamRun(slam_params())
    for stamp, sightings in arriving(drive, _Nanoseconds(run)):
        run.observe(round(1e9 * stamp), [labelled(each, label) for each in sightings], np.zeros(3))
    return run


class _Nanoseconds:
    """Takes odometry with its stamp in seconds."""

    def __init__(self, run: SlamRun):
        self._run = run

    def odometry(self, stamp: float, pose: np.ndarray) -> None:
        """Adds a pose (3,)."""
        self._run.odometry(round(1e9 * stamp), pose)
