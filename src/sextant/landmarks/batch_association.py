# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which landmark each observation of whole drives is of, when the poses are known.

The score of a map is the logarithm of the probability of all observations: those of landmarks, detected and
missed ones, and false alarms. Landmarks are added, joined and removed while the score increases.
"""

from typing import Iterable, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.spatial import cKDTree

import sextant
from sextant.geometry.plane_poses import in_frame, rotation

LANDMARK_COST = 10.0  # of the score: the evidence that a landmark needs
JOIN_DISTANCE = 1.5  # metres between two landmarks that may be the same
POSE_SHARE = 1.0  # variance of a predicted observation by the errors of pose and map, over that of the sensor
DETECTION = (0.1, 0.95)  # bounds of the estimated detection probability
PRIOR_COUNT = 4.0  # landmarks in view that weigh as much as the parameter
FAR = 1e6  # metres between observations of two classes
LEAST_OBSERVATIONS = 3  # of a new landmark
MARGIN = 1.0  # metres beyond the sensor's range within which observations may be


class Scan(NamedTuple):
    """One scan of one sensor, k observations."""

    pose: int  # index
    positions: np.ndarray  # (k, 2) in the robot frame, metres
    covariances: np.ndarray  # (k, 2, 2)
    classes: np.ndarray  # (k,) index of the label
    T_base_sensor: np.ndarray  # (3,)
    has_markers: bool = False  # whether the sensor detects landmarks with an id only


class Map(NamedTuple):
    """n landmarks."""

    positions: np.ndarray  # (n, 2) in the map frame, metres
    classes: np.ndarray  # (n,) index of the label
    fixed: int  # number of first landmarks that are neither removed nor joined
    detection: np.ndarray  # (n,) probability that one in view is detected: some are hidden from many sides


class BatchAssociation:
    """Associates the observations of scans with landmarks."""

    def __init__(
        self, scans: Sequence[Scan], identified: Sequence[int], params: "sextant.LandmarkSlamNodeParams"
    ):
        """:param identified: classes of one landmark each, by its id: they are neither removed nor joined"""
        self._identified = identified
        self._scans = scans
        self._min_range, self._max_range = params.min_range, params.max_range
        self._half_view = 0.5 * params.field_of_view
        self._inverses = [np.linalg.inv((1 + POSE_SHARE) * scan.covariances) for scan in scans]
        self._roots = [(1 + POSE_SHARE) * np.sqrt(np.linalg.det(scan.covariances))[:, None] for scan in scans]
        self._known: Tuple[Optional[Map], np.ndarray] = (None, np.zeros(0))  # scores by scan of a map
        self._clutter = np.log(params.new_landmark_density)
        self.detection = float(np.clip(params.detection_probability, *DETECTION))  # of a new landmark

    def start(self, poses: np.ndarray) -> None:
        """Sets the poses (n, 3), by index."""
        self._poses, self._known = poses, (None, np.zeros(0))
        self._places = np.array([poses[scan.pose][:2] for scan in self._scans]).reshape(-1, 2)

    def associate(self, landmarks: Map) -> Tuple[List[np.ndarray], Map]:
        """Landmark of each observation of each scan, (k,); -1: none. And the map with its detection rates."""
        found, counts = [], np.zeros((2, len(landmarks.positions)))
        for _, assigned, in_view in self._visible(landmarks, range(len(self._scans))):
            found.append(assigned)
            counts[:, in_view] += [np.isin(in_view, assigned), np.ones(len(in_view))]
        detected, expected = counts
        rates = (detected + PRIOR_COUNT * self.detection) / (expected + PRIOR_COUNT)
        return found, landmarks._replace(detection=np.clip(rates, *DETECTION))

    def improve(self, landmarks: Map) -> Map:
        """Removes, joins and adds landmarks."""
        landmarks = self._without_needless(landmarks)
        landmarks = self._joined(landmarks)
        return self._with_new(landmarks)

    def _without_needless(self, landmarks: Map) -> Map:
        for index in reversed(range(landmarks.fixed, len(landmarks.positions))):
            if landmarks.classes[index] in self._identified:
                continue
            fewer = _without(landmarks, [index])
            if self._gain(landmarks, fewer, landmarks.positions[[index]]) > -LANDMARK_COST:
                landmarks = fewer
        return landmarks

    def _joined(self, landmarks: Map) -> Map:
        first = landmarks.fixed
        while first < len(landmarks.positions):
            better = self._joined_with(landmarks, first)
            first += better is None
            landmarks = better or landmarks
        return landmarks

    def _joined_with(self, landmarks: Map, index: int) -> Optional[Map]:
        apart = np.hypot(*(landmarks.positions - landmarks.positions[index]).T)
        same = (landmarks.classes == landmarks.classes[index]) & (apart < JOIN_DISTANCE)
        for other in np.flatnonzero(same):
            if other == index:
                continue
            both = landmarks.positions[[index, other]]
            middle = landmarks.positions[other] if other < landmarks.fixed else both.mean(axis=0)
            rate = min(landmarks.detection[[index, other]].sum(), DETECTION[1])
            joined = _with(_without(landmarks, [index]), other - (other > index), middle, rate)
            if self._gain(landmarks, joined, both) > -LANDMARK_COST:
                return joined
        return None

    def _with_new(self, landmarks: Map) -> Map:
        unused = self._unused(landmarks)
        while len(unused):
            positions, widths, classes = unused[:, :2], unused[:, 2], unused[:, 3].astype(int)
            points = np.column_stack([positions, FAR * classes])
            near = cKDTree(points).query_ball_point(points, 3 * widths)
            members = max(near, key=len)
            if len(members) < LEAST_OBSERVATIONS:
                return landmarks
            place = np.median(positions[members], axis=0)
            more = Map(
                np.vstack([landmarks.positions, place]),
                np.append(landmarks.classes, classes[members[0]]),
                landmarks.fixed,
                np.append(landmarks.detection, self._rate(place, len(members))),
            )
            if self._gain(landmarks, more, place[None]) > LANDMARK_COST:
                landmarks = more
            unused = np.delete(unused, members, axis=0)
        return landmarks

    def _rate(self, place: np.ndarray, detected: int) -> float:
        """Detection probability of a landmark at a place (2,)."""
        alone = Map(place[None], np.array([-1]), 0, np.array([self.detection]))
        in_view = sum(len(each) for _, _, each in self._visible(alone, range(len(self._scans))))
        return float(np.clip((detected + PRIOR_COUNT * self.detection) / (in_view + PRIOR_COUNT), *DETECTION))

    def _unused(self, landmarks: Map) -> np.ndarray:
        """(n, 4): position in the map, standard deviation, class of the observations of no landmark."""
        rows = []
        for scan, (_, assigned, _) in zip(self._scans, self._visible(landmarks, range(len(self._scans)))):
            pose = self._poses[scan.pose]
            for k in np.flatnonzero((assigned < 0) & ~np.isin(scan.classes, self._identified)):
                width = np.sqrt(np.linalg.eigvalsh(scan.covariances[k])[-1])
                rows.append([*(pose[:2] + rotation(pose[2]) @ scan.positions[k]), width, scan.classes[k]])
        return np.array(rows).reshape(-1, 4)

    def _gain(self, landmarks: Map, others: Map, changed: np.ndarray) -> float:
        """How much more the score is with the others. :param changed: (m, 2) where they differ"""
        if self._known[0] is not landmarks:
            self._known = (
                landmarks,
                np.array([score for score, _, _ in self._visible(landmarks, range(len(self._scans)))]),
            )
        reach = self._max_range + 2 * MARGIN
        far = np.hypot(*(self._places[:, None] - changed[None]).transpose(2, 0, 1)).min(axis=1) > reach
        scans = np.flatnonzero(~far)
        return sum(score for score, _, _ in self._visible(others, scans)) - self._known[1][scans].sum()

    def _visible(self, landmarks: Map, scans: Iterable[int]) -> List[Tuple[float, np.ndarray, np.ndarray]]:
        return [self._scored(index, landmarks) for index in scans]

    def _scored(self, index: int, landmarks: Map) -> Tuple[float, np.ndarray, np.ndarray]:
        """Score, landmark of each observation, and landmarks in view of a scan."""
        scan = self._scans[index]
        in_base = in_frame(self._poses[scan.pose], landmarks.positions)
        near = np.flatnonzero(np.hypot(*in_base.T) < self._max_range + MARGIN)
        in_sensor = in_frame(scan.T_base_sensor, in_base[near])
        ranges, bearings = np.hypot(*in_sensor.T), np.arctan2(in_sensor[:, 1], in_sensor[:, 0])
        is_in_view = (
            (ranges < self._max_range) & (ranges > self._min_range) & (np.abs(bearings) < self._half_view)
        )
        if scan.has_markers:
            is_in_view &= np.isin(landmarks.classes[near], self._identified)
        detection = landmarks.detection[near]
        score = np.log(1 - detection[is_in_view]).sum()
        assigned = np.full(len(scan.positions), -1)
        if len(near) and len(assigned):
            gains = self._gains(index, in_base[near], landmarks.classes[near]) + np.log(
                detection / (1 - detection)
            )
            rows, columns = linear_sum_assignment(-np.maximum(gains, 0))
            use = gains[rows, columns] > 0
            score += gains[rows, columns][use].sum()
            assigned[rows[use]] = near[columns[use]]
        return score, assigned, near[is_in_view]

    def _gains(self, index: int, in_base: np.ndarray, classes: np.ndarray) -> np.ndarray:
        """(k, n) how much more probable each observation is of each landmark than a false alarm."""
        scan = self._scans[index]
        off = scan.positions[:, None] - in_base[None]
        distances = np.einsum("kni,kij,knj->kn", off, self._inverses[index], off)
        densities = sextant.log_density(distances, self._roots[index])
        return np.where(scan.classes[:, None] == classes, densities - self._clutter, -np.inf)


def _without(landmarks: Map, indices: List[int]) -> Map:
    positions, classes, detection = (
        np.delete(each, indices, axis=0)
        for each in (landmarks.positions, landmarks.classes, landmarks.detection)
    )
    return Map(positions, classes, landmarks.fixed, detection)


def _with(landmarks: Map, index: int, position: np.ndarray, rate: float) -> Map:
    positions, detection = landmarks.positions.copy(), landmarks.detection.copy()
    positions[index], detection[index] = position, rate
    return landmarks._replace(positions=positions, detection=detection)
