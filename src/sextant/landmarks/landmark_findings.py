# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Findings about a new landmark map and what to do about them, as sentences."""

from typing import Callable, Iterator, List, Sequence

import numpy as np

from sextant.base.findings import Finding, count_text, verdict_text
from sextant.landmarks.slam_run import LandmarkResult, LandmarkSightings
from sextant.landmarks.slam_summary import position_sigmas

CLOSE = 0.5  # metres between two landmarks of one class that a robot easily confuses
SCATTER = 1.5  # times the stated standard deviations, above which the observations of a landmark do not fit
# Standard deviation along the worst axis, metres, and over the median of all: far from the start of a drive,
# landmarks are less certain.
UNCERTAIN, LESS_CERTAIN = 0.1, 2.0
SELDOM = 0.2  # share of the scans with a landmark in view
ONE_SIDE = np.radians(30)  # range of the directions from which a landmark was observed
USED = 0.9  # share of the observations by which their scatter is computed: those that fit best
RMS_OF_USED = 0.8625  # over that of all, if they are normally distributed in two dimensions
BRIEF, LONG = 10.0, 60.0  # seconds between first and last observation, and of all drives


def list_findings(result: LandmarkResult) -> List[Finding]:
    """Returns the findings, the most severe kind first; the key of a landmark is its index.

    :param result: of batch_map()
    """
    return [finding for kind in _KINDS for finding in kind(result)]


def verdict(result: LandmarkResult) -> str:
    """Summarizes the map in one line."""
    named = {key for finding in list_findings(result) for key in finding.keys}
    return verdict_text(f"{count_text(len(result.map.landmarks), 'landmark')} mapped", len(named), "landmark")


def landmark_name(result: LandmarkResult, index: int) -> str:
    """Class and id, or class and position: landmarks without an id have no other name."""
    label, (x, y) = result.map.labels[index], result.map.landmarks[index].position
    return f"{label.class_name} {f'at ({x:.2f}, {y:.2f})' if label.id is None else label.id}"


def scatter(sightings: LandmarkSightings) -> float:
    """Residuals of the observations over their stated standard deviations, RMS by axis; NaN without any.

    The worst tenth is left out: gross errors of single observations are no property of a landmark.
    """
    if not len(sightings.distances):
        return float("nan")
    least = np.sort(sightings.distances**2)[: max(1, int(USED * len(sightings.distances)))]
    return float(np.sqrt(least.mean() / 2) / RMS_OF_USED)


def spread(directions: np.ndarray) -> float:
    """The smallest angle that contains all directions (n,), radians."""
    if len(directions) < 2:
        return 0.0
    ordered = np.sort(np.mod(directions, 2 * np.pi))
    return float(2 * np.pi - np.diff(ordered, append=ordered[0] + 2 * np.pi).max())


def _close(result: LandmarkResult) -> Iterator[Finding]:
    """Two landmarks of one class that may be one, or that are easily confused."""
    positions = np.array([each.position for each in result.map.landmarks]).reshape(-1, 2)
    labels = result.map.labels
    for i in range(len(labels)):
        for j in range(i + 1, len(labels)):
            apart = float(np.hypot(*(positions[i] - positions[j])))
            if labels[i].id is None and labels[i] == labels[j] and apart < CLOSE:
                yield Finding(
                    (i, j),
                    "close to another one",
                    f"{landmark_name(result, i)} and {landmark_name(result, j)} are only {apart:.2f} m apart",
                    "check that both exist; if not, remove one from the file",
                )


def _scattered(result: LandmarkResult) -> Iterator[Finding]:
    for index, sightings in enumerate(result.sightings):
        times = scatter(sightings)
        if times > SCATTER:
            yield Finding(
                (index,),
                "does not fit",
                f"the observations of {landmark_name(result, index)} scatter {times:.1f} times as much as "
                "their covariances state",
                "check whether it was moved during the drive, or whether there are two of them side by side",
            )


def _brief(result: LandmarkResult) -> Iterator[Finding]:
    moments = np.concatenate([[], *(each.stamps for each in result.sightings)])
    if not len(moments) or np.ptp(moments) < LONG:
        return
    for index, sightings in enumerate(result.sightings):
        if len(sightings.stamps) and np.ptp(sightings.stamps) < BRIEF:
            yield Finding(
                (index,),
                "seen only once",
                f"{landmark_name(result, index)} was observed within {np.ptp(sightings.stamps):.1f} s only",
                "drive past it again: something that stood there for a moment is no landmark",
            )


def _seldom(result: LandmarkResult) -> Iterator[Finding]:
    for index, sightings in enumerate(result.sightings):
        if len(sightings.stamps) and sightings.detection < SELDOM:
            yield Finding(
                (index,),
                "seldom detected",
                f"{landmark_name(result, index)} was detected in {sightings.detection:.0%} of the scans in "
                "which it was in view",
                "check that it exists: it may be false detections at one place, or have been moved",
            )


def _one_sided(result: LandmarkResult) -> Iterator[Finding]:
    """Landmarks with a heading have a front: a marker on a wall is seen from one side only."""
    for index, (sightings, landmark) in enumerate(zip(result.sightings, result.map.landmarks)):
        angle = spread(sightings.directions)
        if len(sightings.stamps) and angle < ONE_SIDE and landmark.heading is None:
            yield Finding(
                (index,),
                "seen from one side",
                f"{landmark_name(result, index)} was observed within {np.degrees(angle):.0f} degrees only",
                "drive past it on another side",
            )


def _uncertain(result: LandmarkResult) -> Iterator[Finding]:
    sigmas = position_sigmas(result.map)
    for index, sigma in enumerate(sigmas):
        if sigma > max(UNCERTAIN, LESS_CERTAIN * np.median(sigmas)):
            yield Finding(
                (index,),
                "uncertain",
                f"{landmark_name(result, index)} is uncertain ({sigma:.2f} m, standard deviation)",
                "drive past it closer and longer",
            )


def _unseen(result: LandmarkResult) -> Iterator[Finding]:
    for index, sightings in enumerate(result.sightings):
        if not len(sightings.stamps):
            yield Finding(
                (index,),
                "never seen",
                f"{landmark_name(result, index)} of the initial map was never observed",
                "drive past it, or remove it from the file if it does not exist any more",
            )


_KINDS: Sequence[Callable[[LandmarkResult], Iterator[Finding]]] = (
    _scattered,
    _close,
    _seldom,
    _brief,
    _unseen,
    _uncertain,
    _one_sided,
)
