# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What makes a drive difficult, of the recorded drives and of the simulated ones that imitate them.

A gap is a time without any observation. Motion and errors of odometry are those between two scans a time
apart, relative to the most probable drive with known ids. Odometry has the scales that were estimated.
"""

from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Dict, List, Tuple

import numpy as np
from tables import Table, Value

from landmarks.commanded_drive import read_commanded_drive, recorded_drives
from landmarks.landmark_real_drives import most_probable_drive, odometry_at_scans
from landmarks.landmark_realistic import DURATION, SEPARATIONS, realistic_world, simulated_drive
from landmarks.stamped_drive import KNOWN, LABELS, StampedDrive, estimated
from sextant.geometry.plane_poses import relative, wrapped

RUNS, QUICK_RUNS, QUICK_DURATION = 15, 1, 300.0  # simulated drives, seconds
FIRST_SEED = 1000  # of drives other than those of landmark_realistic
BLIND = 2.0  # seconds: shortest gap that counts as blind
FIRST = (10.0, 30.0)  # seconds of a drive
GAPS = (3.0, 10.0, 20.0)  # seconds
PER = 1500.0  # seconds: numbers of gaps are in so much time
APART, LATER = 10.0, 1.2  # seconds between two scans, at least; at most so many times that
LEAST, MOST = 0.6, 1.7  # simulated over recorded
COLUMNS = [
    "observations a second",
    "blind, % of the time",
    *(f"landmarks in the first {first:g} s" for first in FIRST),
    *(f"gaps > {gap:g} s in 25 min" for gap in GAPS),
    f"moved in {APART:g} s, m",
    "turned, rad",
    "odometry off, m: median",
    "m: 95 %",
    "rad: median",
    "rad: 95 %",
]
DIGITS = [2, 0, *[1] * len(FIRST), *[1] * len(GAPS), 2, 2, 3, 3, 3, 3]


def drive_figure_tables(folder: Path, quick: bool) -> List[Table]:
    """One table; a quick run is of one drive of each kind, without bars. :raises OSError: there is no data"""
    drives = recorded_drives(folder, quick)
    runs, duration = (QUICK_RUNS, QUICK_DURATION) if quick else (RUNS, DURATION)
    seeds = range(FIRST_SEED, FIRST_SEED + runs)
    with ProcessPoolExecutor() as pool:
        recorded = np.mean(list(pool.map(_of_recorded, *zip(*drives))), axis=0)
        simulated = np.mean(list(pool.map(_of_simulated, seeds, [duration] * runs)), axis=0)
    bars: Dict[str, float] = {} if quick else {"at_least": LEAST, "at_most": MOST}
    rows = [
        (f"{len(drives)} recorded drives", [Value(*each) for each in zip(recorded, DIGITS)]),
        (f"{runs} simulated drives", [Value(*each) for each in zip(simulated, DIGITS)]),
        ("simulated over recorded", [Value(ratio, 2, **bars) for ratio in simulated / recorded]),
    ]
    return [Table("What makes drives difficult: means over drives", COLUMNS, rows)]


def _of_recorded(folder: Path, number: int, robot: int) -> np.ndarray:
    return figures_of(read_commanded_drive(folder, number, robot))


def _of_simulated(seed: int, duration: float) -> np.ndarray:
    return figures_of(simulated_drive(realistic_world(seed, SEPARATIONS["three classes"], duration))[0])


def figures_of(drive: StampedDrive) -> np.ndarray:
    """One figure for each of COLUMNS."""
    stamps = np.array([stamp for stamp, _ in drive.scans])
    duration, gaps = drive.stamps[-1] - drive.stamps[0], np.diff(stamps)
    observations = sum(len(sightings) for _, sightings in drive.scans)
    in_sight = [observations / duration, 100 * gaps[gaps > BLIND].sum() / duration]
    first = [_distinct(drive, end) for end in FIRST]
    frequent = [(gaps > gap).sum() * PER / duration for gap in GAPS]
    return np.array([*in_sight, *first, *frequent, *_motion(drive, stamps)])


def _distinct(drive: StampedDrive, end: float) -> int:
    return len({each.subject for stamp, sightings in drive.scans if stamp < end for each in sightings})


def _motion(drive: StampedDrive, stamps: np.ndarray) -> List[float]:
    known = estimated(drive, LABELS[KNOWN])
    reference, _ = most_probable_drive(drive, known)
    odometry = odometry_at_scans(drive, known)
    moved, off = [], []
    for first, second in _pairs(stamps):
        step = relative(reference[first], reference[second])
        moved.append(_lengths(step))
        off.append(_lengths(step - relative(odometry[first], odometry[second])))
    medians, extremes = np.percentile(off, [50, 95], axis=0)
    return [*np.mean(moved, axis=0), medians[0], extremes[0], medians[1], extremes[1]]


def _pairs(stamps: np.ndarray) -> List[Tuple[int, int]]:
    """Indices of scans that are APART."""
    later = np.searchsorted(stamps, stamps + APART)
    pairs = [(first, second) for first, second in enumerate(later) if second < len(stamps)]
    return [pair for pair in pairs if stamps[pair[1]] - stamps[pair[0]] < LATER * APART]


def _lengths(step: np.ndarray) -> Tuple[float, float]:
    return float(np.hypot(step[0], step[1])), abs(float(wrapped(step[2])))
