# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Landmark SLAM on messages that were recorded: the same figures as online."""

from collections import Counter
from dataclasses import dataclass, field
from typing import Dict, NamedTuple, Optional, Sequence

import numpy as np
from scipy.linalg import block_diag

import sextant


class Leg(NamedTuple):
    """A drive without interruption: poses (3,) x, y, heading by stamp in nanoseconds."""

    odometry: Dict[int, np.ndarray]  # odometry's frame
    robot: Dict[int, np.ndarray]  # the map's; where it was known


@dataclass
class SlamTally:
    """What became of all sightings."""

    known: int = 0
    doubtful: int = 0
    rejected: int = 0
    begun: int = 0
    merged: int = 0
    removed: int = 0
    nis: float = 0.0  # sum
    nis_width: int = 0  # its degrees of freedom
    arrivals: Counter = field(default_factory=Counter)  # sextant.Arrival: moments
    early: int = 0  # of those that came too late: no odometry goes as far back
    seen: Counter = field(default_factory=Counter)  # key of a landmark: sightings
    way: float = 0.0  # metres, by odometry
    duration: float = 0.0  # seconds, by odometry
    lost: float = 0.0  # of them

    def add(self, report: "sextant.LandmarkReport") -> None:
        """A moment's."""
        for name in ("known", "doubtful", "rejected", "begun", "merged", "removed", "nis_width"):
            setattr(self, name, getattr(self, name) + getattr(report, name))
        self.nis += report.nis if report.nis_width else 0.0
        self.seen.update(key for key in report.keys if key is not None)


class SlamRun:
    """What the nodelet does with its messages, without it."""

    def __init__(
        self,
        params: "sextant.LandmarkSlamNodeParams",
        start_map: Optional["sextant.LandmarkMap"] = None,
        marker_map: Optional["sextant.MarkerMap"] = None,
    ):
        """The robot is in start_map where params.start puts it; among markers it is found by them,
        unless there is a start_pose.

        :raises ValueError: both maps are given
        """
        self.params, self.frame = params, params.map_frame
        slam = sextant.LandmarkSlam(params.slam, params.first_pose, params.first_covariance)
        self.timeline = sextant.LandmarkTimeline(params.timeline, slam)
        self.tally, self.legs = SlamTally(), [Leg({}, {})]
        if start_map and marker_map:
            raise ValueError("a landmark map and a marker map are given: the first may hold markers, too")
        if marker_map:
            self._begin_with_markers(marker_map)
        if start_map:
            self._begin_with(start_map, params.start)

    def _begin_with(self, start_map: "sextant.LandmarkMap", start: str) -> None:
        self.frame = start_map.frame
        self.timeline.set_map(start_map.pose, start_map.landmarks, start_map.labels, start_map.covariance)
        if start == "origin":
            self.timeline.set_pose(self.params.first_pose, self.params.first_covariance)
        if start == "unknown" or (start == "map" and start_map.is_lost):
            self.timeline.lose()

    def _begin_with_markers(self, marker_map: "sextant.MarkerMap") -> None:
        """Each by itself: a map of markers does not tell how their errors depend on one another."""
        landmarks, labels, covariances = sextant.marker_landmarks(marker_map)
        covariance = block_diag(self.params.first_covariance, *covariances)
        self.frame = marker_map.frame
        self.timeline.set_map(self.params.first_pose, landmarks, labels, covariance)
        if not self.params.start_pose:
            self.timeline.lose()

    def odometry(self, stamp: int, T_odom_base: np.ndarray) -> bool:
        """(3,) x, y, heading at a stamp in nanoseconds. False: it is not newer than the last one."""
        leaps = self.timeline.leaps
        if not self.timeline.odometry(seconds_of(stamp), T_odom_base):
            return False
        if self.timeline.leaps > leaps:
            self.legs.append(Leg({}, {}))
        self._count_applied()
        self._count(stamp, T_odom_base)
        now = None if self.timeline.is_lost else self.timeline.now
        if now:
            self.legs[-1].robot[stamp] = now.pose
        return True

    def _count(self, stamp: int, T_odom_base: np.ndarray) -> None:
        odometry = self.legs[-1].odometry
        if odometry:
            before, pose = next(reversed(odometry.items()))
            duration = 1e-9 * (stamp - before)
            self.tally.way += float(np.hypot(*(T_odom_base - pose)[:2]))
            self.tally.duration += duration
            self.tally.lost += duration if self.timeline.is_lost else 0.0
        odometry[stamp] = np.asarray(T_odom_base)

    def see(
        self, stamp: int, sightings: Sequence["sextant.LabelledSighting"], T_base_sensor: np.ndarray
    ) -> "sextant.Arrival":
        """All that a sensor saw at a stamp in nanoseconds, in the robot frame.

        :param T_base_sensor: (3,) x, y, heading of what it looks from and along
        """
        arrival = self.timeline.see(seconds_of(stamp), list(sightings), T_base_sensor)
        self.tally.arrivals[arrival] += 1
        if arrival == sextant.Arrival.TOO_LATE:
            moment = seconds_of(stamp) + self.params.timeline.clock_offset
            self.tally.early += moment < seconds_of(next(iter(self.legs[-1].odometry), stamp))
        self._count_applied()
        return arrival

    def _count_applied(self) -> None:
        for applied in self.timeline.applied:
            self.tally.add(applied.report)

    def begin_anew(self) -> None:
        """Another drive: odometry begins anew, the map stays, and the robot may be anywhere in it."""
        self.timeline.restart()
        self.legs.append(Leg({}, {}))
        if self.timeline.slam.labels:
            self.timeline.lose()
        else:
            self.timeline.set_pose(self.params.first_pose, self.params.first_covariance)

    def map(self) -> "sextant.LandmarkMap":
        """As save_map of the nodelet writes it."""
        slam = self.timeline.slam
        known = slam.filter
        return sextant.LandmarkMap(
            self.frame, known.pose, known.landmarks, slam.labels, known.covariance, slam.is_lost
        )


def seconds_of(stamp: int) -> float:
    """Of nanoseconds; to the last bit what roscpp's toSec() says."""
    whole, rest = divmod(stamp, 10**9)
    return whole + 1e-9 * rest
