# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A simulated world with the faults of real drives, with and without the ids of the landmarks.

Odometry is the command: it leads the motion, its distances and angles have scales. Ranges have gross errors,
the sensor's mount is off, nothing is detected for a while, and detections jump between neighbours. Each drive
draws its faults from the ranges FAULTS, which are those of the recorded drives, as are motion and noise in
WORLD (landmark_drive_figures compares them); the filter is given the same parameters as there. Drives begin
at the edge, where many landmarks are in view, as there. NEES is over its three degrees of freedom.
"""

from concurrent.futures import ProcessPoolExecutor
from typing import Dict, List, NamedTuple, Optional, Tuple

import numpy as np
from tables import Table, Value

from landmarks.landmark_drives import nees, pose_error
from landmarks.stamped_drive import (
    FIRST_LANDMARK,
    KNOWN,
    LABELS,
    Estimate,
    Score,
    Sighting,
    StampedDrive,
    estimated,
    observation_of,
    score,
)
from sextant.geometry.plane_poses import composed, in_frame, relative
from sextant.simulation.landmark_world import LandmarkScan, LandmarkWorld, LandmarkWorldParams

RUNS, DURATION = 100, 720.0  # seconds
QUICK_RUNS, QUICK_DURATION = 2, 240.0
FAULTS: Dict[str, Tuple[float, float]] = {  # least and largest
    "scale": (1 / 0.95, 1 / 0.88),
    "turn_scale": (1 / 0.93, 1 / 0.86),
    "lead": (0.15, 0.2),
    "bearing_noise": (0.006, 0.018),
    "bearing_offset": (-0.014, 0.014),
    "gross_error_probability": (0.001, 0.02),
    "gap_probability": (0.0, 0.4),
    "detection_probability": (0.1, 0.5),
    "jump_probability": (0.0, 0.01),
}
RANGE_NOISE = (0.07, 0.18)  # m
WORLD = {
    "landmarks": 15,
    "half_side": 4.5,
    "max_range": 6.0,
    "field_of_view": 1.2,
    "speed": 0.055,
    "turn_rate": 0.18,
    "rotation_from_rotation": 0.12,
    "rotation_from_translation": 0.05,
    "translation_from_translation": 0.08,
    "translation_from_rotation": 0.03,
    "lateral_from_translation": 0.05,
}
START, TURNED = 0.75, 1.0  # distance from the centre, of half_side; largest angle to its direction, rad
SEPARATIONS = {KNOWN: 0.4, "three classes": 0.4, "one class": 0.8}  # m, between two landmarks
COLUMNS = [
    "maps exact, %",
    "landmarks right: least",
    "drives lost",
    "wrong associations, %",
    "landmarks, m (median)",
    "pose, m (median)",
    "over known ids: median",
    "worst",
    "pose NEES",
    "s a drive",
]


class Judged(NamedTuple):
    """A drive with one kind of labels."""

    score: Score
    nees: float  # mean over the published poses
    over_known: float  # RMSE of the pose over that with known ids


NEES = (0.8, 1.5)  # over its degrees of freedom


class Bars(NamedTuple):
    """Limits of one row; None: no limit."""

    exact: Optional[float] = None  # %
    right: Optional[float] = None
    lost: Optional[float] = None
    ratio: Optional[float] = None
    worst: Optional[float] = None
    nees: Tuple[Optional[float], Optional[float]] = NEES


NONE = Bars(nees=(None, None))
BARS = {
    KNOWN: Bars(),
    "three classes": Bars(exact=95, lost=0, ratio=1.1, worst=2),
    "one class": Bars(exact=80, right=12, lost=0),
}


def realistic_tables(quick: bool) -> List[Table]:
    """One table; a quick run has few short drives, without bars."""
    runs, duration = (QUICK_RUNS, QUICK_DURATION) if quick else (RUNS, DURATION)
    rows = []
    with ProcessPoolExecutor() as pool:
        for name in LABELS:
            judged = list(pool.map(judge, range(runs), [name] * runs, [duration] * runs))
            rows.append((name, _figures(judged, NONE if quick else BARS[name])))
    return [Table(f"{runs} simulated drives of {duration:g} s with the faults of real ones", COLUMNS, rows)]


def _figures(judged: List[Judged], bars: Bars) -> List[Value]:
    scores = Score(*np.array([each.score for each in judged], dtype=float).T)
    ratios = np.array([each.over_known for each in judged])
    low, high = bars.nees
    return [
        Value(100 * scores.is_exact.mean(), 0, at_least=bars.exact),
        Value(scores.right.min(), 0, at_least=bars.right),
        Value(scores.is_lost.sum(), 0, at_most=bars.lost),
        Value(100 * scores.wrong.mean(), 2),
        Value(np.median(scores.landmarks), 3),
        Value(np.median(scores.pose), 3),
        Value(np.median(ratios), 2, at_most=bars.ratio),
        Value(ratios.max(), 2, at_most=bars.worst),
        Value(np.mean([each.nees for each in judged]), 2, at_least=low, at_most=high),
        Value(np.median(scores.seconds), 1),
    ]


def judge(seed: int, name: str, duration: float) -> Judged:
    """One drive with these labels and with known ids."""
    world = realistic_world(seed, SEPARATIONS[name], duration)
    drive, truth = simulated_drive(world)
    scan_stamps = np.array([stamp for stamp, _ in drive.scans])
    reference = truth[np.searchsorted(drive.stamps, scan_stamps - 1e-6)]
    found = estimated(drive, LABELS[name])
    known = found if name == KNOWN else estimated(drive, LABELS[KNOWN])
    own, with_ids = (score(drive, each, reference, drive.positions) for each in (found, known))
    nees_of_pose = _mean_nees(drive, truth, found, world.params.lead)
    return Judged(own, nees_of_pose, own.pose / with_ids.pose)


def realistic_world(seed: int, min_separation: float, duration: float) -> LandmarkWorld:
    """Faults and start drawn from the seed."""
    rng = np.random.default_rng([seed, 2])
    faults = {name: rng.uniform(*limits) for name, limits in FAULTS.items()}
    noise = (rng.uniform(*RANGE_NOISE), 0.0)
    params = LandmarkWorldParams(
        seed=seed, duration=duration, min_separation=min_separation, range_noise=noise, **WORLD, **faults
    )
    world = LandmarkWorld(params)
    centre = rng.uniform(-np.pi, np.pi)  # its direction
    position = -START * params.half_side * np.array([np.cos(centre), np.sin(centre)])
    world.start = np.array([*position, centre + rng.uniform(-TURNED, TURNED)])
    return world


def simulated_drive(world: LandmarkWorld) -> Tuple[StampedDrive, np.ndarray]:
    """The drive, and the true pose (n, 3) at each stamp of odometry; in the frame of the robot's start."""
    stamps, poses, truth, scans = [0.0], [np.zeros(3)], [np.zeros(3)], []
    for step in world.steps():
        stamps.append(step.stamp)
        poses.append(composed(poses[-1], step.odometry_step))
        truth.append(relative(world.start, step.pose))
        if step.scan and step.scan.observations:
            scans.append(_stamped(step.scan))
    last = stamps[-1] - 2.0
    positions = dict(enumerate(in_frame(world.start, world.positions), FIRST_LANDMARK))
    scans = [scan for scan in scans if scan[0] < last]
    return StampedDrive(np.array(stamps), np.array(poses), scans, positions), np.array(truth)


def _stamped(scan: LandmarkScan) -> Tuple[float, List[Sighting]]:
    sightings = []
    for seen in scan.observations:
        distance, bearing = np.hypot(*seen.position), np.arctan2(seen.position[1], seen.position[0])
        sightings.append(Sighting(FIRST_LANDMARK + seen.truth, observation_of(distance, bearing)))
    return scan.stamp, sightings


def _mean_nees(drive: StampedDrive, truth: np.ndarray, found: Estimate, lead: float) -> float:
    """Of the published poses, which the robot reaches when it follows the command; over three."""
    values = []
    for stamp, pose, covariance in found.now:
        at = min(int(np.searchsorted(drive.stamps, stamp + lead - 1e-6)), len(truth) - 1)
        values.append(nees(pose_error(truth[at], pose), covariance) / 3)
    return float(np.mean(values))
