# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a step of the filter costs as the map grows, and that the short way gives what the textbook's does.

A step is a prediction and an update with three sightings. The filter adds to its covariance every few steps
only, so that blocks of steps are timed, in the time of the one thread that does it: the least of the medians
of many short rounds, each of which goes through all sizes, since what else runs takes memory and cache, too.
Calls from Python are in it: the row of no landmarks, whose update is of nothing, shows how much.
"""

import time
from typing import List, NamedTuple, Tuple

import numpy as np
from tables import Row, Table, Value

import sextant
from landmarks.landmark_drives import EXACT, begun_filter
from landmarks.textbook_filter import InvariantTextbookFilter
from sextant.geometry.plane_poses import composed, in_frame

SIZES = (0, 15, 50, 150, 500, 1000)  # landmarks
TEXTBOOK = 150  # landmarks
PART = 1 / 20  # of the textbook's time, at most
SAME, COMPARED = 1e-6, (20, 40)  # metres, radians, their squares; landmarks, steps
BLOCK, BLOCKS, ROUNDS = 12, 3, 15  # steps; blocks of a round
SEEN = 3
STEP, NOISE = np.array([0.05, 0.0, 0.02]), np.diag([1e-6, 1e-6, 1e-6])
SIGHTING_NOISE = 0.01 * np.eye(2)


class Script(NamedTuple):
    """What a filter is told: first all landmarks, then step after step."""

    first: list  # sextant.PlaneSighting
    looks: List[Tuple[List[int], list]]  # landmarks and their sextant.PlaneSighting


def cost_tables(quick: bool) -> List[Table]:
    """Two tables; a quick run is of few landmarks, without bars."""
    sizes, textbook = ((0, 5, 10), 10) if quick else (SIZES, TEXTBOOK)
    return [_cost_table(sizes, textbook, quick), _same_table(quick)]


def script(landmarks: int, steps: int) -> Script:
    """A drive in a circle among landmarks, some of which are seen at a step, all in turn."""
    rng = np.random.default_rng(landmarks)
    positions = 2 * np.sqrt(landmarks) * rng.uniform(-1, 1, (landmarks, 2))
    pose, looks = np.zeros(3), []
    for number in range(steps):
        pose = composed(pose, STEP)
        seen = [(SEEN * number + k) % landmarks for k in range(SEEN)] if landmarks else []
        looks.append((seen, _sightings(rng, in_frame(pose, positions[seen]))))
    return Script(_sightings(rng, positions), looks)


def _sightings(rng: np.random.Generator, points: np.ndarray) -> list:
    noisy = points + rng.normal(0, np.sqrt(SIGHTING_NOISE[0, 0]), points.shape)
    return [sextant.PlaneSighting(point, SIGHTING_NOISE) for point in noisy]


def knowing_all(landmark_filter, told: Script):
    """The filter, that knows all landmarks now."""
    for sighting in told.first:
        landmark_filter.add(sighting)
    return landmark_filter


def step(landmark_filter, look: Tuple[List[int], list]) -> None:
    """One step of the drive."""
    landmark_filter.predict(STEP, NOISE)
    landmark_filter.update(*look)


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
    title = f"A step with {SEEN} sightings; the textbook's is additive with sigma points of all, in numpy"
    return Table(title, ["ms", "of the row before", "of the textbook's"], rows)


class Timed:
    """A filter whose steps are timed in blocks."""

    def __init__(self, form: str, size: int):
        self.size = size
        self._blocks = 1 if form == "additive" else BLOCKS
        self._script = script(size, BLOCK * self._blocks)
        self._filter = knowing_all(begun_filter(form, np.zeros(3), EXACT), self._script)
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
            for look in self._script.looks[first : first + BLOCK]:
                step(self._filter, look)
            times.append((time.thread_time() - begin) / BLOCK)
        self._medians.append(float(np.median(times)))


def _same_table(quick: bool) -> Table:
    landmarks, steps = COMPARED
    told = script(landmarks, steps)
    short = knowing_all(begun_filter("invariant", np.zeros(3), EXACT), told)
    full = knowing_all(InvariantTextbookFilter(np.zeros(3), EXACT), told)
    for look in told.looks:
        step(short, look)
        step(full, look)
    differences = [short.pose - full.pose, short.covariance - full.covariance]
    differences.append(_positions(short) - _positions(full))
    largest = [float(np.max(np.abs(each))) for each in differences]
    figures = [Value(1e9 * each, 4, at_most=None if quick else 1e9 * SAME) for each in largest]
    title = (
        f"Sigma points of what is seen against all, {landmarks} landmarks, {steps} steps: largest difference"
    )
    return Table(title, ["pose, 1e-9", "covariance, 1e-9", "landmarks, 1e-9"], [("invariant", figures)])


def _positions(landmark_filter) -> np.ndarray:
    return np.array([each.position for each in landmark_filter.landmarks])
