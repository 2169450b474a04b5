# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The drive through Victoria Park: both forms against the most probable drive, and trees without their ids.

The data does not say where a step's noise is felt: the optimum is told for every reading of it, and the
filter takes the covariance as it is, where the step begins. Other solvers find 3124 with a reading of theirs.

Without the ids LandmarkSlam has to know what the data is like. A heading that is off by the same steering
offset for hundreds of steps is no white noise, as the data's covariance has it: m steps go off by m times
the offset then, not by its root. LandmarkSlam is told WHITE times the deviation, as of offsets of one or two
deviations for the 11 steps that a tree is in view; 4 to 7 times find 136 to 141 trees. The laser tells
one tree of those in view, as a rule, and a thin one seldom. Looks without a tree are not in the data, nor are
sightings of nothing, so that one sighting makes a landmark. The ids are no truth: a few trees have two,
within the sensor's noise, and a sighting counts as wrong for one.
"""

from collections import Counter
from pathlib import Path
from typing import Dict, List, NamedTuple

import numpy as np
from tables import Row, Table, Value

import sextant
from landmarks.landmark_drives import begun_filter, rms
from landmarks.most_probable_drive import DriveGraph, most_probable
from landmarks.victoria_park import FELT, RecordedDrive, read_drive, tree_counts, with_noise_felt

START, CERTAIN = np.zeros(3), 1e-12 * np.eye(3)
REFERENCE = "at the step's end"
OPTIMUM, TRAJECTORY, MAP = 3130.0, 4.9, 1.1  # half the squared whitened residuals; metres
AROUND = 0.1  # share of the trees that landmarks may be too many or too few
QUICK = 500  # steps
PERIOD = 0.2  # seconds; the data has no stamps
WHITE = 5.0  # times the heading's deviation of a step
TREE = sextant.LandmarkLabel("tree")


class Track(NamedTuple):
    """A drive and its map; landmark k is of ids[k]."""

    poses: np.ndarray  # (n + 1, 3)
    landmarks: np.ndarray  # (m, 2)
    ids: List[int]


def victoria_park_tables(folder: Path, quick: bool) -> List[Table]:
    """Three tables; a quick run is of the first steps, without bars. :raises OSError: there is no data"""
    drive = read_drive(folder)
    if quick:
        drive = RecordedDrive(drive.steps[:QUICK], drive.noises[:QUICK], drive.looks[: QUICK + 1])
    tracks = {form: filtered(drive, form) for form in ("invariant", "additive")}
    optima = {where: _optimum(with_noise_felt(drive, where), tracks["invariant"]) for where in FELT}
    reference = optima[REFERENCE][0]
    most = None if quick else OPTIMUM
    costs = [(where, [Value(cost, 1, at_most=most)]) for where, (_, cost) in optima.items()]
    samples = {"most probable": reference.poses[:, :2], "invariant": tracks["invariant"].poses[:, :2]}
    samples["trees"] = reference.landmarks
    return [
        Table("Victoria Park, known ids: the optimum, by where a step's noise is felt", ["cost"], costs),
        Table(
            f"Victoria Park, known ids: RMSE to the optimum of noise {REFERENCE}",
            ["trajectory, m", "map, m"],
            _known_rows(drive, tracks, reference, quick),
            samples,
        ),
        _unknown_table(drive, reference, quick),
    ]


def filtered(drive: RecordedDrive, form: str) -> Track:
    """By a filter that is given the ids."""
    landmark_filter, index_of, poses = begun_filter(form, START, CERTAIN), {}, []
    for number, look in enumerate(drive.looks):
        if number:
            landmark_filter.predict(drive.steps[number - 1], drive.noises[number - 1])
        known = [(index_of[tree], sighting) for tree, sighting in look if tree in index_of]
        landmark_filter.update([index for index, _ in known], [sighting for _, sighting in known])
        for tree, sighting in look:
            if tree not in index_of:
                index_of[tree] = landmark_filter.add(sighting)
        poses.append(landmark_filter.pose)
    return Track(np.array(poses), _positions(landmark_filter.landmarks), list(index_of))


def _positions(landmarks: list) -> np.ndarray:
    return np.array([each.position for each in landmarks])


def _optimum(drive: RecordedDrive, start: Track) -> tuple:
    """Track and cost."""
    index_of = {tree: index for index, tree in enumerate(start.ids)}
    seen = [(number, index_of[tree]) for number, look in enumerate(drive.looks) for tree, _ in look]
    sightings = [sighting for look in drive.looks for _, sighting in look]
    positions = np.array([sighting.position for sighting in sightings])
    covariances = np.array([sighting.covariance[:2, :2] for sighting in sightings])
    graph = DriveGraph(drive.steps, drive.noises, np.array(seen), positions, covariances)
    poses, landmarks, cost = most_probable(graph, start.poses, start.landmarks)
    return Track(poses, landmarks, start.ids), cost


def _known_rows(drive: RecordedDrive, tracks: Dict[str, Track], reference: Track, quick: bool) -> List[Row]:
    turned = filtered(with_noise_felt(drive, REFERENCE), "invariant")
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
    params.sensor.max_range, params.sensor.field_of_view = 21.0, 2.7  # what the data has
    params.sensor.detection, params.sensor.width, params.sensor.separation = 0.1, 0.0, 1.0
    params.association.density = 0.001  # trees a square metre that are not known yet; all are 0.003 in view
    params.association.doubt = 0.9999  # 3.8 m for two sightings; trees stand metres apart
    params.candidates.sightings = 0  # nothing in the data is no tree
    params.lost_after = 0  # nobody lifts it
    return params


def _unknown_table(drive: RecordedDrive, reference: Track, quick: bool) -> Table:
    scale = np.diag([1.0, 1.0, WHITE])
    told = drive._replace(noises=scale @ drive.noises @ scale)
    slam, poses = sextant.LandmarkSlam(_slam_params(), START, CERTAIN), []
    ids_of: Dict[int, Counter] = {}  # of the sightings of each key
    for number, look in enumerate(told.looks):
        if number:
            slam.predict(told.steps[number - 1], told.noises[number - 1], PERIOD)
        if look:
            sightings = [sextant.LabelledSighting(TREE, sighting) for _, sighting in look]
            for (tree, _), key in zip(look, slam.see(PERIOD * number, sightings).keys):
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
    columns = ["landmarks", f"% of {len(counts)} trees", "sightings known, %", "wrong, %", "trajectory, m"]
    return Table("Victoria Park, ids withheld", columns, [("invariant", figures)])
