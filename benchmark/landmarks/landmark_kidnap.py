# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot that is carried away while it maps, and has to find itself in its own map.

World, sensor and parameters are those of landmarks_demo.launch. Somebody puts the robot elsewhere, of which
its wheels know nothing, and says so (`relocalize`) or not. It is found when the pose that is told is within
3 sigma and NEAR of the truth, the map's own error included, and the robot is neither lost nor beyond both in
the STAYS after that. A wrong find is a pose beyond both that it tells after it was lost.
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
SET = ("landmarks", "classes", "half_side", "missed", "phantoms", "delay", "scale")  # by its arguments
RUNS, BEFORE, AFTER, STAYS = 30, 60.0, 120.0, 30.0  # seconds of the drive
THREE_SIGMA, NEAR = chi2.ppf(0.9973, 3), 0.3  # metres
FOUND = {"told": 95.0, "not told": 85.0}  # % of the drives, at least
COLUMNS = ["found, %", "wrong finds", "after, s (median)", "after, s (longest)"]


class Outcome(NamedTuple):
    """What became of a drive."""

    found: Optional[float]  # seconds after it was carried away
    wrong: bool  # a wrong find


class Told(NamedTuple):
    """What the filter says after a look."""

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
    rows = [
        _row(name, [outcome(told_after(seed, name == "told")) for seed in range(runs)], quick)
        for name in FOUND
    ]
    return [Table(f"{runs} drives of the demo, carried away after {BEFORE:g} s", COLUMNS, rows)]


def demo_world(seed: int) -> LandmarkWorld:
    """As the demo has it by default."""
    written = yaml.safe_load(next(ElementTree.parse(str(DEMO)).iter("rosparam")).text)
    values = {name: written[name] for name in SET if name in written}
    return LandmarkWorld(LandmarkWorldParams(seed=seed, **values))


def timeline_of(world: LandmarkWorld):
    """sextant.LandmarkTimeline at the start, as the demo begins it."""
    params = sextant.LandmarkSlamNodeParams()
    params.slam.sensor.field_of_view = world.params.field_of_view
    slam = sextant.LandmarkSlam(params.slam, world.start, params.first_covariance)
    return sextant.LandmarkTimeline(params.timeline, slam)


def told_after(seed: int, is_told: bool) -> Iterator[Told]:
    """After every look of AFTER seconds from where it was carried to."""
    world = demo_world(seed)
    drive, timeline, T_odom_base = LandmarkDrive(world), timeline_of(world), np.zeros(3)
    timeline.odometry(0.0, T_odom_base)
    last = round(BEFORE * world.params.odometry_rate)
    for number in range(1, last + round(AFTER * world.params.odometry_rate)):
        moment = drive.advance()
        T_odom_base = composed(T_odom_base, moment.step)
        timeline.odometry(moment.stamp, T_odom_base)
        if moment.look:
            timeline.see(moment.look.stamp, labelled(moment.look.sightings))
        if moment.look and number > last:
            yield _told(moment.stamp - BEFORE, timeline, moment.pose)
        if number == last:
            drive.carry()
            if is_told:
                timeline.lose()


def _told(seconds: float, timeline, truth: np.ndarray) -> Told:
    now = timeline.now
    error = pose_error(truth, now.pose)
    is_within = nees(error, now.covariance) <= THREE_SIGMA
    return Told(seconds, timeline.is_lost, np.hypot(*error[:2]) <= NEAR, is_within)


def outcome(looks: Iterator[Told]) -> Outcome:
    """The drive ends when the robot is found."""
    found, was_lost, wrong = None, False, False
    for told in looks:
        was_lost |= told.lost
        wrong |= was_lost and told.is_wrong
        if told.lost or told.is_wrong:
            found = None
        elif found is None and told.is_right:
            found = told.seconds
        elif found is not None and told.seconds >= found + STAYS:
            break
    return Outcome(found, wrong)


def _row(name: str, outcomes: List[Outcome], quick: bool) -> Row:
    seconds = [each.found for each in outcomes if each.found is not None]
    wrong = sum(each.wrong for each in outcomes)
    return name, [
        Value(100 * len(seconds) / len(outcomes), 0, at_least=None if quick else FOUND[name]),
        Value(wrong, 0, at_most=None if quick or name != "told" else 0),
        Value(np.median(seconds or [np.nan]), 1),
        Value(max(seconds, default=np.nan), 1),
    ]
