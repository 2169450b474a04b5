# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Success rate of the ball task in simulated worlds, with rendering, network and filter in the loop.

score_ball_task is the long run with 200 worlds of each task.
"""

import os
from typing import List

import numpy as np
from tables import Row, Table, Value

from sextant.base.jobs import run_jobs
from sextant.evaluation.ball_match import MatchResult
from sextant.evaluation.ball_score import HARD_SEEDS, Match, Score, play_match, score_of
from sextant.objects.shipped_model import shipped_model

WORLDS, HARD_WORLDS = 40, 200
SUCCESS = {2: 95.0, 3: 90.0}  # minimum % of successful runs by task
UNTOUCHED = {2: 97.5, 3: None}  # minimum % of usual runs without contact with a pillar: all but one of 40
COLUMNS = [
    "success, %", "ball through, %", "no pillar touched, %", "median time to goal, s", "stop error, cm (RMS)",
    "kicks", "simulated s per s",
]  # fmt: skip


def match_tables(quick: bool, is_hard: bool = False) -> List[Table]:
    """One table; a quick run has one world of each task and no bars."""
    matches = _matches(quick, is_hard)
    results = list(run_jobs(play_match, matches, os.cpu_count() or 1, progress="worlds"))
    by_task = {task: [each for each in results if each.task == task] for task in SUCCESS}
    rows = [_row(task, score_of(played), quick, is_hard) for task, played in by_task.items()]
    samples = {f"task {task}": _ends(played) for task, played in by_task.items()}
    kind = "hard worlds" if is_hard else "worlds"
    return [Table(f"the ball task in {len(matches) // len(SUCCESS)} {kind} each", COLUMNS, rows, samples)]


def _matches(quick: bool, is_hard: bool) -> List[Match]:
    first, worlds = (HARD_SEEDS, HARD_WORLDS) if is_hard else (0, WORLDS)
    seeds = range(first, first + (1 if quick else worlds))
    return [Match(task, seed, str(shipped_model()), is_hard) for task in SUCCESS for seed in seeds]


def _ends(results: List[MatchResult]) -> np.ndarray:
    """(n, 2) seconds until the ball was through, metres from the line to the robot at the end."""
    return np.array([[each.goal_seconds, each.stop] for each in results])


def _row(task: int, score: Score, quick: bool, is_hard: bool) -> Row:
    return f"task {task}", [
        Value(100 * score.success, 1, at_least=None if quick else SUCCESS[task]),
        Value(100 * score.through, 1),
        Value(100 * score.untouched, 1, at_least=None if quick or is_hard else UNTOUCHED[task]),
        Value(score.goal_seconds, 1),
        Value(100 * score.stop_error, 1),
        Value(score.kicks, 2),
        Value(score.speed, 1),
    ]
