# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Wrong calibration, map, marker size or shutter: which cause is reported, and is the covariance honest?"""

from typing import List, NamedTuple, Set

import numpy as np
from tables import Row, Table, Value

import sextant
from field.faulty_room import drive, faulty, mapped, room

CAUSES = {  # ErrorCause that is to be reported
    "focal length 1 %": "focal_length",
    "centre 8 px": "centre",
    "k1 missing": "distortion",
    "shutter 20 ms": "shutter",
    "marker size 2 %": "marker_size",
    "map 0.5 cm": "map",
    "marker moved 4 cm": "moved",
    "nothing": "",
}
RUNS, GOOD_RUNS = 40, 200
LEARNING, JUDGED = 300, 100  # images
NOISE = 0.1  # pixels
CHI2_95 = 12.592  # 6 degrees of freedom
COLUMNS = ["runs", "right cause alone, %", "in the 95 % region, %", "without correction, %", "RMSE, cm"]
COLUMNS += ["without correction, cm", "poses, %"]


class Run(NamedTuple):
    """One drive."""

    reported: Set[str]
    nees: np.ndarray  # of the judged images; inf without a pose
    errors: np.ndarray  # of the position, m


def causes_tables(quick: bool) -> List[Table]:
    """One row a cause; a quick run is one drive each, without bars."""
    return [Table("One cause each, twelve markers, corners of 0.1 px", COLUMNS, _rows(quick))]


def _rows(quick: bool) -> List[Row]:
    rows = []
    for cause, expected in CAUSES.items():
        count = 1 if quick else RUNS if expected else GOOD_RUNS
        runs = [run(cause, seed, corrects=True) for seed in range(count)]
        without = [run(cause, seed, corrects=False) for seed in range(min(count, RUNS))]
        right = 100.0 * np.mean([each.reported == ({expected} - {""}) for each in runs])
        bars = (None, None) if quick else (95.0 if expected else 100.0, 90.0)
        cells = [
            Value(count, 0),
            Value(right, 1, at_least=bars[0]),
            Value(_inside(runs), 1, at_least=bars[1]),
            Value(_inside(without), 1),
            Value(_rmse(runs)),
            Value(_rmse(without)),
            Value(100.0 * np.mean(np.isfinite(np.concatenate([each.errors for each in runs]))), 1),
        ]
        rows.append((cause, cells))
    return rows


def _inside(runs: List[Run]) -> float:
    """Percentage of the true poses in the 95 % region, of the images with a pose."""
    nees = np.concatenate([each.nees for each in runs])
    return 100.0 * float(np.mean(nees[np.isfinite(nees)] < CHI2_95))


def _rmse(runs: List[Run]) -> float:
    errors = np.concatenate([each.errors for each in runs])
    return 100.0 * float(np.sqrt(np.nanmean(np.square(errors))))


def run(cause: str, seed: int, corrects: bool) -> Run:
    """Locates a robot in LEARNING + JUDGED images."""
    random = np.random.default_rng([seed, 26])
    poses = room(random)
    params = sextant.LocalizationParams()
    params.correct_errors = corrects
    localization, marker_map = sextant.MarkerLocalization(params), mapped(poses)
    nees, errors = [], []
    for seen in drive(poses, faulty(cause, random), LEARNING + JUDGED, NOISE, random):
        pose = localization.locate(marker_map, [seen.view], None, seen.stamp).pose
        error = sextant.pose_error(seen.T_map_base, pose.T_map_base) if pose else np.full(6, np.nan)
        nees.append(error @ np.linalg.solve(pose.covariance, error) if pose else np.inf)
        errors.append(np.linalg.norm(error[:3]))
    reported = {each.cause.name for each in localization.errors} | _moved(localization)
    return Run(reported, np.array(nees[-JUDGED:]), np.array(errors[-JUDGED:]))


def _moved(localization) -> Set[str]:
    return {"moved"} if localization.moved else set()
