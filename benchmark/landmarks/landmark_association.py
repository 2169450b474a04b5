# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whether the map has what stands in the world, where nobody says which landmark a sighting is of.

A drive's map is exact when each landmark that was in view often enough is in it once, with its class, and it
holds nothing else. Often enough is the default of candidates: more than 3 sightings, none more than 10 s
after the one before it. A landmark stands for the true one of its class that is the likeliest by its
covariance, and for none where that is less likely than one in ten thousand.
"""

from typing import Dict, List, NamedTuple, Optional, Set, Tuple

import numpy as np
from scipy.stats import chi2
from tables import Row, Table, Value

import sextant
from landmarks.landmark_drives import EXACT, labelled, nees, pose_error, rms, slam_params
from sextant.simulation.landmark_world import LandmarkWorld, LandmarkWorldParams, SeenLandmark

RUNS, DURATION = 50, 300.0  # seconds
OFTEN = sextant.LandmarkSlamParams().candidates  # sightings that a candidate needs more of; memory, seconds
PLACE = chi2.ppf(0.9999, 2)  # squared Mahalanobis distance
COLUMNS = [
    "maps exact, %",
    "lacking",
    "too many",
    "wrong associations",
    "doubtful, %",
    "pose NEES",
    "pose, cm",
]


class Trouble(NamedTuple):
    """What is wrong with what the sensor says, and how many maps have to be exact all the same."""

    missed: float
    phantoms: float
    exact: float  # %, at least


TROUBLES = {
    "a faultless sensor": Trouble(0.0, 0.0, 98.0),
    "20 % missed, 5 % phantoms": Trouble(0.2, 0.05, 95.0),
}


class Drive(NamedTuple):
    """What became of one drive."""

    lacking: int  # landmarks
    too_many: int
    wrong: int  # sightings that were taken for another landmark's
    doubtful: int
    sightings: int
    nees: np.ndarray  # of the pose, after every look
    squares: np.ndarray  # of its position error, square metres


def association_tables(quick: bool) -> List[Table]:
    """One table; a quick run is of few short drives, without bars."""
    runs, duration = (3, 20.0) if quick else (RUNS, DURATION)
    rows = [_row(name, trouble, runs, duration, quick) for name, trouble in TROUBLES.items()]
    return [Table(f"{runs} drives of {duration:g} s among 15 landmarks, unknown association", COLUMNS, rows)]


def _row(name: str, trouble: Trouble, runs: int, duration: float, quick: bool) -> Row:
    of_all = {"duration": duration, "missed": trouble.missed, "phantoms": trouble.phantoms}
    worlds = [LandmarkWorld(LandmarkWorldParams(seed=seed, **of_all)) for seed in range(runs)]
    drives = list(map(driven, worlds))
    exact = np.mean([not drive.lacking and not drive.too_many for drive in drives])
    lacking, too_many, wrong, doubtful, sightings = np.sum([drive[:5] for drive in drives], axis=0)
    return name, [
        Value(100 * exact, 0, at_least=None if quick else trouble.exact),
        Value(lacking, 0),
        Value(too_many, 0),
        Value(wrong, 0),
        Value(100 * doubtful / sightings, 1),
        Value(np.mean([drive.nees for drive in drives]) / 3, 3),
        Value(100 * rms(np.array([drive.squares for drive in drives])), 2),
    ]


def driven(world: LandmarkWorld) -> Drive:
    """The world's drive with LandmarkSlam."""
    slam, journal = sextant.LandmarkSlam(slam_params(world.params), world.start, EXACT), Journal()
    nees_of_pose, squares = [], []
    for moment in world.moments():
        slam.predict(moment.step, moment.noise, 1 / world.params.odometry_rate)
        if moment.look:
            report = slam.see(moment.look.stamp, labelled(moment.look.sightings))
            journal.note(moment.look.stamp, moment.look.sightings, report)
            error = pose_error(moment.pose, slam.filter.pose)
            nees_of_pose.append(nees(error, slam.filter.pose_covariance))
            squares.append(error[:2] @ error[:2])
    strays, found = _found(world, slam)
    lacking = sum(landmark not in found for landmark in journal.often)
    too_many = strays + len(found) - len(journal.often & set(found))
    counts = journal.wrong, journal.doubtful, journal.sightings
    return Drive(lacking, too_many, *counts, np.array(nees_of_pose), np.array(squares))


class Journal:
    """What was seen, and what it was taken for."""

    def __init__(self) -> None:
        self.often: Set[int] = set()  # true landmarks that were in view often enough
        self.wrong = self.doubtful = self.sightings = 0
        self._lately: Dict[int, List[float]] = {}  # stamps, none OFTEN.memory after the one before
        self._truth_of: Dict[int, Optional[int]] = {}  # by key of the map's landmarks

    def note(self, stamp: float, sightings: List[SeenLandmark], report) -> None:
        """A look and its LandmarkReport."""
        self.doubtful += report.doubtful
        self.sightings += len(sightings)
        for seen, key in zip(sightings, report.keys):
            if seen.truth is not None:
                self._note_truth(stamp, seen.truth)
            if key is not None:
                self.wrong += self._truth_of.setdefault(key, seen.truth) != seen.truth

    def _note_truth(self, stamp: float, truth: int) -> None:
        lately = self._lately.setdefault(truth, [])
        if lately and stamp - lately[-1] > OFTEN.memory:
            lately.clear()
        lately.append(stamp)
        if len(lately) > OFTEN.sightings:
            self.often.add(truth)


def _found(world: LandmarkWorld, slam) -> Tuple[int, List[int]]:
    """Number of landmarks that stand for nothing, and the true one of each of the others."""
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
