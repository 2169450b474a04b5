# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Scores the ball task over many worlds, and stores results in a file."""

import csv
import os
from pathlib import Path
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

import cv2
import numpy as np

from sextant.ball.ball_player import BallPlayerParams
from sextant.evaluation.ball_match import HARD, USUAL, MatchResult, Watch, play
from sextant.objects.colour_detector import ColourDetector, ColourParams
from sextant.objects.detections import Detector
from sextant.objects.object_locator import ObjectLocatorParams
from sextant.objects.yolo_detector import YoloDetector, YoloParams
from sextant.simulation.rgbd_camera import RgbdParams

STOP, STOP_ERROR = 0.2, 0.05  # metres before the goal line, and tolerance
OBSTACLES = {2: 0, 3: 2}  # number by task
HARD_SEEDS = 100_000  # first seed of hard worlds


class Match(NamedTuple):
    """A world to run."""

    task: int  # 2 or 3
    seed: int  # of the world
    model: str  # ONNX file; empty: detect objects by colour
    is_hard: bool = False  # HARD instead of USUAL


class Score(NamedTuple):
    """Statistics of many worlds."""

    worlds: int  # number of worlds
    success: float  # fraction with a goal and a correct stop
    through: float  # fraction with a goal
    untouched: float  # fraction without a collision with a pillar
    goal_seconds: float  # median simulated time until the goal
    stop_error: float  # RMS error of the stop over successful worlds, metres
    kicks: float  # mean number
    speed: float  # simulated over computing time


def play_match(match: Match, watch: Optional[Watch] = None) -> MatchResult:
    """Runs one world with the complete pipeline; the depth scale is known, as after estimate_depth_scale.

    :param watch: called at every tick, as in play()
    """
    cv2.setNumThreads(1)
    params = BallPlayerParams(locator=ObjectLocatorParams(depth_scale=1.0 / RgbdParams().depth_scale))
    difficulty = HARD if match.is_hard else USUAL
    return play(
        match.task, match.seed, detector_of(match.model), params, OBSTACLES[match.task], watch, difficulty
    )


def detector_of(model: str) -> Detector:
    """Returns a detector.

    :param model: ONNX file; empty: by colour
    :raises OSError: the file cannot be read
    :raises ValueError: the model is invalid
    """
    if not model:
        return ColourDetector(ColourParams())
    return YoloDetector(YoloParams(model=model), threads=1)


def is_success(result: MatchResult) -> bool:
    """Returns whether the ball went through the goal and the robot stopped correctly."""
    return result.through and abs(result.stop - STOP) <= STOP_ERROR


def score_of(results: Sequence[MatchResult]) -> Score:
    """Computes the statistics of one or more results."""
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
    """Reads a file of append_result().

    :returns: results by task and seed; empty if the file does not exist
    :raises OSError: the file cannot be read
    :raises ValueError: "file:line: reason"
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
    """Appends one line and syncs the file, so that an interrupted run loses no result.

    :raises OSError: the file cannot be written
    """
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
