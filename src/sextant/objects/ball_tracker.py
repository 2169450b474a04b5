# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tracking of one ball in the odometry frame, which has no jumps."""

from dataclasses import dataclass
from typing import Callable, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from sextant.base.strict_params import StrictParams, nested, param, within
from sextant.objects.ball_filter import (
    BallModes,
    BallMotionParams,
    combined,
    initial_modes,
    predicted,
    predicted_with_transitions,
    squared_distance,
    updated,
)

GATE = 13.8  # squared Mahalanobis distance; 0.1 % quantile of chi-squared with 2 degrees of freedom
MAX_DELAY = 1.0  # seconds by which an image may arrive after later ones

Observation = Tuple[np.ndarray, np.ndarray]  # position (2,) and covariance (2, 2), metres


@dataclass(frozen=True)
class BallTrackerParams(StrictParams):
    """When a track is confirmed, moved and deleted."""

    confirm_hits: int = param(2, "consistent observations that confirm a ball", within(1, 100))
    relocate_hits: int = param(
        4,
        "consistent observations elsewhere that move the ball there, if it is not detected where it "
        "is predicted",
        within(1, 100),
    )
    max_misses: int = param(
        8,
        "number of images with the ball in view but not detected after which the ball is deleted",
        within(1, 10000),
    )
    max_age: float = param(
        60.0, "time since the last observation after which the ball is deleted", within(0.1, 3600), "s"
    )
    motion: BallMotionParams = nested(BallMotionParams, "ball_")


class BallEstimate(NamedTuple):
    """Position and velocity of a ball in the frame of its observations."""

    position: np.ndarray  # (2,) metres
    velocity: np.ndarray  # (2,) m/s
    covariance: np.ndarray  # (4, 4) of position and velocity
    seen: float  # seconds, stamp of the last observation


class _Track(NamedTuple):
    """A ball hypothesis."""

    stamp: float  # of the last observation, seconds
    modes: BallModes  # at that stamp
    hits: int = 1  # consistent observations before it is confirmed
    misses: int = 0  # images since the last observation in which the ball was in view


class _Scan(NamedTuple):
    """The observations of one image."""

    stamp: float
    observations: Sequence[Observation]
    is_visible: Callable[[np.ndarray], bool]


class _State(NamedTuple):
    """The tracker after a scan."""

    scan: _Scan
    track: Optional[_Track]  # confirmed
    candidate: Optional[_Track]  # not confirmed


_INITIAL = _State(_Scan(-np.inf, [], lambda position: False), None, None)


class BallTracker:
    """Tracks a ball; images may arrive in any order within MAX_DELAY."""

    def __init__(self, params: BallTrackerParams):
        """:raises ValueError: a parameter out of range"""
        self._params = params
        self._states: List[_State] = [_INITIAL]  # by stamp

    def update(
        self, stamp: float, observations: Sequence[Observation], is_visible: Callable[[np.ndarray], bool]
    ) -> None:
        """Add the observations of one image, then process later images again.

        :param stamp: seconds
        :param observations: of all balls in the image, most certain first
        :param is_visible: whether a ball at a position (2,) would be detected in the image
        """
        later = [each.scan for each in self._states if each.scan.stamp > stamp]
        self._states = [each for each in self._states if each.scan.stamp <= stamp]
        if not self._states:
            self._states = [_INITIAL]  # older than every stored state
        for scan in (_Scan(stamp, observations, is_visible), *later):
            self._states.append(self._after(self._states[-1], scan))
        newest = self._states[-1].scan.stamp
        # Keep one state older than MAX_DELAY: the oldest scan accepted starts from it.
        while len(self._states) > 1 and self._states[1].scan.stamp < newest - MAX_DELAY:
            del self._states[0]

    def at(self, stamp: float) -> Optional[BallEstimate]:
        """Estimate at a later time or within the last MAX_DELAY seconds; None: no confirmed ball."""
        track = next((each.track for each in reversed(self._states) if each.scan.stamp <= stamp), None)
        if track is None or stamp - track.stamp > self._params.max_age:
            return None
        mean, covariance = combined(predicted(track.modes, stamp - track.stamp, self._params.motion))
        return BallEstimate(mean[:2], mean[2:], covariance, track.stamp)

    def clear(self) -> None:
        """Delete all tracks."""
        self._states = [_INITIAL]

    def _after(self, state: _State, scan: _Scan) -> _State:
        track, used = self._updated_track(state.track, scan)
        if used is not None:
            return _State(scan, track, None)
        candidate = self._updated_candidate(state.candidate, scan)
        needed = self._params.confirm_hits if track is None else self._params.relocate_hits
        if candidate is not None and candidate.hits >= needed:
            return _State(scan, candidate, None)
        return _State(scan, track, candidate)

    def _updated_track(self, track: Optional[_Track], scan: _Scan) -> Tuple[Optional[_Track], Optional[int]]:
        """The track after a scan, and the index of the observation associated with it."""
        params = self._params
        if track is None or scan.stamp - track.stamp > params.max_age:
            return None, None
        modes = predicted_with_transitions(track.modes, scan.stamp - track.stamp, params.motion)
        best = _associated(modes, scan.observations)
        if best is not None:
            return _Track(scan.stamp, updated(modes, *scan.observations[best])), best
        here = combined(predicted(track.modes, scan.stamp - track.stamp, params.motion))[0][:2]
        misses = track.misses + bool(scan.is_visible(here))
        return (None if misses >= params.max_misses else track._replace(misses=misses)), None

    def _updated_candidate(self, candidate: Optional[_Track], scan: _Scan) -> Optional[_Track]:
        """The candidate after a scan; a new one starts from the first, most certain observation."""
        motion = self._params.motion
        if not scan.observations:
            return candidate if candidate and scan.stamp - candidate.stamp < MAX_DELAY else None
        if candidate is not None:
            modes = predicted_with_transitions(candidate.modes, scan.stamp - candidate.stamp, motion)
            best = _associated(modes, scan.observations)
            if best is not None:
                return _Track(scan.stamp, updated(modes, *scan.observations[best]), candidate.hits + 1)
        return _Track(scan.stamp, initial_modes(*scan.observations[0], motion))


def _associated(modes: BallModes, observations: Sequence[Observation]) -> Optional[int]:
    """Index of the nearest observation; None: none is within the gate."""
    distances = [squared_distance(modes, *each) for each in observations]
    best = int(np.argmin(distances)) if distances else 0
    return best if distances and distances[best] < GATE else None
