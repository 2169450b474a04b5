# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a run of landmark SLAM came to, in words."""

from collections import defaultdict
from typing import Dict, List

import numpy as np

import sextant
from sextant.landmarks.slam_run import SlamRun

NIS_BAND = (0.7, 1.4)  # of its mean by degree of freedom, where the noise that was told may be right
FEWEST = 100  # degrees of freedom, below which the mean says nothing
LOST_SHARE = 0.2  # of the time; more is told


def summary(run: SlamRun) -> List[str]:
    """A line for the drive, for every class, and for what became of sightings."""
    tally = run.tally
    drives = sum(bool(leg.odometry) for leg in run.legs)
    drive = f"{tally.way:.1f} m in {tally.duration:.1f} s"
    drive += f", {drives} drives" if drives > 1 else ""
    drive += f", lost for {tally.lost:.1f} s" if tally.lost else ""
    lines = [drive, *_classes(run)]
    lines.append(
        f"sightings: {tally.known} of known landmarks, {tally.doubtful} in doubt, {tally.rejected} rejected"
    )
    lines.append(f"landmarks: {tally.begun} begun, {tally.merged} merged, {tally.removed} removed")
    if tally.nis_width:
        lines.append(f"NIS by degree of freedom: {tally.nis / tally.nis_width:.2f} (right is 1)")
    return lines


def _classes(run: SlamRun) -> List[str]:
    slam = run.timeline.slam
    covariance, at, of_class = slam.filter.covariance, 3, defaultdict(list)
    for landmark, label, key in zip(slam.filter.landmarks, slam.labels, slam.keys):
        block = covariance[at : at + 2, at : at + 2]
        at += 2 if landmark.heading is None else 3
        of_class[label.class_name].append((np.sqrt(np.linalg.eigvalsh(block)[-1]), run.tally.seen[key]))
    return [_class(name, rows) for name, rows in sorted(of_class.items())] or ["no landmark"]


def _class(name: str, rows: List) -> str:
    sigmas, seen = zip(*rows)
    many = f"{len(rows)} landmark" + ("s" if len(rows) > 1 else "")
    return f"{name}: {many}, seen {sum(seen)} times, deviation at most {max(sigmas):.3f} m"


def warnings(run: SlamRun) -> List[str]:
    """What its user should look at, and what to do about it."""
    leaps = run.timeline.leaps
    leapt = [f"odometry leapt {leaps} times: as if the robot had been put elsewhere"] if leaps else []
    return [*leapt, *_noise(run), *_arrivals(run), *_lost(run)]


def _noise(run: SlamRun) -> List[str]:
    """A NIS far from 1 says that the told noise is wrong; not whether of odometry or of the sensor."""
    tally = run.tally
    if tally.nis_width < FEWEST:
        return []
    nis = tally.nis / tally.nis_width
    if NIS_BAND[0] <= nis <= NIS_BAND[1]:
        return []
    size, direction = ("small", "raise") if nis > 1 else ("large", "lower")
    return [
        f"the NIS is {nis:.2f}: the noise that is told is too {size}. {direction.capitalize()} way_by_way, "
        f"turn_by_way and turn_by_turn (odometry), or what tells the sightings has to {direction} their "
        f"covariances; by a factor of about {np.sqrt(nis):.2g} in deviations, if it is all in one of them"
    ]


def _arrivals(run: SlamRun) -> List[str]:
    arrivals, lines = run.tally.arrivals, []
    early, late = run.tally.early, arrivals[sextant.Arrival.TOO_LATE] - run.tally.early
    told: Dict[str, int] = {
        "are of before the first odometry": early,
        f"came too late: raise lag ({run.params.timeline.lag:g} s)": late,
        "came twice, and were taken once": arrivals[sextant.Arrival.DUPLICATE],
    }
    for what, count in told.items():
        if count:
            lines.append(f"{count} of {sum(arrivals.values())} sets of sightings {what}")
    return lines


def _lost(run: SlamRun) -> List[str]:
    tally, lines = run.tally, []
    if tally.lost > LOST_SHARE * tally.duration:
        share = tally.lost / tally.duration
        lines.append(f"the robot was lost for {share:.0%} of the time: is it the map of this place?")
    if run.timeline.is_lost:
        lines.append("the robot is lost at the end: what it saw since then is not in the map")
    return lines
