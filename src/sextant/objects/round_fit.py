# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Circles and spheres of a known radius through points of the side that is seen.

In the plane a circle is a pillar, in space a sphere is a ball; the camera is the origin.
"""

from typing import List, NamedTuple, Optional

import numpy as np

NEAR = 4.0  # of the radius, from where it is looked for: what is farther is not of it
ROUNDS = 4  # of Gauss and Newton
INNER = 0.9  # of the radius: points farther from the sight line tell little of the range
WIDE = (0.6, 0.15)  # of the radius, that a point may be off in the first round and in those after it
DISAGREE = 5.0  # deviations
SURE = 3.0  # and, beside, deviations
BESIDE = (0.3, 1.2)  # of the radius, beyond a plane that touches it, where nothing of it is
FEWEST_BESIDE, SHARE_BESIDE = 8, 0.2  # points there, and of those on it, to say anything
MOST_BESIDE = 0.5  # share of them as far away as it
CANDIDATES = 3  # ranges of an object
OPEN = 1e8  # condition of the information, from which it says nothing about some direction


class Planes(NamedTuple):
    """m planes through the camera that touch it."""

    normals: np.ndarray  # (m, k) unit, toward it
    sigmas: np.ndarray  # (m,) deviations there, metres

    def agree(self, middle: np.ndarray, radius: float) -> bool:
        """Whether they touch what has its middle (k,) there."""
        return bool(np.all(abs(self.normals @ middle - radius) < DISAGREE * self.sigmas + 0.2 * radius))


class RoundFit(NamedTuple):
    """The middle."""

    position: np.ndarray  # (k,) metres
    covariance: np.ndarray  # (k, k)
    on: np.ndarray  # (n,) which points are on it


def likely_ranges(
    points: np.ndarray, sight: np.ndarray, radius: float, sigma: float, fewest: int
) -> List[float]:
    """Distances of the middle (metres) along a sight line (k,): where most points would have it, then where
    fewer would, for something else may be seen beside it or before it.

    :param points: (n, k). :param sigma: deviation of a depth at 1 m, growing with its square
    """
    along = points @ sight
    aside = np.linalg.norm(points - along[:, np.newaxis] * sight, axis=1)
    which = (aside < INNER * radius) & (along > 0.0)
    middles = np.sort(along[which] + np.sqrt(radius**2 - aside[which] ** 2))
    found: List[float] = []
    while len(found) < CANDIDATES and len(middles) >= fewest:
        ends = np.searchsorted(middles, middles + radius + 4.0 * sigma * middles**2, side="right")
        counts = ends - np.arange(len(middles))
        best = int(np.argmax(counts))
        if counts[best] < fewest:
            break
        found.append(float(np.median(middles[best : ends[best]])))
        middles = np.delete(middles, slice(best, ends[best]))
    return found


def fit_round(
    points: np.ndarray, start: np.ndarray, radius: float, planes: Planes, sigma: float, alike: float
) -> Optional[RoundFit]:
    """Least squares of the depths along the points' rays, and of the middle's distances to the planes.

    :param start: (k,) about the middle. :param sigma: as likely_ranges()
    :param alike: points with one common error: lumps of noise
    :returns: None where no points are left that fit, or they leave it open where it is
    """
    middle, far = start.astype(float), float(np.linalg.norm(start))
    away = np.linalg.norm(points - middle, axis=1)
    near = np.flatnonzero(away < NEAR * radius + SURE * sigma * far**2)
    points, on = points[near], np.zeros(len(points), bool)
    reach = np.linalg.norm(points, axis=1)
    rays = points / reach[:, np.newaxis]
    for i in range(ROUNDS):
        along, noise = rays @ middle, sigma * (middle @ middle)
        square = radius**2 - (middle @ middle - along**2)  # of the half chord that a ray has in it
        off = reach - (along - np.sqrt(np.maximum(square, 0.0)))
        which = (square > (1.0 - INNER**2) * radius**2) & (abs(off) < WIDE[min(i, 1)] * radius + SURE * noise)
        count = int(which.sum())
        if not count:
            return None
        aside = middle - along[which, np.newaxis] * rays[which]
        rows = rays[which] + aside / np.sqrt(square[which, np.newaxis])
        weight, plane_weights = noise**-2 / min(max(alike, 1.0), count), planes.sigmas**-2
        information = weight * rows.T @ rows + (planes.normals.T * plane_weights) @ planes.normals
        pull = weight * rows.T @ off[which]
        pull += (planes.normals.T * plane_weights) @ (radius - planes.normals @ middle)
        if np.linalg.cond(information) > OPEN:
            return None
        middle = middle + np.linalg.solve(information, pull)
    on[near] = which
    return RoundFit(middle, np.linalg.inv(information), on)


def goes_on(points: np.ndarray, fit: RoundFit, radius: float, planes: Planes, sigma: float) -> bool:
    """Whether what was fitted goes on beyond a plane that should touch it: it is of a wall."""
    far = float(np.linalg.norm(fit.position))
    is_there = abs(points @ (fit.position / far) - far) < radius + SURE * sigma * far**2
    fewest = max(FEWEST_BESIDE, SHARE_BESIDE * np.count_nonzero(fit.on))
    for beyond in (planes.normals @ points.T) / -radius:
        strip = (beyond > BESIDE[0]) & (beyond < BESIDE[1])
        if strip.sum() >= fewest and is_there[strip].mean() > MOST_BESIDE:
            return True
    return False
