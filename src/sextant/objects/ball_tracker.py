# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Follows one ball by its sightings, in a frame that does not jump: odometry's."""

from dataclasses import dataclass
from typing import Callable, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from sextant.base.strict_params import StrictParams, nested, param, within
from sextant.objects.ball_motion import (
    BallModes,
    BallMotionParams,
    distance,
    jumped,
    merged,
    moved_on,
    seen_again,
    seen_first,
)

GATE = 13.8  # squared deviations, which 0.1 % of the sightings of a ball are beyond
LATEST = 1.0  # seconds that a look may come later than others

Sighting = Tuple[np.ndarray, np.ndarray]  # position (2,) and covariance (2, 2), metres


@dataclass(frozen=True)
class BallTrackerParams(StrictParams):
    """When a ball is believed, and how long."""

    begin: int = param(2, within(1, 100))  # sightings that agree, from which on there is a ball
    move: int = param(4, within(1, 100))  # the same elsewhere while it is not seen, after which it is there
    missed: int = param(8, within(1, 10000))  # looks that should show it and do not, after which it is gone
    memory: float = param(60.0, within(0.1, 3600))  # seconds after its last sighting that it is believed
    motion: BallMotionParams = nested(BallMotionParams)


class BallEstimate(NamedTuple):
    """Where a ball is, and how fast."""

    position: np.ndarray  # (2,) metres
    velocity: np.ndarray  # (2,) m/s
    covariance: np.ndarray  # (4, 4) of both
    seen: float  # seconds, stamp of the last sighting


class _Track(NamedTuple):
    """What is known after a look."""

    stamp: float  # of the last sighting, seconds
    modes: BallModes  # then
    missed: int = 0  # looks since then in which it should have been seen


class _Rival(NamedTuple):
    """Another ball, or the first."""

    stamp: float
    modes: BallModes
    seen: int  # times


class _Look(NamedTuple):
    stamp: float
    sightings: Sequence[Sighting]
    should_see: Callable[[np.ndarray], bool]


class _Known(NamedTuple):
    """After a look."""

    look: _Look
    track: Optional[_Track]
    rival: Optional[_Rival]


_NOTHING = _Known(_Look(-np.inf, [], lambda position: False), None, None)


class BallTracker:
    """Looks may come late and in any order within a second."""

    def __init__(self, params: BallTrackerParams):
        """:raises ValueError: a setting out of range"""
        self._params = params
        self._known: List[_Known] = [_NOTHING]  # by stamp

    def look(
        self, stamp: float, sightings: Sequence[Sighting], should_see: Callable[[np.ndarray], bool]
    ) -> None:
        """One picture.

        :param stamp: seconds
        :param sightings: of balls in it; none: there is none in it
        :param should_see: whether a ball at a position (2,) would be in it
        """
        later = [each.look for each in self._known if each.look.stamp > stamp]
        self._known = [each for each in self._known if each.look.stamp <= stamp]
        if not self._known:
            self._known = [_NOTHING]  # it is older than all that is remembered
        for look in (_Look(stamp, sightings, should_see), *later):
            self._known.append(self._after(self._known[-1], look))
        newest = self._known[-1].look.stamp
        # One before the oldest that may come, for it to begin with.
        while len(self._known) > 1 and self._known[1].look.stamp < newest - LATEST:
            del self._known[0]

    def at(self, stamp: float) -> Optional[BallEstimate]:
        """At any later moment, or one within the last second; None: nobody knows."""
        track = next((each.track for each in reversed(self._known) if each.look.stamp <= stamp), None)
        if track is None or stamp - track.stamp > self._params.memory:
            return None
        mean, covariance = merged(moved_on(track.modes, stamp - track.stamp, self._params.motion))
        return BallEstimate(mean[:2], mean[2:], covariance, track.stamp)

    def clear(self) -> None:
        """Forgets everything."""
        self._known = [_NOTHING]

    def _after(self, known: _Known, look: _Look) -> _Known:
        track, used = self._followed(known.track, look)
        if used is not None:
            return _Known(look, track, None)
        rival = self._rival(known.rival, look)
        needed = self._params.begin if track is None else self._params.move
        if rival is not None and rival.seen >= needed:
            return _Known(look, _Track(rival.stamp, rival.modes), None)
        return _Known(look, track, rival)

    def _followed(self, track: Optional[_Track], look: _Look) -> Tuple[Optional[_Track], Optional[int]]:
        """The track after a look, and which sighting is of it."""
        params = self._params
        if track is None or look.stamp - track.stamp > params.memory:
            return None, None
        modes = jumped(track.modes, look.stamp - track.stamp, params.motion)
        best = _nearest(modes, look.sightings)
        if best is not None:
            return _Track(look.stamp, seen_again(modes, *look.sightings[best])), best
        here = merged(moved_on(track.modes, look.stamp - track.stamp, params.motion))[0][:2]
        missed = track.missed + bool(look.should_see(here))
        return (None if missed >= params.missed else track._replace(missed=missed)), None

    def _rival(self, rival: Optional[_Rival], look: _Look) -> Optional[_Rival]:
        """The ball that is not the one that is followed; the surest sighting is the first."""
        motion = self._params.motion
        if not look.sightings:
            return rival if rival and look.stamp - rival.stamp < LATEST else None
        if rival is not None:
            modes = jumped(rival.modes, look.stamp - rival.stamp, motion)
            best = _nearest(modes, look.sightings)
            if best is not None:
                return _Rival(look.stamp, seen_again(modes, *look.sightings[best]), rival.seen + 1)
        return _Rival(look.stamp, seen_first(*look.sightings[0], motion), 1)


def _nearest(modes: BallModes, sightings: Sequence[Sighting]) -> Optional[int]:
    """Index of the sighting that fits best; None: none is within the gate."""
    distances = [distance(modes, *each) for each in sightings]
    best = int(np.argmin(distances)) if distances else 0
    return best if distances and distances[best] < GATE else None
