# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs landmark_slam's session on a round through the simulated building, with all systems or one of them."""

from functools import partial
from typing import Callable, Iterator, List, NamedTuple, Optional, Sequence

import numpy as np

import sextant
from sextant.geometry.plane_poses import wrapped
from sextant.simulation.building import Building, landmark_map
from sextant.simulation.building_round import BuildingRound, Place, RoundParams, RoundStep

SYSTEMS = ("markers", "landmarks", "places")
# of landmark_slam: metres, radians, and the errors of odometry's scales
SENSORS = {"max_range": 4.5, "field_of_view": 1.0, "scale_sigma": 0.05, "turn_scale_sigma": 0.05}
DELAY = 0.3  # seconds from a photo to its places
TRUE_SIGMA = 0.003  # metres and radians: standard deviation that a map without errors states


class Maps(NamedTuple):
    """Of one building."""

    landmarks: List  # sextant.Landmark2D of pillars and markers
    labels: List  # sextant.LandmarkLabel of each
    covariance: np.ndarray  # (3 + n, 3 + n), the robot first
    placed: Callable[[np.ndarray], np.ndarray]  # pose (3,) that the photos have for a true one


def true_maps(building: Building) -> Maps:
    """Maps without errors."""
    landmarks = landmark_map(building, np.random.default_rng(0), sigma=0.0)
    covariance = TRUE_SIGMA**2 * np.eye(len(landmarks[2]))
    return Maps(*landmarks[:2], covariance, lambda pose: pose)


def right_maps(building: Building, seed: int) -> Maps:
    """Maps that are right to a few centimetres."""
    return Maps(*landmark_map(building, np.random.default_rng([seed, 6])), lambda pose: pose)


class Look(NamedTuple):
    """What is known after one reading of odometry."""

    stamp: float  # seconds
    is_kidnapped: bool  # since the last look
    truth: np.ndarray  # (3,)
    T_odom_base: np.ndarray  # (3,)
    pose: Optional[np.ndarray]  # (3,); None: lost
    covariance: Optional[np.ndarray]  # (3, 3) in the map frame
    problems: Sequence[str] = ()  # that diagnostics report

    @property
    def error(self) -> np.ndarray:
        """(3,) of the pose."""
        off = self.pose - self.truth
        return np.array([*off[:2], wrapped(off[2])])

    @property
    def nees(self) -> float:
        """Of the pose: squared Mahalanobis distance from the true one."""
        return float(self.error @ np.linalg.solve(self.covariance, self.error))

    @property
    def distance(self) -> float:
        """Of the pose from the true one, metres; infinite if the robot is lost."""
        return np.inf if self.pose is None else float(np.hypot(*self.error[:2]))

    @property
    def sigma(self) -> float:
        """Standard deviation of the position along the worst axis, metres; infinite if the robot is lost."""
        if self.covariance is None:
            return np.inf
        return float(np.sqrt(np.linalg.eigvalsh(self.covariance[:2, :2])[-1]))


def looks(
    seed: int,
    params: RoundParams,
    systems: Sequence[str] = SYSTEMS,
    failure: Callable[[RoundStep], RoundStep] = lambda step: step,
    maps: Optional[Maps] = None,
) -> Iterator[Look]:
    """The robot is lost at first.

    :param seed: of the building
    :param failure: what is observed instead
    :param maps: of the building; by default right_maps
    """
    building, monitor = Building(seed), sextant.SourceMonitor()
    maps = maps or right_maps(building, seed)
    timeline = _timeline(maps, systems)
    waiting: List = []
    for step in map(failure, BuildingRound(building, params)):
        if step.places is not None and "places" in systems:
            waiting.append((step.stamp, _in_map(step.places, maps)))
        calls = [partial(timeline.odometry, step.stamp, step.T_odom_base), *_scans(timeline, step, systems)]
        while waiting and waiting[0][0] + DELAY <= step.stamp:
            calls.append(partial(timeline.observe_places, *waiting.pop(0)))
        if step.is_black and "places" in systems:
            monitor.add_unusable(step.stamp)
        _apply(calls, timeline, monitor)
        yield _look(step, timeline, monitor)


def _look(step: RoundStep, timeline, monitor) -> Look:
    now = None if timeline.is_lost else timeline.now
    estimate = (now.pose, now.covariance) if now else (None, None)
    return Look(step.stamp, step.is_kidnapped, step.pose, step.T_odom_base, *estimate, monitor.problems)


def _in_map(places: List[Place], maps: Maps) -> List[Place]:
    return [(maps.placed(pose), covariance, probability) for pose, covariance, probability in places]


def _apply(calls: List[Callable[[], object]], timeline, monitor) -> None:
    for call in calls:
        call()
        for applied in timeline.applied:
            monitor.add(applied)


def _timeline(maps: Maps, systems: Sequence[str]):
    """sextant.LandmarkTimeline with the parts of the map that the systems use."""
    params = sextant.LandmarkSlamNodeParams()
    params.read_only, params.start, params.places = True, "unknown", "places/hypotheses"
    for name, value in SENSORS.items():
        setattr(params, name, value)
    timeline = sextant.LandmarkSession(params).timeline
    used, rows, begin = [], [0, 1, 2], 3
    for k, (label, landmark) in enumerate(zip(maps.labels, maps.landmarks)):
        end = begin + (2 if landmark.heading is None else 3)
        if ("landmarks" if label.id is None else "markers") in systems:
            used.append(k)
            rows += range(begin, end)
        begin = end
    if used:
        landmarks, labels = [maps.landmarks[k] for k in used], [maps.labels[k] for k in used]
        timeline.set_map(np.zeros(3), landmarks, labels, maps.covariance[np.ix_(rows, rows)])
        timeline.relocalize()
    return timeline


def _scans(timeline, step: RoundStep, systems: Sequence[str]) -> List[Callable[[], object]]:
    """Calls that add the scans of a step."""
    calls: List[Callable[[], object]] = []
    if step.pillars is not None and "landmarks" in systems:
        calls.append(partial(timeline.observe, step.stamp, step.pillars, np.zeros(3)))
    if step.markers is not None and "markers" in systems:
        detects = sextant.Detects.WITH_ID
        calls.append(partial(timeline.observe, step.stamp, step.markers, np.zeros(3), detects))
    return calls
