# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Rounds in which one system fails after a third of the time, and stays so.

The pose is within three standard deviations if the squared Mahalanobis distance of all three numbers is below
the quantile of chi-squared for 99.73 %; without a pose it is not. The time from the first observation that
shows the failure until diagnostics name it counts.
"""

from concurrent.futures import ProcessPoolExecutor
from typing import Callable, Dict, List, NamedTuple, Optional, Tuple, Union

import numpy as np
from tables import Row, Table, Value

import sextant
from one_pose.rounds import Look, looks
from sextant.geometry.plane_poses import composed, rotation
from sextant.simulation.building import Building, observed_pillars
from sextant.simulation.building_round import RoundParams, RoundStep

ROUNDS, FIRST_SEED = 20, 13000  # the seeds below were used to choose parameters
QUICK_ROUNDS, QUICK_DURATION = 1, 90.0  # seconds
THREE_SIGMA = 14.16  # of chi-squared with three degrees of freedom: 99.73 %
WITHIN, NAMED = 95.0, 10.0  # % of the time; seconds
MARKERS_OFF = np.array([2.0, 0.0])  # metres in the map frame
OTHER_BUILDING = np.array([9.0, 5.0, 1.2])  # pose of the wrong place map in the right one
MOVED = (1.0, 2.0)  # metres, least and most
COLUMNS = [
    "within 3 sigma, %",
    "worst round",
    "without a pose, %",
    "named within 10 s, %",
    "after, s (median)",
    "others named, %",
]


class Fails:
    """What is observed after the failure: an example for each system."""

    def __init__(self, seed: int, begin: float):
        self._begin, self._rng = begin, np.random.default_rng([seed, 5])
        self.shown: Optional[float] = None  # stamp of the first observation that shows the failure
        self._building = Building(seed)

    def __call__(self, step: RoundStep) -> RoundStep:
        if step.stamp < self._begin:
            return step
        failed, shows = self._failed(step)
        if shows and self.shown is None:
            self.shown = step.stamp
        return failed

    def _failed(self, step: RoundStep) -> Tuple[RoundStep, bool]:
        """The step as it is observed, and whether it shows the failure."""
        raise NotImplementedError


class Nothing(Fails):
    """No failure: nothing may be named."""

    text = "no such text"

    def _failed(self, step: RoundStep) -> Tuple[RoundStep, bool]:
        return step, False


class CameraBlack(Fails):
    """Nothing is detected or recognized."""

    text = "is the camera covered"

    def _failed(self, step: RoundStep) -> Tuple[RoundStep, bool]:
        nothing = [] if step.pillars is not None else None
        black = step._replace(pillars=nothing, markers=nothing, places=None, is_black=step.places is not None)
        return black, True


class MarkersOff(Fails):
    """Markers as if their map were off by MARKERS_OFF."""

    text = "markers are not where"

    def _failed(self, step: RoundStep) -> Tuple[RoundStep, bool]:
        if step.markers is None:
            return step, False
        off = -rotation(step.pose[2]).T @ MARKERS_OFF
        return step._replace(markers=[_moved(each, off) for each in step.markers]), bool(step.markers)


class WrongPlaces(Fails):
    """Places of another building."""

    text = "the recognized places contradict"

    def _failed(self, step: RoundStep) -> Tuple[RoundStep, bool]:
        if step.places is None:
            return step, False
        places = [(composed(OTHER_BUILDING, pose), *rest) for pose, *rest in step.places]
        return step._replace(places=places), bool(places)


class LandmarksMoved(Fails):
    """Each pillar elsewhere."""

    text = "landmarks are not where"

    def __init__(self, seed: int, begin: float):
        super().__init__(seed, begin)
        count = len(self._building.pillars)
        angles, distances = self._rng.uniform(-np.pi, np.pi, count), self._rng.uniform(*MOVED, count)
        self._building.pillars = self._building.pillars + (distances * [np.cos(angles), np.sin(angles)]).T

    def _failed(self, step: RoundStep) -> Tuple[RoundStep, bool]:
        if step.pillars is None:
            return step, False
        pillars = observed_pillars(self._building, step.pose, self._rng)
        return step._replace(pillars=pillars), bool(pillars)


NONE = "no failure"
FAILURES: Dict[str, Callable[[int, float], Fails]] = {
    NONE: Nothing,
    "camera black": CameraBlack,
    "marker map off by 2 m": MarkersOff,
    "wrong place map": WrongPlaces,
    "landmarks moved": LandmarksMoved,
}


def _moved(seen, off: np.ndarray):
    """sextant.LabelledObservation at another position, off (2,) in the robot frame."""
    observation = seen.observation
    moved = sextant.Observation2D(observation.position + off, observation.covariance, observation.heading)
    return sextant.LabelledObservation(seen.label, moved)


class Outcome(NamedTuple):
    """Of one round, since the failure."""

    within: float  # share of the time
    lost: float  # share of the time
    after: Optional[float]  # seconds until the failure was named; None: it was not
    others: bool  # whether another source was named


def failure_tables(quick: bool) -> List[Table]:
    """One table; a quick run has one short round of each, without bars."""
    rounds, duration = (QUICK_ROUNDS, QUICK_DURATION) if quick else (ROUNDS, 600.0)
    jobs = [(FIRST_SEED + k, duration, name) for name in FAILURES for k in range(rounds)]
    with ProcessPoolExecutor() as pool:
        done = list(pool.map(driven, *zip(*jobs)))
    rows: List[Row] = [
        (name, _figures(name, done[k * rounds : (k + 1) * rounds], quick)) for k, name in enumerate(FAILURES)
    ]
    title = f"{rounds} rounds of {duration:g} s in which one system fails after a third"
    return [Table(title, COLUMNS, rows)]


def driven(seed: int, duration: float, name: str) -> Outcome:
    """One round."""
    begin = duration / 3
    failure = FAILURES[name](seed, begin)
    params = RoundParams(seed=seed, duration=duration, kidnappings=0)
    since = [look for look in looks(seed, params, failure=failure) if look.stamp >= begin]
    return judged(since, failure.shown, failure.text)


def judged(since: List[Look], shown: Optional[float], text: str) -> Outcome:
    """The outcome of the looks since the failure. :param shown: stamp from which on it can be named"""
    named = next((look for look in since if any(text in each for each in look.problems)), None)
    after = None if named is None or shown is None else max(0.0, named.stamp - shown)
    others = any(text not in each for look in since for each in look.problems)
    return Outcome(
        float(np.mean([_is_within(look) for look in since])),
        float(np.mean([look.pose is None for look in since])),
        after,
        others,
    )


def _is_within(look: Look) -> bool:
    return look.pose is not None and look.nees < THREE_SIGMA


def _figures(name: str, outcomes: List[Outcome], quick: bool) -> List[Union[Value, str]]:
    within, lost, after, others = np.array(
        [each._replace(after=np.inf if each.after is None else each.after) for each in outcomes], dtype=float
    ).T
    named: List[Union[Value, str]] = [
        Value(100 * (after <= NAMED).mean(), 0, at_least=None if quick else 100),
        Value(float(np.median(after)), 1),
    ]
    return [
        Value(100 * within.mean(), 1, at_least=None if quick else WITHIN),
        Value(100 * within.min(), 1),
        Value(100 * lost.mean(), 1),
        *(["-", "-"] if name == NONE else named),
        Value(100 * others.mean(), 0),
    ]
