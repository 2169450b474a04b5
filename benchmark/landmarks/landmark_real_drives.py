# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Recorded drives of 23 to 31 minutes among 15 landmarks, with and without the ids of the landmarks.

`three classes`: the remainder of the id divided by three; `one class`: all are alike. The reference of the
poses is the most probable drive of all commands and observations with known ids, with the scales and the
clock offset that the filter estimated with known ids. Positions are those of the survey.
"""

from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Dict, List, Tuple

import numpy as np
from tables import Table, Value

import sextant
from landmarks.commanded_drive import read_commanded_drive, recorded_drives
from landmarks.most_probable_drive import DriveGraph, most_probable
from landmarks.stamped_drive import (
    KNOWN,
    LABELS,
    Estimate,
    Score,
    StampedDrive,
    estimated,
    score,
    slam_params,
)
from sextant.geometry.plane_poses import composed, relative

STANDS = 1e-6  # m and rad: a standing robot's standard deviation between two scans
COLUMNS = [
    "maps exact",
    "landmarks right: least",
    "drives lost",
    "wrong associations, %",
    "landmarks, m (median)",
    "over known ids",
    "pose, m (median)",
    "over known ids: median",
    "worst",
    "s a drive",
]


def real_drive_tables(folder: Path, quick: bool) -> List[Table]:
    """One table; a quick run is of few drives, without bars. :raises OSError: there is no data"""
    drives = recorded_drives(folder, quick)
    with ProcessPoolExecutor() as pool:
        scores = np.array(list(pool.map(_scores, *zip(*drives))), dtype=float)  # drive, row, field
    rows = [
        (name, _figures(name, Score(*of.T), Score(*scores[:, 0].T), quick))
        for name, of in zip(LABELS, scores.transpose(1, 0, 2))
    ]
    return [Table(f"{len(drives)} recorded drives among 15 landmarks", COLUMNS, rows)]


def _figures(name: str, of: Score, known: Score, quick: bool) -> List[Value]:
    exact, right, most = _bars(name) if not quick else (None, None, None)
    ratios = of.pose / known.pose
    return [
        Value(of.is_exact.sum(), 0, at_least=exact),
        Value(of.right.min(), 0, at_least=right),
        Value(of.is_lost.sum(), 0, at_most=None if quick or name == KNOWN else 0),
        Value(100 * of.wrong.mean(), 2),
        Value(np.median(of.landmarks), 3),
        Value(np.median(of.landmarks / known.landmarks), 2, at_most=most),
        Value(np.median(of.pose), 3),
        Value(np.median(ratios), 2, at_most=most),
        Value(ratios.max(), 2),
        Value(np.median(of.seconds), 1),
    ]


def _bars(name: str) -> Tuple:
    """Least number of exact maps and of right landmarks, most of the errors over those with known ids."""
    return {"three classes": (14, None, 1.2), "one class": (None, 12, None)}.get(name, (None, None, None))


def _scores(folder: Path, number: int, robot: int) -> List[Score]:
    """By row."""
    drive = read_commanded_drive(folder, number, robot)
    estimates = {name: estimated(drive, label) for name, label in LABELS.items()}
    reference = most_probable_drive(drive, estimates[KNOWN])
    return [score(drive, each, *reference) for each in estimates.values()]


def most_probable_drive(drive: StampedDrive, known: Estimate) -> Tuple[np.ndarray, Dict[int, np.ndarray]]:
    """Poses (n, 3) after each scan and positions (2,) of the landmarks, with the known ids.

    :param known: where the search begins
    """
    stamps = np.array([stamp for stamp, _ in drive.scans]) + known.clock_offset
    at_scans = odometry_at_scans(drive, known)
    steps = np.array([relative(*pair) for pair in zip(at_scans, at_scans[1:])])
    index_of = {subject: index for index, subject in enumerate(known.subjects)}
    seen, observations = [], []
    for number, (_, sightings) in enumerate(drive.scans):
        for each in sightings:
            if each.subject in index_of:  # not of a landmark that is observed too rarely to be in the map
                seen.append((number, index_of[each.subject]))
                observations.append(each.observation)
    positions = np.array([each.position for each in observations])
    covariances = np.array([each.covariance[:2, :2] for each in observations])
    graph = DriveGraph(steps, _step_noises(drive, stamps), np.array(seen), positions, covariances)
    poses, landmarks, _ = most_probable(graph, known.poses, known.landmarks)
    return poses, dict(zip(known.subjects, landmarks))


def odometry_at_scans(drive: StampedDrive, known: Estimate) -> np.ndarray:
    """Poses (n, 3) at the scans, by odometry with the scales and the clock offset that were estimated."""
    stamps = np.array([stamp for stamp, _ in drive.scans]) + known.clock_offset
    stamps = np.clip(stamps, drive.stamps[0], drive.stamps[-1])
    scales = np.array([known.scale, known.scale, known.turn_scale])
    poses = [drive.poses[0]]
    for pair in zip(drive.poses, drive.poses[1:]):
        poses.append(composed(poses[-1], relative(*pair) * scales))
    x, y, headings = np.transpose(poses)
    columns = [x, y, np.unwrap(headings)]
    return np.column_stack([np.interp(stamps, drive.stamps, column) for column in columns])


def _step_noises(drive: StampedDrive, stamps: np.ndarray) -> np.ndarray:
    """Covariances (n - 1, 3, 3) of the steps between stamps: they grow with the path, not with its ends."""
    parts = np.diff(drive.poses, axis=0)
    driven = np.concatenate([[0.0], np.cumsum(np.hypot(parts[:, 0], parts[:, 1]))])
    turned = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(np.unwrap(drive.poses[:, 2]))))])
    ways, turns = (np.diff(np.interp(stamps, drive.stamps, each)) for each in (driven, turned))
    noise = slam_params().timeline.odometry
    noises = [sextant.odometry_step_noise([way, 0.0, turn], noise) for way, turn in zip(ways, turns)]
    return np.array(noises) + STANDS**2 * np.eye(3)
