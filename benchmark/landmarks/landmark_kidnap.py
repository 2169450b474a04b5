# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Relocalization of a robot that is carried away while it maps, or in a known map that is only read.

World, sensor and parameters are those of landmarks_demo.launch. The robot is moved without odometry;
`relocalize` is called or not. It is relocalized when the estimated pose is within 3 sigma, including the
error of the map, and within NEAR of the truth, and the robot is neither lost nor outside of both for STAYS
after that. A wrong relocalization is an estimate outside of both after the robot was lost.
"""

from pathlib import Path
from typing import Iterator, List, NamedTuple, Optional
from xml.etree import ElementTree

import numpy as np
import yaml
from scipy.stats import chi2
from tables import Row, Table, Value

import sextant
from landmarks.landmark_drives import labelled, nees, pose_error
from sextant.geometry.plane_poses import composed
from sextant.simulation.landmark_world import LandmarkDrive, LandmarkWorld, LandmarkWorldParams

DEMO = Path(__file__).resolve().parents[2] / "launch" / "landmarks_demo.launch"
SET = ("landmarks", "classes", "half_side", "delay", "scale")  # by its arguments
SET += ("detection_probability", "false_alarm_probability")
RUNS, BEFORE, AFTER, STAYS = 30, 60.0, 120.0, 30.0  # seconds of the drive
THREE_SIGMA, NEAR = chi2.ppf(0.9973, 3), 0.3  # metres
ANNOUNCED, UNNOTICED, KNOWN = "relocalize called", "unnoticed", "unnoticed, in a known map"
FOUND = {ANNOUNCED: 95.0, UNNOTICED: 85.0, KNOWN: 95.0}  # minimum % of the drives
EXACT = 1e-6  # m^2 and rad^2: variance of a known map
COLUMNS = ["relocalized, %", "wrong", "after, s (median)", "after, s (longest)"]


class Outcome(NamedTuple):
    """Result of a drive."""

    found: Optional[float]  # seconds after it was carried away
    wrong: bool  # whether it was relocalized wrongly


class Check(NamedTuple):
    """Comparison of the estimate with the truth after a scan."""

    seconds: float  # after the robot was carried away
    lost: bool
    is_near: bool
    is_within: bool  # 3 sigma

    @property
    def is_right(self) -> bool:
        return not self.lost and self.is_near and self.is_within

    @property
    def is_wrong(self) -> bool:
        return not (self.lost or self.is_near or self.is_within)


def kidnap_tables(quick: bool) -> List[Table]:
    """One table; a quick run is of few drives, without bars."""
    runs = 2 if quick else RUNS
    rows = [_row(name, [outcome(checks(seed, name)) for seed in range(runs)], quick) for name in FOUND]
    return [Table(f"{runs} drives of the demo, carried away after {BEFORE:g} s", COLUMNS, rows)]


def demo_world(seed: int) -> LandmarkWorld:
    """World of the demo with its default arguments."""
    written = yaml.safe_load(next(ElementTree.parse(str(DEMO)).iter("rosparam")).text)
    values = {name: written[name] for name in SET if name in written}
    return LandmarkWorld(LandmarkWorldParams(seed=seed, **values))


def timeline_of(world: LandmarkWorld, is_known: bool = False):
    """sextant.LandmarkTimeline at the initial pose, as in the demo.

    :param is_known: with a map of all landmarks, which is only read
    """
    params = sextant.LandmarkSlamNodeParams()
    params.slam.sensor.field_of_view = world.params.field_of_view
    params.slam.read_only = is_known
    slam = sextant.LandmarkSlam(params.slam, world.start, params.first_covariance)
    if is_known:
        labels = [sextant.LandmarkLabel(name) for name in world.classes]
        landmarks = [sextant.Landmark2D(position) for position in world.positions]
        slam.set_map(world.start, landmarks, labels, EXACT * np.eye(3 + 2 * len(labels)))
    return sextant.LandmarkTimeline(params.timeline, slam)


def checks(seed: int, row: str) -> Iterator[Check]:
    """Checks after every scan for AFTER seconds after the robot was carried. :param row: a key of FOUND"""
    world = demo_world(seed)
    drive, timeline, T_odom_base = LandmarkDrive(world), timeline_of(world, row == KNOWN), np.zeros(3)
    timeline.odometry(0.0, T_odom_base)
    last = round(BEFORE * world.params.odometry_rate)
    for number in range(1, last + round(AFTER * world.params.odometry_rate)):
        step = drive.advance()
        T_odom_base = composed(T_odom_base, step.odometry_step)
        timeline.odometry(step.stamp, T_odom_base)
        if step.scan:
            timeline.observe(step.scan.stamp, labelled(step.scan.observations))
        if step.scan and number > last:
            yield _check(step.stamp - BEFORE, timeline, step.pose)
        if number == last:
            drive.kidnap()
            if row == ANNOUNCED:
                timeline.relocalize()


def _check(seconds: float, timeline, truth: np.ndarray) -> Check:
    now = timeline.now
    error = pose_error(truth, now.pose)
    is_within = nees(error, now.covariance) <= THREE_SIGMA
    return Check(seconds, timeline.is_lost, np.hypot(*error[:2]) <= NEAR, is_within)


def outcome(scans: Iterator[Check]) -> Outcome:
    """Ends the drive when the robot is relocalized."""
    found, was_lost, wrong = None, False, False
    for check in scans:
        was_lost |= check.lost
        wrong |= was_lost and check.is_wrong
        if check.lost or check.is_wrong:
            found = None
        elif found is None and check.is_right:
            found = check.seconds
        elif found is not None and check.seconds >= found + STAYS:
            break
    return Outcome(found, wrong)


def _row(name: str, outcomes: List[Outcome], quick: bool) -> Row:
    seconds = [each.found for each in outcomes if each.found is not None]
    wrong = sum(each.wrong for each in outcomes)
    return name, [
        Value(100 * len(seconds) / len(outcomes), 0, at_least=None if quick else FOUND[name]),
        Value(wrong, 0, at_most=None if quick or name != ANNOUNCED else 0),
        Value(np.median(seconds or [np.nan]), 1),
        Value(max(seconds, default=np.nan), 1),
    ]
