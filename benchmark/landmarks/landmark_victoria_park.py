# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The drive through Victoria Park: both forms against the most probable drive, and trees without their ids.

The data does not define the frame of the odometry noise: the optimum is reported for each convention, and the
filter uses the covariance as it is, in the frame at the beginning of a step. Other solvers report 3124.

Without the ids LandmarkSlam needs parameters that fit the data. The heading error is not white, as the
covariance assumes, but a constant steering offset over hundreds of steps: after m steps it is m times the
offset, not its root. The noise is therefore multiplied by WHITE, which corresponds to offsets of one or two
standard deviations over the 11 steps that a tree is in view; factors of 4 to 7 result in 136 to 141 trees.
The laser usually detects one of the trees in view, and thin ones rarely. The data has no empty scans and no
false alarms, so that one observation initializes a landmark. The ids are not ground truth: a few trees have
two, within the sensor noise, and an observation of one of them counts as wrong.
"""

from collections import Counter
from pathlib import Path
from typing import Dict, List, NamedTuple

import numpy as np
from tables import Row, Table, Value

import sextant
from landmarks.landmark_drives import make_filter, rms
from landmarks.most_probable_drive import DriveGraph, most_probable
from landmarks.victoria_park import NOISE_FRAMES, RecordedDrive, read_drive, tree_counts, with_noise_frame

START, CERTAIN = np.zeros(3), 1e-12 * np.eye(3)
REFERENCE = "at the step's end"
OPTIMUM, TRAJECTORY, MAP = 3130.0, 4.9, 1.1  # half the squared whitened residuals; metres
AROUND = 0.1  # tolerated relative error of the number of landmarks
QUICK = 500  # steps
PERIOD = 0.2  # seconds; the data has no stamps
WHITE = 5.0  # factor of the standard deviation of the heading
TREE = sextant.LandmarkLabel("tree")


class Track(NamedTuple):
    """A trajectory and its map; landmark k has ids[k]."""

    poses: np.ndarray  # (n + 1, 3)
    landmarks: np.ndarray  # (m, 2)
    ids: List[int]


def victoria_park_tables(folder: Path, quick: bool) -> List[Table]:
    """Three tables; a quick run has the first steps only, without bars. :raises OSError: there is no data"""
    drive = read_drive(folder)
    if quick:
        drive = RecordedDrive(drive.steps[:QUICK], drive.noises[:QUICK], drive.scans[: QUICK + 1])
    tracks = {form: filtered(drive, form) for form in ("invariant", "additive")}
    optima = {where: _optimum(with_noise_frame(drive, where), tracks["invariant"]) for where in NOISE_FRAMES}
    reference = optima[REFERENCE][0]
    most = None if quick else OPTIMUM
    costs = [(where, [Value(cost, 1, at_most=most)]) for where, (_, cost) in optima.items()]
    samples = {"most probable": reference.poses[:, :2], "invariant": tracks["invariant"].poses[:, :2]}
    samples["trees"] = reference.landmarks
    return [
        Table("Victoria Park, known ids: the optimum, by the frame of the odometry noise", ["cost"], costs),
        Table(
            f"Victoria Park, known ids: RMSE to the optimum with noise {REFERENCE}",
            ["trajectory, m", "map, m"],
            _known_rows(drive, tracks, reference, quick),
            samples,
        ),
        _unknown_table(drive, reference, quick),
    ]


def filtered(drive: RecordedDrive, form: str) -> Track:
    """Filters the drive with the known ids."""
    landmark_filter, index_of, poses = make_filter(form, START, CERTAIN), {}, []
    for number, scan in enumerate(drive.scans):
        if number:
            landmark_filter.predict(drive.steps[number - 1], drive.noises[number - 1])
        known = [(index_of[tree], observation) for tree, observation in scan if tree in index_of]
        landmark_filter.update([index for index, _ in known], [observation for _, observation in known])
        for tree, observation in scan:
            if tree not in index_of:
                index_of[tree] = landmark_filter.add(observation)
        poses.append(landmark_filter.pose)
    return Track(np.array(poses), _positions(landmark_filter.landmarks), list(index_of))


def _positions(landmarks: list) -> np.ndarray:
    return np.array([each.position for each in landmarks])


def _optimum(drive: RecordedDrive, start: Track) -> tuple:
    """Track and cost."""
    index_of = {tree: index for index, tree in enumerate(start.ids)}
    seen = [(number, index_of[tree]) for number, scan in enumerate(drive.scans) for tree, _ in scan]
    observations = [observation for scan in drive.scans for _, observation in scan]
    positions = np.array([observation.position for observation in observations])
    covariances = np.array([observation.covariance[:2, :2] for observation in observations])
    graph = DriveGraph(drive.steps, drive.noises, np.array(seen), positions, covariances)
    poses, landmarks, cost = most_probable(graph, start.poses, start.landmarks)
    return Track(poses, landmarks, start.ids), cost


def _known_rows(drive: RecordedDrive, tracks: Dict[str, Track], reference: Track, quick: bool) -> List[Row]:
    turned = filtered(with_noise_frame(drive, REFERENCE), "invariant")
    rows = {**tracks, f"invariant, noise {REFERENCE}": turned}
    return [
        _known_row(name, track, reference, name == "invariant" and not quick) for name, track in rows.items()
    ]


def _known_row(name: str, track: Track, reference: Track, is_barred: bool) -> Row:
    return name, [
        Value(_off(track.poses[:, :2], reference.poses[:, :2]), 2, at_most=TRAJECTORY if is_barred else None),
        Value(_off(track.landmarks, reference.landmarks), 3, at_most=MAP if is_barred else None),
    ]


def _off(points: np.ndarray, others: np.ndarray) -> float:
    return rms(np.sum((points - others) ** 2, axis=1))


def _slam_params():
    """sextant.LandmarkSlamParams of this vehicle, laser and park."""
    params = sextant.LandmarkSlamParams()
    params.sensor.max_range, params.sensor.field_of_view = 21.0, 2.7  # of the data
    params.sensor.detection_probability = 0.1
    params.sensor.landmark_width, params.sensor.min_separation = 0.0, 1.0
    params.association.new_landmark_density = 0.001  # trees per square metre not mapped yet; 0.003 in all
    params.association.new_landmark_gate = 0.9999  # 3.8 m for two observations; trees stand metres apart
    params.candidates.observations = 0  # the data has no false alarms
    params.lost_after = 0  # the vehicle is never carried
    return params


def _unknown_table(drive: RecordedDrive, reference: Track, quick: bool) -> Table:
    scale = np.diag([1.0, 1.0, WHITE])
    scaled = drive._replace(noises=scale @ drive.noises @ scale)
    slam, poses = sextant.LandmarkSlam(_slam_params(), START, CERTAIN), []
    ids_of: Dict[int, Counter] = {}  # of the observations of each key
    for number, scan in enumerate(scaled.scans):
        if number:
            slam.predict(scaled.steps[number - 1], scaled.noises[number - 1], PERIOD)
        if scan:
            observations = [sextant.LabelledObservation(TREE, observation) for _, observation in scan]
            for (tree, _), key in zip(scan, slam.observe(PERIOD * number, observations).keys):
                if key is not None:
                    ids_of.setdefault(key, Counter())[tree] += 1
        poses.append(slam.filter.pose)
    known = sum(sum(trees.values()) for trees in ids_of.values())
    wrong = known - sum(max(trees.values()) for trees in ids_of.values())
    counts = np.array(list(tree_counts(drive).values()))
    bars = {} if quick else {"at_least": 100 * (1 - AROUND), "at_most": 100 * (1 + AROUND)}
    figures = [
        Value(len(slam.labels), 0),
        Value(100 * len(slam.labels) / len(counts), 1, **bars),
        Value(100 * known / counts.sum(), 1),
        Value(100 * wrong / known, 1),
        Value(_off(np.array(poses)[:, :2], reference.poses[:, :2]), 2),
    ]
    columns = ["landmarks", f"% of {len(counts)} trees", "observations known, %", "wrong, %", "trajectory, m"]
    return Table("Victoria Park, ids withheld", columns, [("invariant", figures)])
