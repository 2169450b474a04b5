# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What one bad message costs, and whether hours in a large map do.

A bad message comes in the middle of a drive; the next good one is answered when the pose that it gives is
there, by the same conversion and calls as in the node. The map is compared with that of a drive without it:
no landmark may have moved by more than its standard deviation.

In the long drive all landmarks are in the map from the start, as after it was loaded, so that quarters of the
drive compare. Landmarks have no ids: up to `hypotheses` states are kept. Time is that of the process.
"""

import os
import time
from typing import Callable, Dict, List, NamedTuple, Optional

import numpy as np
from ros_session import resident_bytes
from tables import Row, Table, Value

import sextant
from sextant.geometry.plane_poses import composed, in_frame
from sextant.messages.landmark_messages import landmark_observations
from sextant.msg import LandmarkObservation, LandmarkObservations
from sextant.simulation.landmark_world import LandmarkWorld, LandmarkWorldParams, SimulationStep

FLOOD, ALLOWED = 5000, 100  # observations in one message; as max_observations
ANSWER = 0.5  # seconds
BEFORE, AFTER = 60.0, 30.0  # seconds of the drive
LONG, LARGE = 7200.0, 1000  # seconds, landmarks
HYPOTHESES, MIDDLE, SHORT = 8, 500, 600.0  # of the comparison: states, landmarks, seconds
QUICK = 20.0  # seconds, with 50 landmarks
PARTS = 4
FLAT, GROWTH, FACTOR = 1.2, 20.0, 2.0  # time over that of the first part; MB; time over that of one state


def limit_tables(quick: bool) -> List[Table]:
    """Three tables; a quick run has short drives and small maps, without bars but those of bad messages."""
    return [_bad_messages(), _long_drive(quick), _hypotheses(quick)]


# --- bad messages ---


class Outcome(NamedTuple):
    """Of a drive with a bad message, or without."""

    seconds: float  # until the next good one was answered
    landmarks: np.ndarray  # (n, 2) at the end
    sigmas: np.ndarray  # (n,) standard deviations of their positions along the worst axis, metres


def _bad_messages() -> Table:
    good = _driven(None)
    rows: List[Row] = []
    for name, message in BAD.items():
        found = _driven(message())
        is_same = found.landmarks.shape == good.landmarks.shape
        moved = np.hypot(*(found.landmarks - good.landmarks).T) if is_same else np.array([np.inf])
        figures = [
            Value(found.seconds, 3, at_most=ANSWER),
            Value(len(found.landmarks) - len(good.landmarks), 0, at_most=0, at_least=0),
            Value(moved.max(), 3),
            Value((moved / good.sigmas).max(), 2, at_most=1.0),
        ]
        rows.append((name, figures))
    title = "One bad message in a drive among 15 landmarks"
    columns = ["next answer after, s", "landmarks more", "largest change of one, m", "over its sigma"]
    return Table(title, columns, rows)


def _driven(bad: Optional[LandmarkObservations]) -> Outcome:
    world = LandmarkWorld(LandmarkWorldParams(seed=1, duration=BEFORE + AFTER))
    run, seconds, is_waiting = _Run(sextant.LandmarkSession(sextant.LandmarkSlamNodeParams())), 0.0, False
    begin = 0.0
    for step in world.steps():
        if bad is not None and step.scan and step.stamp > BEFORE:
            begin, is_waiting = time.process_time(), True
            run.observe(step.stamp - 0.02, bad)
            bad = None
        run.step(step)
        if is_waiting and step.scan:
            seconds, is_waiting = time.process_time() - begin, False
    return Outcome(seconds, run.positions(), run.sigmas())


def _flood(count: int, span: float) -> LandmarkObservations:
    rng = np.random.default_rng(count)
    return LandmarkObservations(
        observations=[
            _message(rng.uniform((0.5, -span), (5.0, span)), 0.01 * np.eye(2)) for _ in range(count)
        ]
    )


def _one(position, covariance, heading: float = np.nan) -> LandmarkObservations:
    return LandmarkObservations(observations=[_message(position, covariance, heading)])


BAD: Dict[str, Callable[[], LandmarkObservations]] = {
    f"{FLOOD} detections in range": lambda: _flood(FLOOD, 3.0),
    f"{ALLOWED} detections in range": lambda: _flood(ALLOWED, 3.0),
    "a position of 1e308 m": lambda: _one((1e308, -1e308), np.eye(2)),
    "a position of 1e12 m": lambda: _one((1e12, 0.0), np.eye(2)),
    "a covariance of 1e300 m2": lambda: _one((2.0, 0.0), 1e300 * np.eye(2)),
    "a covariance of 1e-300 m2": lambda: _one((2.0, 0.0), 1e-300 * np.eye(2)),
    "a covariance of 0": lambda: _one((2.0, 0.0), np.zeros((2, 2))),
    "a position that is no number": lambda: _one((np.nan, 0.0), np.eye(2)),
    "a heading of 1e308": lambda: _one((2.0, 0.0), np.eye(3), 1e308),
}


# --- long drives ---


def _long_drive(quick: bool) -> Table:
    duration, landmarks = (QUICK, 50) if quick else (LONG, LARGE)
    parts = _timed(duration, landmarks, HYPOTHESES, PARTS)
    rows: List[Row] = []
    for number, part in enumerate(parts):
        is_first = number == 0
        figures = [
            Value(part.mean, 2),
            "-" if is_first else Value(part.mean / parts[0].mean, 2, at_most=None if quick else FLAT),
            Value(part.worst, 1),
            Value(part.memory, 0),
            "-" if is_first else Value(part.memory - parts[0].memory, 0, at_most=None if quick else GROWTH),
            Value(part.landmarks, 0),
            Value(part.hypotheses, 2),
        ]
        rows.append((f"part {number + 1} of {PARTS}", figures))
    columns = [
        "ms a scan",
        "of part 1",
        "worst, ms",
        "memory, MB",
        "more than part 1, MB",
        "landmarks",
        "states in the mean",
    ]
    return Table(f"{duration:g} s in a map of {landmarks} landmarks without ids", columns, rows)


def _hypotheses(quick: bool) -> Table:
    duration, landmarks = (QUICK, 50) if quick else (SHORT, MIDDLE)
    (one,), (several,) = (_timed(duration, landmarks, states, 1) for states in (1, HYPOTHESES))
    rows: List[Row] = [
        ("1 state", [Value(one.mean, 2), "-", Value(one.hypotheses, 2)]),
        (
            f"up to {HYPOTHESES} states",
            [
                Value(several.mean, 2),
                Value(several.mean / one.mean, 2, at_most=None if quick else FACTOR),
                Value(several.hypotheses, 2),
            ],
        ),
    ]
    title = f"{duration:g} s in a map of {landmarks} landmarks without ids: hypotheses"
    return Table(title, ["ms a scan", "of one state", "states in the mean"], rows)


class Part(NamedTuple):
    """Of a drive."""

    mean: float  # ms a scan, with the odometry before it
    worst: float  # ms a scan
    memory: float  # MB at its end
    landmarks: int  # in the map at its end
    hypotheses: float  # in the mean


def _timed(duration: float, landmarks: int, hypotheses: int, parts: int) -> List[Part]:
    world = LandmarkWorld(_large_world(duration, landmarks))
    params = sextant.LandmarkSlamNodeParams()
    params.hypotheses = hypotheses
    run = _Run(sextant.LandmarkSession(params))
    run.set_map(world)
    each, found, spent = [], [], 0.0
    states: List[int] = []
    scans = round(duration * world.params.sensor_rate)
    for step in world.steps():
        begin = time.process_time()
        run.step(step)
        spent += time.process_time() - begin
        if step.scan:
            each.append(1e3 * spent)
            states.append(run.session.timeline.hypotheses)
            spent = 0.0
            if len(each) >= scans // parts:
                of_map = _memory(), len(run.positions())
                found.append(Part(float(np.mean(each)), max(each), *of_map, float(np.mean(states))))
                each, states = [], []
    return found


def _large_world(duration: float, landmarks: int) -> LandmarkWorldParams:
    """As dense as 1000 landmarks in 120 m x 120 m."""
    half_side = 60.0 * np.sqrt(landmarks / LARGE)
    return LandmarkWorldParams(
        seed=7, landmarks=landmarks, half_side=half_side, duration=duration, speed=1.0,
        detection_probability=0.9, false_alarm_probability=0.01,
    )  # fmt: skip


def _memory() -> float:
    """Resident memory of this process, MB."""
    return resident_bytes(os.getpid()) / 1e6


class _Run:
    """A session on a simulated drive."""

    def __init__(self, session):
        self.session, self._odometry = session, np.zeros(3)
        self.session.timeline.odometry(1.0, self._odometry)

    def set_map(self, world: LandmarkWorld) -> None:
        """The true landmarks, known to 2 cm."""
        landmarks = [sextant.Landmark2D(each) for each in in_frame(world.start, world.positions)]
        labels = [sextant.LandmarkLabel(name) for name in world.classes]
        covariance = 0.02**2 * np.eye(3 + 2 * len(landmarks))
        self.session.timeline.set_map(np.zeros(3), landmarks, labels, covariance)

    def step(self, step: SimulationStep) -> None:
        """Odometry, and the scan that comes with it."""
        self._odometry = composed(self._odometry, step.odometry_step)
        self.session.timeline.odometry(1.0 + step.stamp, self._odometry)
        if step.scan:
            seen = step.scan.observations
            messages = [_message(each.position, each.covariance, name=each.class_name) for each in seen]
            self.observe(step.stamp, LandmarkObservations(observations=messages))

    def observe(self, stamp: float, message: LandmarkObservations) -> None:
        """Converts the message and applies it, as the node does; a damaged one is refused."""
        try:
            observations = landmark_observations(message, np.eye(4))
        except ValueError:
            return
        self.session.timeline.observe(1.0 + stamp, observations, np.zeros(3))
        assert self.session.timeline.now is not None or self.session.timeline.is_lost

    def positions(self) -> np.ndarray:
        """(n, 2) of all landmarks."""
        landmarks = self.session.timeline.slam.filter.landmarks
        return np.array([each.position for each in landmarks]).reshape(-1, 2)

    def sigmas(self) -> np.ndarray:
        """(n,) standard deviations of their positions along the worst axis, metres."""
        covariance = self.session.timeline.slam.filter.covariance
        blocks = [covariance[k : k + 2, k : k + 2] for k in range(3, len(covariance), 2)]
        return np.sqrt([np.linalg.eigvalsh(block)[-1] for block in blocks])


def _message(
    position, covariance: np.ndarray, heading: float = np.nan, name: str = "blue_pillar"
) -> LandmarkObservation:
    full = np.zeros((3, 3))
    full[: len(covariance), : len(covariance)] = covariance
    return LandmarkObservation(name, -1, *map(float, position), heading, full.ravel().tolist())
