# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Summary of a run of landmark SLAM as text."""

from collections import defaultdict
from typing import Dict, List

import numpy as np

import sextant
from sextant.landmarks.slam_run import LandmarkResult, SlamRun

NIS_BAND = (0.7, 1.4)  # of the mean NIS per degree of freedom, within which the noise may be correct
MIN_NIS_DOF = 100  # degrees of freedom, below which the mean NIS is not significant
MAX_LOST_SHARE = 0.2  # of the time, above which there is a warning


def summary(run: SlamRun, result: LandmarkResult) -> List[str]:
    """Lines on the drive, each class of landmarks, the observations and the changes of the map."""
    tally = run.tally
    drives = sum(bool(segment.odometry) for segment in run.segments)
    drive = f"{tally.distance:.1f} m in {tally.duration:.1f} s"
    drive += f", {drives} drives" if drives > 1 else ""
    drive += f", lost for {tally.lost:.1f} s" if tally.lost else ""
    lines = [drive, *_classes(result), *result.notes]
    lines.append(
        f"observations: {tally.associated} associated, {tally.ambiguous} ambiguous, {tally.rejected} rejected"
    )
    changes = f"{tally.initialized} initialized, {tally.merged} merged, {tally.removed} removed"
    lines.append("landmarks: " + changes)
    if tally.nis_dof:
        lines.append(f"NIS per degree of freedom: {tally.nis / tally.nis_dof:.2f} (expected: 1)")
    return lines


def _classes(result: LandmarkResult) -> List[str]:
    of_class = defaultdict(list)
    for label, *row in zip(result.map.labels, position_sigmas(result.map), result.observations):
        of_class[label.class_name].append(row)
    return [_class(name, rows) for name, rows in sorted(of_class.items())] or ["no landmark"]


def position_sigmas(landmark_map: "sextant.LandmarkMap") -> np.ndarray:
    """Standard deviations (n,) of the positions of all landmarks, metres, each along its worst axis."""
    sigmas, at = [], 3  # row of the covariance; the first three are the robot's
    for landmark in landmark_map.landmarks:
        block = landmark_map.covariance[at : at + 2, at : at + 2]
        sigmas.append(np.sqrt(np.linalg.eigvalsh(block)[-1]))
        at += 2 if landmark.heading is None else 3
    return np.array(sigmas)


def _class(name: str, rows: List) -> str:
    sigmas, counts = zip(*rows)
    many = f"{len(rows)} landmark" + ("s" if len(rows) > 1 else "")
    return f"{name}: {many}, {sum(counts)} observations, standard deviation up to {max(sigmas):.3f} m"


def warnings(run: SlamRun) -> List[str]:
    """Problems of the run, each with what to do about it."""
    jumps = run.timeline.jumps
    jumped = [f"odometry jumped {jumps} times: the robot was lost after each"] if jumps else []
    return [*jumped, *_noise(run), *_arrivals(run), *_lost(run)]


def _noise(run: SlamRun) -> List[str]:
    """A NIS far from 1 shows that the noise is wrong, but not whether that of odometry or of the sensor."""
    tally = run.tally
    if tally.nis_dof < MIN_NIS_DOF:
        return []
    nis = tally.nis / tally.nis_dof
    if NIS_BAND[0] <= nis <= NIS_BAND[1]:
        return []
    size, direction = ("small", "raise") if nis > 1 else ("large", "lower")
    return [
        f"the NIS is {nis:.2f}: the noise that is set is too {size}. {direction.capitalize()} "
        "translation_from_translation, rotation_from_translation and rotation_from_rotation (odometry), "
        f"or the covariances of the observations; by a factor of about {np.sqrt(nis):.2g} in standard "
        "deviations, if all of it is in one of them"
    ]


def _arrivals(run: SlamRun) -> List[str]:
    arrivals = run.tally.arrivals
    early, late = run.tally.early, arrivals[sextant.Arrival.TOO_LATE] - run.tally.early
    counts: Dict[str, int] = {
        "are older than the first odometry": early,
        f"are too late: raise lag ({run.params.timeline.lag:g} s)": late,
        "are duplicates, and were applied once": arrivals[sextant.Arrival.DUPLICATE],
        f"are too large: raise max_observations ({run.params.timeline.max_observations})": arrivals[
            sextant.Arrival.TOO_LARGE
        ],
    }
    total = sum(arrivals.values())
    return [f"{count} of {total} scans {what}" for what, count in counts.items() if count]


def _lost(run: SlamRun) -> List[str]:
    tally, lines = run.tally, []
    if tally.lost > MAX_LOST_SHARE * tally.duration:
        share = tally.lost / tally.duration
        lines.append(f"the robot was lost for {share:.0%} of the time: is this the map of this place?")
    if run.timeline.is_lost:
        lines.append("the robot is lost at the end: the observations since then are not in the map")
    return lines
