# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Landmark SLAM on recorded messages, with the same results as online."""

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Dict, List, NamedTuple, Optional, Sequence

import numpy as np

import sextant


@dataclass
class RecordedScan:
    """One scan of a sensor."""

    stamp: float  # seconds
    observations: Sequence["sextant.LabelledObservation"]  # in the robot frame
    T_base_sensor: np.ndarray  # (3,)
    has_markers: bool = False  # whether the sensor detects printed markers only
    keys: Sequence[Optional[int]] = ()  # of the landmarks of the observations, if they were associated


class DriveSegment(NamedTuple):
    """A drive without interruption: poses (3,) x, y, heading by stamp in nanoseconds."""

    odometry: Dict[int, np.ndarray]  # in the odometry frame
    robot: Dict[int, np.ndarray]  # in the map frame, while not lost
    scans: List[RecordedScan]  # in order of arrival


class LandmarkSightings(NamedTuple):
    """How one landmark was observed, n times."""

    stamps: np.ndarray  # (n,) seconds
    directions: np.ndarray  # (n,) of the robot from the landmark, radians in the map frame
    distances: np.ndarray  # (n,) Mahalanobis distances from the landmark, by the sensor's covariances
    detection: float  # share of the scans it was in view of that observed it


class LandmarkResult(NamedTuple):
    """Map and drives, online or by all observations."""

    map: "sextant.LandmarkMap"  # with the last pose of the robot
    observations: List[int]  # number of each landmark
    segments: List[DriveSegment]  # of all drives
    notes: List[str] = []  # how it was estimated
    sightings: List[LandmarkSightings] = []  # of each landmark; none online


@dataclass
class SlamTally:
    """Sums of the results of all scans, as in LandmarkReport."""

    associated: int = 0  # observations
    ambiguous: int = 0  # observations
    rejected: int = 0  # observations
    initialized: int = 0  # landmarks
    merged: int = 0  # landmarks
    removed: int = 0  # landmarks
    nis: float = 0.0  # sum
    nis_dof: int = 0  # sum of the degrees of freedom
    arrivals: Counter = field(default_factory=Counter)  # number of scans by sextant.Arrival
    early: int = 0  # scans too late because they are older than the first odometry
    observations: Counter = field(default_factory=Counter)  # number of observations by key of landmark
    distance: float = 0.0  # metres, by odometry
    duration: float = 0.0  # seconds, by odometry
    lost: float = 0.0  # seconds while lost

    def add(self, report: "sextant.LandmarkReport") -> None:
        """Adds the report of one scan."""
        for name in ("associated", "ambiguous", "rejected", "initialized", "merged", "removed", "nis_dof"):
            setattr(self, name, getattr(self, name) + getattr(report, name))
        self.nis += report.nis if report.nis_dof else 0.0
        self.observations.update(key for key in report.keys if key is not None)


class SlamRun:
    """Runs a LandmarkSession on recorded messages and collects its statistics."""

    def __init__(self, params: "sextant.LandmarkSlamNodeParams"):
        """Reads the maps of the parameters as the nodelet does.

        :raises ValueError: map_file and marker_map_file are both set, or one does not exist or is invalid
        """
        if params.map_file and params.marker_map_file:
            raise ValueError("a landmark map and a marker map are given: they may contain the same markers")
        if params.map_file and not Path(params.map_file).exists():
            raise ValueError(f"{params.map_file}: there is no such file")
        self.params, self.session = params, sextant.LandmarkSession(params)
        self.timeline = self.session.timeline
        self.first_map, self.first_keys = self.session.map, self.timeline.slam.keys
        self._waiting: List[RecordedScan] = []
        self.tally, self.segments = SlamTally(), [DriveSegment({}, {}, [])]

    def odometry(self, stamp: int, T_odom_base: np.ndarray) -> bool:
        """Adds an odometry pose (3,) x, y, heading, stamp in nanoseconds.

        :returns: False: ignored, it is not newer than the last one
        """
        jumps = self.timeline.jumps
        if not self.timeline.odometry(seconds_of(stamp), T_odom_base):
            return False
        if self.timeline.jumps > jumps:
            self.segments.append(DriveSegment({}, {}, []))
        self._count_applied()
        self._count(stamp, T_odom_base)
        now = None if self.timeline.is_lost else self.timeline.now
        if now:
            self.segments[-1].robot[stamp] = now.pose
        return True

    def _count(self, stamp: int, T_odom_base: np.ndarray) -> None:
        odometry = self.segments[-1].odometry
        if odometry:
            before, pose = next(reversed(odometry.items()))
            duration = 1e-9 * (stamp - before)
            self.tally.distance += float(np.hypot(*(T_odom_base - pose)[:2]))
            self.tally.duration += duration
            self.tally.lost += duration if self.timeline.is_lost else 0.0
        odometry[stamp] = np.asarray(T_odom_base)

    def observe(
        self,
        stamp: int,
        observations: Sequence["sextant.LabelledObservation"],
        T_base_sensor: np.ndarray,
        has_markers: bool = False,
    ) -> "sextant.Arrival":
        """Adds one scan of a sensor in the robot frame, stamp in nanoseconds.

        :param T_base_sensor: (3,) x, y, heading of the sensor and its viewing direction
        :param has_markers: whether it detects printed markers only
        """
        detects = sextant.Detects.WITH_ID if has_markers else sextant.Detects.ALL
        arrival = self.timeline.observe(seconds_of(stamp), list(observations), T_base_sensor, detects)
        self.tally.arrivals[arrival] += 1
        if arrival == sextant.Arrival.TOO_LATE:
            moment = seconds_of(stamp) + self.params.timeline.clock_offset
            self.tally.early += moment < seconds_of(next(iter(self.segments[-1].odometry), stamp))
        if arrival not in (sextant.Arrival.DUPLICATE, sextant.Arrival.TOO_LARGE):
            scan = RecordedScan(seconds_of(stamp), observations, np.asarray(T_base_sensor), has_markers)
            self.segments[-1].scans.append(scan)
            if arrival != sextant.Arrival.TOO_LATE:
                self._waiting.append(scan)
        self._count_applied()
        return arrival

    def _count_applied(self) -> None:
        for applied in self.timeline.applied:
            self.tally.add(applied.report)
            scan = next(each for each in self._waiting if each.stamp == applied.stamp)
            scan.keys = applied.report.keys
            self._waiting.remove(scan)

    def result(self) -> LandmarkResult:
        """As estimated online."""
        counts = [self.tally.observations[key] for key in self.timeline.slam.keys]
        return LandmarkResult(self.session.map, counts, self.segments)

    def start_drive(self) -> None:
        """Starts another drive: restarts odometry and keeps the map; the robot is lost."""
        self.session.restart()
        self.segments.append(DriveSegment({}, {}, []))


def seconds_of(stamp: int) -> float:
    """Seconds of nanoseconds, with the rounding of toSec() of roscpp."""
    whole, rest = divmod(stamp, 10**9)
    return whole + 1e-9 * rest
