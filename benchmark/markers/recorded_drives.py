# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The three modes on tagslam's recordings: recorded corners, so the locator alone."""

from dataclasses import replace
from pathlib import Path
from typing import Dict, List, Optional, Tuple

import numpy as np
from real_data import Observation, TagslamRecording, read_tagslam
from tables import Row, Table, Value
from under_test import MODES, locator

TITLES = {
    "tagslam_16": "tagslam_16: one camera, five tags in a row; position error against the reference, cm",
    "tagslam_2": "tagslam_2: two fisheye cameras, 13 tags, 1-3 m; position error against the reference, cm",
}
JOINT_OF_SEVERAL = "joint, two markers or more"

# median and 95 %, cm. A single marker leaves nothing to join: joint's bar counts where it has two.
BARS: Dict[str, Dict[str, Tuple[float, float]]] = {
    "tagslam_16": {"nearest": (3.0, 6.8), "average": (1.6, 5.4), "joint": (0.1, 0.2)},
    "tagslam_2": {"nearest": (1.8, 7.6), "average": (1.3, 6.5), JOINT_OF_SEVERAL: (0.3, 0.8)},
}
COLUMNS = ["median", "95 %", "worst", "images with a pose"]


def recording_tables(folder: Path) -> List[Table]:
    """One table a recording. :raises OSError: a recording is not there"""
    return [recording_table(name, read_tagslam(folder / name)) for name in TITLES]


def recording_table(name: str, recording: TagslamRecording) -> Table:
    """Errors of every mode by image; with several cameras, also of all images of a stamp together."""
    images = [[each] for each in recording.referenced()]
    series = {mode: (position_errors(recording, images, mode), len(images)) for mode in MODES}
    several = [image for image in images if len(image[0].detections) > 1]
    if len(several) < len(images):
        series[JOINT_OF_SEVERAL] = position_errors(recording, several, "joint"), len(several)
    if len(recording.cameras) > 1:
        stamps = by_stamp(recording.referenced())
        series["joint, cameras together"] = position_errors(recording, stamps, "joint"), len(stamps)
    series["joint: even ids minus odd ids"] = hold_out(recording)
    rows = [_row(each, errors, count, BARS[name].get(each)) for each, (errors, count) in series.items()]
    return Table(TITLES[name], COLUMNS, rows, {mode: series[mode][0] for mode in MODES})


def by_stamp(observations: List[Observation]) -> List[List[Observation]]:
    """Observations of one instant together."""
    stamps: Dict[float, List[Observation]] = {}
    for observation in observations:
        stamps.setdefault(observation.stamp, []).append(observation)
    return list(stamps.values())


def hold_out(recording: TagslamRecording) -> Tuple[np.ndarray, int]:
    """(distances in cm, images) between the poses from the even and from the odd ids of an image.

    The reference was made of the same corners; this is independent of it but for the map.
    """
    images = [half for half in map(_halves, recording.referenced()) if all(half)]
    joint, distances = locator("joint"), []
    for halves in images:
        poses = [joint.locate(recording.map, [recording.view(half)]).pose for half in halves]
        if all(poses):
            even, odd = (pose.T_map_base[:3, 3] for pose in poses)
            distances.append(np.linalg.norm(even - odd) * 100.0)
    return np.array(distances), len(images)


def _halves(observation: Observation) -> List[Optional[Observation]]:
    """The observation with its even ids and with its odd ids alone; None where there are none of them."""
    halves = [[each for each in observation.detections if each.id % 2 == odd] for odd in (0, 1)]
    return [replace(observation, detections=half) if half else None for half in halves]


def position_errors(recording: TagslamRecording, instants: List[List[Observation]], mode: str) -> np.ndarray:
    """(N,) distances to the reference in cm, of the instants that have a pose."""
    under_test, errors = locator(mode), []
    for observations in instants:
        located = under_test.locate(recording.map, [recording.view(each) for each in observations]).pose
        if located:
            reference = recording.trajectory[observations[0].stamp]
            errors.append(np.linalg.norm(located.T_map_base[:3, 3] - reference[:3, 3]) * 100.0)
    return np.array(errors)


def _row(name: str, errors: np.ndarray, count: int, bars: Optional[Tuple[float, float]]) -> Row:
    median_bar, p95_bar = bars or (None, None)
    median, p95 = np.percentile(errors, [50, 95])
    cells = [Value(median, at_most=median_bar), Value(p95, at_most=p95_bar), Value(errors.max())]
    return name, [*cells, f"{len(errors)} of {count}"]
