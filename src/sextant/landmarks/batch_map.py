# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The map of whole drives: all poses and landmarks are estimated together, and observations are associated
again with what all of them show, until nothing changes. It begins with the result of the filter."""

from typing import Callable, List, Sequence, Tuple

import numpy as np

import sextant
from sextant.geometry.plane_poses import in_frame, rotation
from sextant.landmarks.batch_association import BatchAssociation, Map, Scan
from sextant.landmarks.batch_drives import at_odometry, recorded_drives
from sextant.landmarks.slam_run import DriveSegment, LandmarkResult, LandmarkSightings, RecordedScan, SlamRun

ROUNDS = 15  # at most
SETTLED = 1e-3  # share of the observations that change their landmark, below which nothing changes


def batch_map(run: SlamRun, progress: Callable[[], None] = lambda: None) -> LandmarkResult:
    """Map and drives by all observations.

    :param progress: called after each of at most ROUNDS rounds
    :raises RuntimeError: the drives do not determine a map
    """
    return _Batch(run).solve(progress)


class _Batch:
    def __init__(self, run: SlamRun):
        self._run, slam, made = run, run.timeline.slam, run.session.map
        self._filter = slam.filter
        self._drives = recorded_drives(run)
        labels = {*made.labels, *_labels_of(run)}
        self._labels = sorted(labels, key=lambda label: (label.class_name, label.id or -1))
        self._code = {label: code for code, label in enumerate(self._labels)}
        self._index = {key: index for index, key in enumerate(slam.keys)}  # those known before come first
        classes = np.array([self._code[label] for label in made.labels], dtype=int)
        fixed = sum(key in self._index for key in run.first_keys)
        scans = [self._scan(*each) for each in self._drives.scans]
        identified = [code for label, code in self._code.items() if label.id is not None]
        self._association = BatchAssociation(scans, identified, run.params)
        rates = np.full(len(classes), self._association.detection)
        self._map = Map(_positions(made.landmarks), classes, fixed, rates)

    def _scan(self, pose: int, scan: RecordedScan) -> Scan:
        seen = [each.observation for each in scan.observations]
        return Scan(
            pose,
            np.array([each.position for each in seen]).reshape(-1, 2),
            np.array([each.covariance[:2, :2] for each in seen]).reshape(-1, 2, 2),
            np.array([self._code[each.label] for each in scan.observations], dtype=int),
            scan.T_base_sensor,
            scan.has_markers,
        )

    def solve(self, progress: Callable[[], None]) -> LandmarkResult:
        assigned = [self._of_filter(scan) for _, scan in self._drives.scans]
        errors = self._filter.scale, self._filter.turn_scale, self._filter.bearing
        state = self._adjusted(assigned, sextant.AdjustedLandmarks(list(self._drives.begin), [], *errors))
        for _ in range(ROUNDS):
            self._association.start(np.array(state.poses))
            before = assigned
            assigned, landmarks = self._association.associate(self._map)
            self._map = self._association.improve(landmarks)
            is_same = self._map is landmarks
            if not is_same:
                assigned, self._map = self._association.associate(self._map)
            state = self._adjusted(assigned, state)
            progress()
            if is_same and _changed(before, assigned) <= SETTLED:
                break
        return self._result(assigned, state)

    def _of_filter(self, scan: RecordedScan) -> np.ndarray:
        keys = scan.keys or [None] * len(scan.observations)
        return np.array([self._index.get(key, -1) for key in keys], dtype=int)

    def _adjusted(self, assigned: List[np.ndarray], state):
        self._drop_unseen(assigned)
        measured = self._measured(assigned)
        begin = sextant.AdjustedLandmarks(
            state.poses, self._landmarks(assigned, state.poses), state.scale, state.turn_scale, state.bearing
        )
        state = sextant.adjust_landmarks(measured, self._run.params.slam.filter, begin)
        self._map = self._map._replace(positions=_positions(state.landmarks))
        return state

    def _drop_unseen(self, assigned: List[np.ndarray]) -> None:
        """Drops the landmarks that no observation is of, but not those that were known; changes assigned."""
        keep = np.arange(len(self._map.positions)) < self._map.fixed
        for of in assigned:
            keep[of[of >= 0]] = True
        index_of = np.append(np.cumsum(keep) - 1, -1)
        for of in assigned:
            of[:] = index_of[of]
        positions, classes, fixed, detection = self._map
        self._map = Map(positions[keep], classes[keep], fixed, detection[keep])

    def _measured(self, assigned: List[np.ndarray]) -> "sextant.LandmarkDrives":
        measured = sextant.LandmarkDrives(*self._known())
        for before, step, may_slip in self._drives.steps:
            measured.add_step(before, step, may_slip)
        for (pose, scan), of in zip(self._drives.scans, assigned):
            for seen, landmark in zip(scan.observations, of):
                if landmark >= 0:
                    measured.add_sighting(pose, landmark, seen.observation, scan.T_base_sensor)
        return measured

    def _known(self):
        first, keys = self._run.first_map, list(self._run.first_keys)
        is_known = not first.is_lost and self._drives.segments[0] == 0
        rows, at, known = list(range(3)) if is_known else [], 3, []
        for key, landmark in zip(keys, first.landmarks):
            width = 2 if landmark.heading is None else 3
            if key in self._index:
                known.append(landmark)
                rows += range(at, at + width)
            at += width
        return (first.pose if is_known else None), known, first.covariance[np.ix_(rows, rows)]

    def _landmarks(self, assigned: List[np.ndarray], poses: Sequence[np.ndarray]) -> List:
        """With the mean heading of the observations, if they have one; the known ones as they were."""
        turns = np.zeros(len(self._map.positions), dtype=complex)
        for (pose, scan), of in zip(self._drives.scans, assigned):
            for landmark, seen in zip(of, scan.observations):
                if landmark >= 0 and seen.observation.heading is not None:
                    turns[landmark] += np.exp(1j * (poses[pose][2] + seen.observation.heading))
        headings = [np.angle(turn) if turn else None for turn in turns]
        known = self._known()[1]
        headings[: len(known)] = [each.heading for each in known]
        return [sextant.Landmark2D(*each) for each in zip(self._map.positions, headings)]

    def _result(self, assigned: List[np.ndarray], state) -> LandmarkResult:
        labels = [self._labels[code] for code in self._map.classes]
        made, used = self._run.session.map, np.concatenate([[], *assigned]).astype(int)
        counts = np.bincount(used[used >= 0], minlength=len(labels)).tolist()
        note = f"adjusted with all observations: {sum(counts)} of {len(used)} used"
        for name, scale in (("distances", state.scale), ("angles", state.turn_scale)):
            note += f", {name} of odometry x {scale:.3f}" if scale != 1.0 else ""
        parts = state.poses[-1], state.landmarks, labels, state.covariance
        landmark_map = sextant.LandmarkMap(made.frame, *parts, made.is_lost)
        segments, sightings = self._segments(np.array(state.poses)), self._sightings(assigned, state)
        return LandmarkResult(landmark_map, counts, segments, [note], sightings)

    def _sightings(self, assigned: List[np.ndarray], state) -> List[LandmarkSightings]:
        """Of each landmark."""
        rows: List[List[Tuple[float, float, float]]] = [[] for _ in self._map.positions]
        for (pose, scan), of in zip(self._drives.scans, assigned):
            at = np.array(state.poses[pose])
            for seen, landmark in zip(scan.observations, of):
                if landmark >= 0:
                    place = self._map.positions[landmark]
                    direction = np.arctan2(*(at[:2] - place)[::-1])
                    turned = _turned(seen.observation, scan.T_base_sensor, state.bearing)
                    rows[landmark].append((scan.stamp, direction, _distance(*turned, in_frame(at, place))))
        columns = [np.array(each).reshape(-1, 3).T for each in rows]
        return [LandmarkSightings(*each, rate) for each, rate in zip(columns, self._map.detection)]

    def _segments(self, poses: np.ndarray) -> List[DriveSegment]:
        """Those of the run, with the poses by all observations at the stamps of odometry."""
        segments = []
        for index, segment in enumerate(self._run.segments):
            of = self._drives.segments == index
            robot = at_odometry(segment, self._drives.stamps[of], poses[of]) if of.any() else {}
            segments.append(segment._replace(robot=robot))
        return segments


def _turned(
    seen: "sextant.Observation2D", T_base_sensor: np.ndarray, angle: float
) -> Tuple[np.ndarray, np.ndarray]:
    """Position (2,) and covariance (2, 2) in the robot frame, with an angle added to the bearing."""
    turn, origin = rotation(angle), T_base_sensor[:2]
    return origin + turn @ (seen.position - origin), turn @ seen.covariance[:2, :2] @ turn.T


def _distance(position: np.ndarray, covariance: np.ndarray, expected: np.ndarray) -> float:
    """Mahalanobis distance."""
    off = position - expected
    return float(np.sqrt(off @ np.linalg.solve(covariance, off)))


def _positions(landmarks: Sequence) -> np.ndarray:
    return np.array([each.position for each in landmarks]).reshape(-1, 2)


def _changed(before: List[np.ndarray], after: List[np.ndarray]) -> float:
    """Share of the observations that are of another landmark."""
    differ = np.concatenate([one != other for one, other in zip(before, after)])
    return float(differ.mean()) if len(differ) else 0.0


def _labels_of(run: SlamRun):
    return {seen.label for segment in run.segments for scan in segment.scans for seen in scan.observations}
