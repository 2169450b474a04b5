# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Correctness of the map with unknown data association.

A map is exact if it contains every landmark that was in view often enough exactly once, with its class, and
nothing else. Often enough is the default of candidates: more than 3 observations, at most 10 s apart. A
landmark is assigned to the most likely true one of its class by its covariance, or to none beyond the 99.99 %
quantile.
"""

from typing import Dict, List, NamedTuple, Optional, Set, Tuple

import numpy as np
from scipy.stats import chi2
from tables import Row, Table, Value

import sextant
from landmarks.landmark_drives import EXACT, labelled, nees, pose_error, rms, slam_params
from sextant.simulation.landmark_world import LandmarkWorld, LandmarkWorldParams, SimulatedObservation

RUNS, DURATION = 50, 300.0  # seconds
OFTEN = sextant.LandmarkSlamParams().candidates  # observations; max_age, seconds
PLACE = chi2.ppf(0.9999, 2)  # squared Mahalanobis distance
COLUMNS = [
    "maps exact, %",
    "missing",
    "too many",
    "wrong associations",
    "ambiguous, %",
    "pose NEES",
    "pose, cm",
]


class Trouble(NamedTuple):
    """Errors of the sensor, and the minimum share of exact maps."""

    detection_probability: float
    false_alarm_probability: float
    exact: float  # %, minimum share of exact maps


TROUBLES = {
    "a faultless sensor": Trouble(1.0, 0.0, 98.0),
    "20 % missed, 5 % false alarms": Trouble(0.8, 0.05, 95.0),
}


class Drive(NamedTuple):
    """Result of one drive."""

    lacking: int  # landmarks
    too_many: int
    wrong: int  # observations associated with the wrong landmark
    ambiguous: int
    observations: int
    nees: np.ndarray  # of the pose, after every scan
    squares: np.ndarray  # of its position error, square metres


def association_tables(quick: bool) -> List[Table]:
    """One table; a quick run is of few short drives, without bars."""
    runs, duration = (3, 20.0) if quick else (RUNS, DURATION)
    rows = [_row(name, trouble, runs, duration, quick) for name, trouble in TROUBLES.items()]
    return [Table(f"{runs} drives of {duration:g} s among 15 landmarks, unknown association", COLUMNS, rows)]


def _row(name: str, trouble: Trouble, runs: int, duration: float, quick: bool) -> Row:
    of_all = {
        "duration": duration,
        "detection_probability": trouble.detection_probability,
        "false_alarm_probability": trouble.false_alarm_probability,
    }
    worlds = [LandmarkWorld(LandmarkWorldParams(seed=seed, **of_all)) for seed in range(runs)]
    drives = list(map(driven, worlds))
    exact = np.mean([not drive.lacking and not drive.too_many for drive in drives])
    lacking, too_many, wrong, ambiguous, observations = np.sum([drive[:5] for drive in drives], axis=0)
    return name, [
        Value(100 * exact, 0, at_least=None if quick else trouble.exact),
        Value(lacking, 0),
        Value(too_many, 0),
        Value(wrong, 0),
        Value(100 * ambiguous / observations, 1),
        Value(np.mean([drive.nees for drive in drives]) / 3, 3),
        Value(100 * rms(np.array([drive.squares for drive in drives])), 2),
    ]


def driven(world: LandmarkWorld) -> Drive:
    """The world's drive with LandmarkSlam."""
    slam, journal = sextant.LandmarkSlam(slam_params(world.params), world.start, EXACT), Journal()
    nees_of_pose, squares = [], []
    for step in world.steps():
        slam.predict(step.odometry_step, step.noise, 1 / world.params.odometry_rate)
        if step.scan:
            report = slam.observe(step.scan.stamp, labelled(step.scan.observations))
            journal.note(step.scan.stamp, step.scan.observations, report)
            error = pose_error(step.pose, slam.filter.pose)
            nees_of_pose.append(nees(error, slam.filter.pose_covariance))
            squares.append(error[:2] @ error[:2])
    strays, found = _found(world, slam)
    lacking = sum(landmark not in found for landmark in journal.often)
    too_many = strays + len(found) - len(journal.often & set(found))
    counts = journal.wrong, journal.ambiguous, journal.observations
    return Drive(lacking, too_many, *counts, np.array(nees_of_pose), np.array(squares))


class Journal:
    """Observations and their associations."""

    def __init__(self) -> None:
        self.often: Set[int] = set()  # true landmarks that were in view often enough
        self.wrong = self.ambiguous = self.observations = 0
        self._lately: Dict[int, List[float]] = {}  # stamps, at most OFTEN.max_age apart
        self._truth_of: Dict[int, Optional[int]] = {}  # by key of the map's landmarks

    def note(self, stamp: float, observations: List[SimulatedObservation], report) -> None:
        """A scan and its LandmarkReport."""
        self.ambiguous += report.ambiguous
        self.observations += len(observations)
        for seen, key in zip(observations, report.keys):
            if seen.truth is not None:
                self._note_truth(stamp, seen.truth)
            if key is not None:
                self.wrong += self._truth_of.setdefault(key, seen.truth) != seen.truth

    def _note_truth(self, stamp: float, truth: int) -> None:
        lately = self._lately.setdefault(truth, [])
        if lately and stamp - lately[-1] > OFTEN.max_age:
            lately.clear()
        lately.append(stamp)
        if len(lately) > OFTEN.observations:
            self.often.add(truth)


def _found(world: LandmarkWorld, slam) -> Tuple[int, List[int]]:
    """Number of landmarks without a true one, and the true one of each of the others."""
    P, classes = slam.filter.covariance, np.array(world.classes)
    strays, found = 0, []
    for at, (landmark, label) in enumerate(zip(slam.filter.landmarks, slam.labels)):
        off, block = world.positions - landmark.position, P[3 + 2 * at : 5 + 2 * at, 3 + 2 * at : 5 + 2 * at]
        distances = np.sum(off * np.linalg.solve(block, off.T).T, axis=1)
        distances[classes != label.class_name] = np.inf
        if distances.min() < PLACE:
            found.append(int(distances.argmin()))
        else:
            strays += 1
    return strays, found
