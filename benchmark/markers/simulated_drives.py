# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The three modes on a simulated drive: rendered image to pose, against the exact truth."""

from typing import Dict, List, Optional, Sequence

import numpy as np
from tables import Table, Value
from under_test import MODES, detector, locator

import sextant
from sextant.evaluation.trajectory_metrics import TrajectoryErrors, summarize, trajectory_errors
from sextant.simulation.drive import DriveParams, Frame, SimulatedDrive
from sextant.simulation.room_markers import default_map

BARS = {"tag36h11": (1.7, 4.3), "DICT_4X4_50": (5.0, 13.0)}  # joint: mean and 95 %, cm
BETTER_THAN_AVERAGE = 2.0  # joint's 95 % over that of average
COLUMNS = ["mean", "95 %", "worst", "95 %: average / this row", "frames with a pose"]


def drive_tables(quick: bool) -> List[Table]:
    """A table a family; a quick run is one short drive each, without bars."""
    return [drive_table(family, quick) for family in BARS]


def drive_table(family: str, quick: bool) -> Table:
    """Errors by mode and seed."""
    frames, seeds = (60, (1,)) if quick else (600, (1, 2, 3))
    rows, samples = [], {}
    for seed in seeds:
        errors = drive_errors(family, seed, frames)
        samples.update({f"{mode}, seed {seed}": each.position * 100.0 for mode, each in errors.items()})
        rows += [
            (f"{mode}, seed {seed}", _cells(mode, errors, None if quick else BARS[family])) for mode in errors
        ]
    pooled = {mode: np.concatenate([samples[f"{mode}, seed {seed}"] for seed in seeds]) for mode in MODES}
    title = f"Simulated room, {family}, 640 x 480, noise 4: position error, cm"
    return Table(title, COLUMNS, rows, pooled)


def drive_errors(family: str, seed: int, frames: int) -> Dict[str, TrajectoryErrors]:
    """Errors by mode: every frame is detected once and located by every mode."""
    drive = SimulatedDrive(DriveParams(seed=seed, noise_sigma=4.0), default_map(family))
    find, camera = detector(family), sextant.CameraModel(drive.calibration)
    locators = {mode: locator(mode) for mode in MODES}
    truth, estimates = {}, {mode: {} for mode in locators}
    for frame in drive.frames(frames):
        truth[_stamp(frame)] = frame.T_map_base
        view = sextant.MarkerView(camera, drive.T_base_camera, find.detect(frame.image, camera))
        for mode, each in locators.items():
            located = each.locate(drive.map, [view]).pose
            if located:
                estimates[mode][_stamp(frame)] = located.T_map_base
    return {mode: trajectory_errors(truth, estimate) for mode, estimate in estimates.items()}


def _cells(mode: str, errors: Dict[str, TrajectoryErrors], bars: Optional[Sequence[float]]) -> list:
    mean_bar, p95_bar, gain_bar = (
        (*bars, BETTER_THAN_AVERAGE) if bars and mode == "joint" else (None, None, None)
    )
    summary = summarize(errors[mode].position * 100.0)
    gain = summarize(errors["average"].position * 100.0).p95 / summary.p95
    return [
        Value(summary.mean, at_most=mean_bar),
        Value(summary.p95, at_most=p95_bar),
        Value(summary.worst),
        Value(gain, at_least=gain_bar),
        f"{len(errors[mode].stamps)} of {errors[mode].frames}",
    ]


def _stamp(frame: Frame) -> int:
    return round(frame.time * 1e9)
