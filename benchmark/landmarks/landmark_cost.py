# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Time of a filter step by the size of the map, and equality with the full textbook update.

A step is a prediction and an update with three observations. The covariance applies buffered updates every
few steps, so that blocks of steps are timed, in thread time: the minimum of the medians of many short rounds
over all sizes, because other processes take memory bandwidth and cache. The calls from Python are included:
the row without landmarks shows their share.
"""

import time
from typing import List, NamedTuple, Tuple

import numpy as np
from tables import Row, Table, Value

import sextant
from landmarks.landmark_drives import EXACT, make_filter
from landmarks.textbook_filter import InvariantTextbookFilter
from sextant.geometry.plane_poses import composed, in_frame

SIZES = (0, 15, 50, 150, 500, 1000)  # landmarks
TEXTBOOK = 150  # landmarks
PART = 1 / 20  # maximum share of the textbook filter's time
SAME, COMPARED = 1e-6, (20, 40)  # metres, radians, their squares; landmarks, steps
BLOCK, BLOCKS, ROUNDS = 12, 3, 15  # steps; blocks of a round
SEEN = 3
STEP, NOISE = np.array([0.05, 0.0, 0.02]), np.diag([1e-6, 1e-6, 1e-6])
OBSERVATION_NOISE = 0.01 * np.eye(2)


class Script(NamedTuple):
    """Input of a filter: first all landmarks, then step by step."""

    first: list  # sextant.Observation2D
    scans: List[Tuple[List[int], list]]  # landmarks and their sextant.Observation2D


def cost_tables(quick: bool) -> List[Table]:
    """Two tables; a quick run is of few landmarks, without bars."""
    sizes, textbook = ((0, 5, 10), 10) if quick else (SIZES, TEXTBOOK)
    return [_cost_table(sizes, textbook, quick), _same_table(quick)]


def script(landmarks: int, steps: int) -> Script:
    """A circular drive; each step observes some landmarks, all of them in turn."""
    rng = np.random.default_rng(landmarks)
    positions = 2 * np.sqrt(landmarks) * rng.uniform(-1, 1, (landmarks, 2))
    pose, scans = np.zeros(3), []
    for number in range(steps):
        pose = composed(pose, STEP)
        seen = [(SEEN * number + k) % landmarks for k in range(SEEN)] if landmarks else []
        scans.append((seen, _observations(rng, in_frame(pose, positions[seen]))))
    return Script(_observations(rng, positions), scans)


def _observations(rng: np.random.Generator, points: np.ndarray) -> list:
    noisy = points + rng.normal(0, np.sqrt(OBSERVATION_NOISE[0, 0]), points.shape)
    return [sextant.Observation2D(point, OBSERVATION_NOISE) for point in noisy]


def with_landmarks(landmark_filter, inputs: Script):
    """Adds all landmarks to a filter and returns it."""
    for observation in inputs.first:
        landmark_filter.add(observation)
    return landmark_filter


def step(landmark_filter, scan: Tuple[List[int], list]) -> None:
    """One step of the drive."""
    landmark_filter.predict(STEP, NOISE)
    landmark_filter.update(*scan)


def _cost_table(sizes: Tuple[int, ...], textbook: int, quick: bool) -> Table:
    ours, theirs = [Timed("invariant", size) for size in sizes], Timed("additive", textbook)
    for _ in range(1 if quick else ROUNDS):
        for timed in [*ours, theirs]:
            timed.go_on()
    rows: List[Row] = [(f"{textbook} landmarks, textbook's", [Value(1e3 * theirs.seconds, 3), "-", "-"])]
    for before, timed in zip([None, None, *ours[1:]], ours):
        figures = [Value(1e3 * timed.seconds, 3), "-", "-"]
        if before:
            most = (timed.size / before.size) ** 2
            figures[1] = Value(timed.seconds / before.seconds, 2, at_most=None if quick else most)
        if timed.size == textbook:
            figures[2] = Value(timed.seconds / theirs.seconds, 4, at_most=None if quick else PART)
        rows.append((f"{timed.size} landmarks", figures))
    title = f"A step with {SEEN} observations; the textbook's is additive with sigma points of all, in numpy"
    return Table(title, ["ms", "of the row before", "of the textbook's"], rows)


class Timed:
    """A filter whose steps are timed in blocks."""

    def __init__(self, form: str, size: int):
        self.size = size
        self._blocks = 1 if form == "additive" else BLOCKS
        self._script = script(size, BLOCK * self._blocks)
        self._filter = with_landmarks(make_filter(form, np.zeros(3), EXACT), self._script)
        self._medians: List[float] = []

    @property
    def seconds(self) -> float:
        """Of a step: the least of the medians."""
        return min(self._medians)

    def go_on(self) -> None:
        """One round."""
        times = []
        for first in range(0, BLOCK * self._blocks, BLOCK):
            begin = time.thread_time()
            for scan in self._script.scans[first : first + BLOCK]:
                step(self._filter, scan)
            times.append((time.thread_time() - begin) / BLOCK)
        self._medians.append(float(np.median(times)))


def _same_table(quick: bool) -> Table:
    landmarks, steps = COMPARED
    inputs = script(landmarks, steps)
    short = with_landmarks(make_filter("invariant", np.zeros(3), EXACT), inputs)
    full = with_landmarks(InvariantTextbookFilter(np.zeros(3), EXACT), inputs)
    for scan in inputs.scans:
        step(short, scan)
        step(full, scan)
    differences = [short.pose - full.pose, short.covariance - full.covariance]
    differences.append(_positions(short) - _positions(full))
    largest = [float(np.max(np.abs(each))) for each in differences]
    figures = [Value(1e9 * each, 4, at_most=None if quick else 1e9 * SAME) for each in largest]
    title = f"Sigma points of observed landmarks against all, {landmarks} landmarks, {steps} steps: error"
    return Table(title, ["pose, 1e-9", "covariance, 1e-9", "landmarks, 1e-9"], [("invariant", figures)])


def _positions(landmark_filter) -> np.ndarray:
    return np.array([each.position for each in landmark_filter.landmarks])
