# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Many worlds of the ball task played, with a file that remembers those that were."""

import csv
import os
from pathlib import Path
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

import cv2
import numpy as np

from sextant.ball.ball_player import BallPlayerParams
from sextant.evaluation.ball_match import MatchResult, Watch, play
from sextant.objects.colour_detector import ColourDetector, ColourParams
from sextant.objects.detection import Detector
from sextant.objects.object_locator import ObjectLocatorParams
from sextant.objects.yolo_detector import YoloDetector, YoloParams
from sextant.simulation.rgbd_camera import RgbdParams

STOP, STOP_ERROR = 0.2, 0.05  # metres before the goal's line, and how far off counts
OBSTACLES = {2: 0, 3: 2}  # by task


class Match(NamedTuple):
    """To be played."""

    task: int
    seed: int
    model: str  # ONNX file; empty: objects are found by their colour


class Score(NamedTuple):
    """Of many worlds."""

    worlds: int
    success: float  # share in which the ball went through the goal and the robot stopped where it should
    through: float  # share in which the ball did
    untouched: float  # share in which the robot touched no pillar
    goal_seconds: float  # simulated, median of those in which the ball went through
    stop_error: float  # metres, root mean square of those that succeeded
    kicks: float  # mean
    speed: float  # simulated seconds in one of computing


def play_match(match: Match, watch: Optional[Watch] = None) -> MatchResult:
    """With everything in the loop; the depth camera's scale is known, as after estimate_depth_scale.

    :param watch: as play() has it
    """
    cv2.setNumThreads(1)
    params = BallPlayerParams(locator=ObjectLocatorParams(scale=1.0 / RgbdParams().depth_scale))
    return play(match.task, match.seed, detector_of(match.model), params, OBSTACLES[match.task], watch)


def detector_of(model: str) -> Detector:
    """:param model: ONNX file; empty: by colour

    :raises OSError: it cannot be read
    :raises ValueError: what is wrong with it
    """
    if not model:
        return ColourDetector(ColourParams())
    return YoloDetector(YoloParams(model=model), threads=1)


def is_success(result: MatchResult) -> bool:
    """Whether the ball went through the goal and the robot stands where it should."""
    return result.through and abs(result.stop - STOP) <= STOP_ERROR


def score_of(results: Sequence[MatchResult]) -> Score:
    """:param results: at least one"""
    table = np.array([each[2:9] for each in results], float)
    through, stop, pillars, _, seconds, goal_seconds, kicks = table.T
    is_good = np.array([is_success(each) for each in results])
    return Score(
        len(results),
        float(is_good.mean()),
        float(through.mean()),
        float((pillars == 0).mean()),
        float(np.median(goal_seconds[through > 0])) if through.any() else np.nan,
        float(np.sqrt(np.mean((stop[is_good] - STOP) ** 2))) if is_good.any() else np.nan,
        float(kicks.mean()),
        float(seconds.sum() / sum(each.wall_seconds for each in results)),
    )


def read_results(path: Path) -> Dict[Tuple[int, int], MatchResult]:
    """Of a file that append_result() wrote, by task and seed; none if it is not there.

    :raises OSError: it cannot be read
    :raises ValueError: file, line and reason
    """
    if not path.exists():
        return {}
    with path.open(newline="") as file:
        rows = list(csv.reader(file))
    if not rows or rows[0] != list(MatchResult._fields):
        raise ValueError(f"{path}:1: the columns must be {','.join(MatchResult._fields)}")
    results = [_result(row, f"{path}:{line}") for line, row in enumerate(rows[1:], 2)]
    return {(each.task, each.seed): each for each in results}


def append_result(path: Path, result: MatchResult) -> None:
    """One line, on the disk before it returns: who ends the run loses no world. :raises OSError"""
    is_new = not path.exists()
    with path.open("a", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        if is_new:
            writer.writerow(MatchResult._fields)
        writer.writerow([int(each) if isinstance(each, bool) else each for each in result])
        file.flush()
        os.fsync(file.fileno())


def _result(row: List[str], where: str) -> MatchResult:
    types = (int, int, lambda text: bool(int(text)), float, int, int, float, float, int, str, float)
    if len(row) != len(types):
        raise ValueError(f"{where}: {len(row)} columns, there must be {len(types)}; remove the line")
    try:
        return MatchResult(*(make(text) for make, text in zip(types, row)))
    except ValueError as error:
        raise ValueError(f"{where}: {error}; remove the line") from None
