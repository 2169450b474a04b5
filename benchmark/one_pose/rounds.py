# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs landmark_slam's session on a round through the simulated building, with all systems or one of them."""

from typing import Iterator, List, NamedTuple, Optional, Sequence

import numpy as np

import sextant
from sextant.geometry.plane_poses import wrapped
from sextant.simulation.building import Building, landmark_map
from sextant.simulation.building_round import BuildingRound, RoundParams, RoundStep

SYSTEMS = ("markers", "landmarks", "places")
DELAY = 0.3  # seconds from a photo to its places


class Look(NamedTuple):
    """What is known after one reading of odometry."""

    stamp: float  # seconds
    is_kidnapped: bool  # since the last look
    truth: np.ndarray  # (3,)
    T_odom_base: np.ndarray  # (3,)
    pose: Optional[np.ndarray]  # (3,); None: lost
    covariance: Optional[np.ndarray]  # (3, 3) in the map frame

    @property
    def error(self) -> np.ndarray:
        """(3,) of the pose."""
        off = self.pose - self.truth
        return np.array([*off[:2], wrapped(off[2])])

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


def looks(seed: int, params: RoundParams, systems: Sequence[str] = SYSTEMS) -> Iterator[Look]:
    """The robot is lost at first; its maps are right to a few centimetres."""
    building = Building(seed)
    session = _session(building, systems)
    waiting: List = []
    for step in BuildingRound(building, params):
        session.odometry(step.stamp, step.T_odom_base)
        _observe(session, step, systems)
        if step.places is not None and "places" in systems:
            waiting.append((step.stamp, step.places))
        while waiting and waiting[0][0] + DELAY <= step.stamp:
            session.observe_places(*waiting.pop(0))
        now = None if session.is_lost else session.now
        estimate = (now.pose, now.covariance) if now else (None, None)
        yield Look(step.stamp, step.is_kidnapped, step.pose, step.T_odom_base, *estimate)


def _session(building: Building, systems: Sequence[str]):
    """sextant.LandmarkTimeline with the parts of the map that the systems use."""
    params = sextant.LandmarkSlamNodeParams()
    params.read_only, params.start, params.places = True, "unknown", "places/hypotheses"
    params.max_range, params.field_of_view, params.scale_sigma = 4.5, 1.0, 0.05
    timeline = sextant.LandmarkSession(params).timeline
    landmarks, labels, covariance = landmark_map(building)
    kinds = ["landmarks" if label.id is None else "markers" for label in labels]
    used = [k for k, kind in enumerate(kinds) if kind in systems]
    if used:
        size = 3 + sum(2 if landmarks[k].heading is None else 3 for k in used)
        kept = covariance[:size, :size]  # all have the same variance, without correlations
        timeline.set_map(np.zeros(3), [landmarks[k] for k in used], [labels[k] for k in used], kept)
        timeline.relocalize()
    return timeline


def _observe(timeline, step: RoundStep, systems: Sequence[str]) -> None:
    if step.pillars is not None and "landmarks" in systems:
        timeline.observe(step.stamp, step.pillars, np.zeros(3))
    if step.markers is not None and "markers" in systems:
        timeline.observe(step.stamp, step.markers, np.zeros(3), sextant.Detects.WITH_ID)
