# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Long drives whose odometry is the command, with and without the ids of the landmarks.

The same parameters for all of them, as landmark_slam takes them. A landmark is right within RIGHT of its true
position, after the map was aligned with the true one; which one it is, is that of most of its observations.
The pose is compared in the map, too, as its frame is that of the first poses, which no landmark confirms.
A drive is lost if the robot does not know its pose at the end, or if the RMSE of its pose in the last quarter
is above LOST.
"""

import time
from collections import Counter, defaultdict
from typing import Callable, Dict, Iterator, List, NamedTuple, Tuple

import numpy as np

import sextant
from landmarks.landmark_drives import rms
from sextant.geometry.plane_poses import composed

RIGHT, LOST = 0.5, 1.0  # metres
LAG, DELAY, EVERY = 2.0, 1.0, 4  # seconds; seconds of the scans; of the readings of odometry
FIRST_LANDMARK = 6  # subject; smaller ones are other robots
# Standard deviations that the sensor states: of the range, m (at least, and relative), and of the bearing.
RANGE, RELATIVE_RANGE, BEARING = 0.12, 0.03, 0.015
KNOWN = "known ids"
LABELS: Dict[str, Callable[[int], object]] = {
    KNOWN: lambda subject: sextant.LandmarkLabel("tube", subject),
    "three classes": lambda subject: sextant.LandmarkLabel(f"tube_{subject % 3}"),
    "one class": lambda subject: sextant.LandmarkLabel("tube"),
}


class Sighting(NamedTuple):
    """One measurement of a landmark."""

    subject: int  # id of the landmark
    observation: object  # sextant.Observation2D in the robot frame


class StampedDrive(NamedTuple):
    """A robot's drive among landmarks. Stamps are seconds."""

    stamps: np.ndarray  # (n,) of odometry
    poses: np.ndarray  # (n, 3) of odometry
    scans: List[Tuple[float, List[Sighting]]]  # by stamp
    positions: Dict[int, np.ndarray]  # true position (2,) of each landmark, m


class Estimate(NamedTuple):
    """What was estimated on one drive."""

    poses: np.ndarray  # (n, 3) after each scan
    now: List[Tuple[float, np.ndarray, np.ndarray]]  # stamp, pose (3,), covariance (3, 3): as published
    landmarks: np.ndarray  # (m, 2)
    subjects: List[int]  # id of most observations of each; 0: of none
    wrong: float  # share of the associated observations
    is_lost: bool
    scale: float  # of odometry's distances
    turn_scale: float
    clock_offset: float  # seconds
    seconds: float  # of computation


class Score(NamedTuple):
    """Of one drive."""

    is_exact: bool
    right: int  # landmarks
    is_lost: bool
    wrong: float
    landmarks: float  # RMSE, m
    pose: float  # RMSE, m
    seconds: float


def slam_params():
    """sextant.LandmarkSlamNodeParams of these robots and their cameras.

    The noise of odometry was chosen by the normalized innovations of the recorded drives with known ids.
    """
    params = sextant.LandmarkSlamNodeParams()
    params.scale_sigma, params.turn_scale_sigma, params.clock_sigma = 0.1, 0.1, 0.2
    params.rotation_from_rotation, params.rotation_from_translation = 0.1, 0.05
    params.translation_from_translation, params.translation_from_rotation = 0.05, 0.02
    params.lateral_from_translation = 0.03
    params.max_range, params.landmark_width, params.detection_probability = 6.0, 0.0, 0.5
    params.lag = LAG
    return params


def estimated(drive: StampedDrive, label: Callable[[int], object]) -> Estimate:
    """Runs the drive as landmark_slam does."""
    timeline, begin = sextant.LandmarkSession(slam_params()).timeline, time.process_time()
    votes: Dict[int, Counter] = defaultdict(Counter)  # subjects of the observations of each key
    poses, published = [], []
    for moment, sightings in arriving(drive, timeline):
        timeline.observe(moment, [labelled(each, label) for each in sightings], np.zeros(3))
        poses.append(timeline.slam.filter.pose)
        published.append(timeline.now)
        for applied in timeline.applied:
            for sighting, key in zip(sightings, applied.report.keys):
                votes[key][sighting.subject] += key is not None
    slam = timeline.slam
    known = sum(sum(each.values()) for each in votes.values())
    right = sum(max(each.values()) for each in votes.values())
    return Estimate(
        np.array(poses),
        [(each.stamp, each.pose, each.covariance) for each in published],
        np.array([each.position for each in slam.filter.landmarks]).reshape(-1, 2),
        [_most_common(votes[key]) for key in slam.keys],
        (known - right) / max(1, known),
        timeline.is_lost,
        slam.filter.scale,
        slam.filter.turn_scale,
        slam.filter.clock_offset,
        time.process_time() - begin,
    )


def _most_common(subjects: Counter) -> int:
    return subjects.most_common(1)[0][0] if subjects else 0


def arriving(drive: StampedDrive, timeline) -> Iterator[Tuple[float, List[Sighting]]]:
    """Each scan when it arrives; the timeline is given the odometry until then."""
    next_scan = 0
    for stamp, pose in zip(drive.stamps[::EVERY], drive.poses[::EVERY]):
        while next_scan < len(drive.scans) and drive.scans[next_scan][0] <= stamp - DELAY:
            yield drive.scans[next_scan]
            next_scan += 1
        timeline.odometry(stamp, pose)


def labelled(sighting: Sighting, label: Callable[[int], object]):
    """sextant.LabelledObservation with one of LABELS."""
    return sextant.LabelledObservation(label(sighting.subject), sighting.observation)


def score(
    drive: StampedDrive, found: Estimate, reference: np.ndarray, landmarks: Dict[int, np.ndarray]
) -> Score:
    """:param reference, landmarks: poses (n, 3) after each scan and positions (2,) in one frame"""
    if sum(map(bool, found.subjects)) < 2:
        return Score(False, 0, True, found.wrong, np.inf, np.inf, found.seconds)
    subjects, _, distances = _fitted(found, drive.positions)
    right = set(np.array(subjects)[distances < RIGHT])
    is_exact = len(right) == len(found.landmarks) == len(drive.positions)
    _, to_reference, _ = _fitted(found, landmarks)
    poses = np.array([composed(to_reference, pose)[:2] for pose in found.poses])
    squares = np.sum((poses - reference[:, :2]) ** 2, axis=1)
    return Score(
        is_exact,
        len(right),
        found.is_lost or rms(squares[len(squares) * 3 // 4 :]) > LOST,
        found.wrong,
        rms(distances**2),
        rms(squares),
        found.seconds,
    )


def _fitted(found: Estimate, positions: Dict[int, np.ndarray]) -> Tuple[List[int], np.ndarray, np.ndarray]:
    """Subjects of the landmarks that are among the positions, and the result of aligned() for these."""
    known = [index for index, subject in enumerate(found.subjects) if subject in positions]
    subjects = [found.subjects[index] for index in known]
    return (subjects, *aligned(found.landmarks[known], np.array([positions[each] for each in subjects])))


def aligned(points: np.ndarray, others: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Rigid motion (3,) of points (n, 2) that fits most of the others best, and the distances (n,) after it.

    Those that are far off do not count in it.
    """
    use = np.ones(len(points), bool)
    for _ in range(3):
        centre, centre_of_others = points[use].mean(axis=0), others[use].mean(axis=0)
        U, _, Vt = np.linalg.svd((others[use] - centre_of_others).T @ (points[use] - centre))
        R = U @ np.diag([1.0, np.linalg.det(U @ Vt)]) @ Vt
        distances = np.hypot(*((points - centre) @ R.T + centre_of_others - others).T)
        use = distances <= max(RIGHT, np.median(distances))
    return np.array([*(centre_of_others - R @ centre), np.arctan2(R[1, 0], R[0, 0])]), distances


def observation_of(distance: float, bearing: float):
    """sextant.Observation2D of a range (m) and a bearing (rad), with the stated noise."""
    ahead = np.array([np.cos(bearing), np.sin(bearing)])
    axes = np.column_stack([ahead, [-ahead[1], ahead[0]]])
    deviations = np.array([max(RANGE, RELATIVE_RANGE * distance), BEARING * distance])
    return sextant.Observation2D(distance * ahead, axes @ np.diag(deviations**2) @ axes.T)
