# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Recorded drives as poses at the stamps of the scans, and odometry between them."""

from typing import Dict, List, NamedTuple, Optional, Tuple

import numpy as np

import sextant
from sextant.geometry.plane_poses import composed, relative
from sextant.landmarks.slam_run import DriveSegment, RecordedScan, SlamRun, seconds_of

NOTICED = 15.0  # seconds within which the filter notices that the robot was carried away


class BatchDrives(NamedTuple):
    """What was recorded, by poses at the stamps of the scans."""

    stamps: np.ndarray  # (n,) seconds, by the clock of odometry
    segments: np.ndarray  # (n,) index of the segment
    begin: np.ndarray  # (n, 3) by the filter
    steps: List[Tuple[int, "sextant.OdometryStep", bool]]  # by the pose before; whether the robot may slip
    scans: List[Tuple[int, RecordedScan]]  # by the pose


def recorded_drives(run: SlamRun) -> BatchDrives:
    """:raises RuntimeError: the robot was lost all the time"""
    all_parts = (_of_segment(run, *each) for each in enumerate(run.segments))
    parts = [part for part in all_parts if part]
    if not parts:
        raise RuntimeError("the robot was lost all the time")
    drives = parts[0]
    for part in parts[1:]:
        drives = _joined(drives, part)
    return drives


def _joined(first: BatchDrives, then: BatchDrives) -> BatchDrives:
    offset = len(first.stamps)
    return BatchDrives(
        *(np.concatenate(pair) for pair in list(zip(first, then))[:3]),
        first.steps + [(pose + offset, *step) for pose, *step in then.steps],
        first.scans + [(pose + offset, scan) for pose, scan in then.scans],
    )


def _of_segment(run: SlamRun, index: int, segment: DriveSegment) -> Optional[BatchDrives]:
    """Nothing if the robot was lost all the time, or there is no motion: a single reading of odometry."""
    if not segment.robot or len(segment.odometry) < 2:
        return None
    history = sextant.OdometryHistory(run.params.timeline.odometry, np.inf)
    for stamp, pose in segment.odometry.items():
        history.add(seconds_of(stamp), pose)
    first, last = (seconds_of(stamp) for stamp in (min(segment.odometry), max(segment.odometry)))
    offset = run.params.timeline.clock_offset + run.timeline.slam.filter.clock_offset
    in_order = sorted(segment.scans, key=lambda scan: scan.stamp)
    scans = [(scan.stamp + offset, scan) for scan in in_order if first <= scan.stamp + offset <= last]
    stamps = np.unique([first, last, *(stamp for stamp, _ in scans)])
    may_slip = _was_carried(segment, stamps[1:])
    steps = [(k, history.between(*pair), bool(may_slip[k])) for k, pair in enumerate(zip(stamps, stamps[1:]))]
    return BatchDrives(
        stamps,
        np.full(len(stamps), index),
        _by_filter(segment, history, stamps),
        steps,
        [(int(np.searchsorted(stamps, stamp)), scan) for stamp, scan in scans],
    )


def _was_carried(segment: DriveSegment, stamps: np.ndarray) -> np.ndarray:
    """Whether the robot was lost at each of the stamps (n,), seconds, or became so soon after."""
    carried = np.zeros(len(stamps), dtype=bool)
    lost = [seconds_of(stamp) for stamp in segment.odometry if stamp not in segment.robot]
    for moment in lost:
        carried |= (stamps >= moment - NOTICED) & (stamps <= moment + NOTICED)
    return carried


def _by_filter(segment: DriveSegment, history, stamps: np.ndarray) -> np.ndarray:
    """Poses (n, 3) at other stamps, by the next one of the filter, or the last."""
    known = np.array([seconds_of(stamp) for stamp in segment.robot])
    poses = list(segment.robot.values())
    nearest = np.minimum(np.searchsorted(known, stamps), len(known) - 1)
    return np.array(
        [
            composed(poses[index], relative(history.at(known[index]), history.at(stamp)))
            for index, stamp in zip(nearest, stamps)
        ]
    )


def at_odometry(segment: DriveSegment, stamps: np.ndarray, poses: np.ndarray) -> Dict[int, np.ndarray]:
    """Poses by stamp in nanoseconds, by odometry between poses (n, 3) at stamps (n,), which it joins."""
    history = sextant.OdometryHistory(sextant.OdometryNoiseParams(), np.inf)
    for stamp, pose in segment.odometry.items():
        history.add(seconds_of(stamp), pose)
    at = np.array([history.at(stamp) for stamp in stamps])
    off = [
        relative(composed(pose, relative(*pair)), after)
        for pose, after, pair in zip(poses, poses[1:], zip(at, at[1:]))
    ]
    robot = {}
    for stamp, pose in segment.odometry.items():
        before = min(max(0, int(np.searchsorted(stamps, seconds_of(stamp), "right")) - 1), len(stamps) - 2)
        share = (seconds_of(stamp) - stamps[before]) / (stamps[before + 1] - stamps[before])
        robot[stamp] = composed(composed(poses[before], relative(at[before], pose)), share * off[before])
    return robot
