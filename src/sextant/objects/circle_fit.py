# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Fit of a circle (a pillar on the floor) or a sphere (a ball) of known radius to its visible points.

The camera is the origin.
"""

from typing import List, NamedTuple, Optional

import numpy as np

SEARCH_RADIUS = 4.0  # radii around the initial centre within which points are used
ITERATIONS = 4  # of Gauss-Newton
MAX_ASIDE = 0.9  # radii from the line of sight; points farther aside hardly constrain the range
MAX_RESIDUALS = (0.6, 0.15)  # radii: inlier threshold in the first iteration and in the later ones
MAX_PLANE_SIGMAS = 5.0  # standard deviations between the fit and a tangent plane
GATE_SIGMAS = 3.0  # standard deviations, added to thresholds on depths
BESIDE = (0.3, 1.2)  # of the radius, offset a plane that touches it, where nothing of it is
MIN_POINTS_BESIDE, MIN_SHARE_BESIDE = 8, 0.2  # required in the strip: points, and fraction of the inliers
MAX_SHARE_BESIDE = 0.5  # fraction of the strip's points at the range of the object
CANDIDATES = 3  # ranges per object
MAX_CONDITION = 1e8  # condition number of the information matrix; above it a direction is unobservable


class TangentPlanes(NamedTuple):
    """m planes through the camera, tangent to the object."""

    normals: np.ndarray  # (m, k) unit, pointing to the object
    sigmas: np.ndarray  # (m,) standard deviations at the object, metres

    def agree(self, middle: np.ndarray, radius: float) -> bool:
        """Whether all planes touch a circle or sphere with this centre (k,)."""
        return bool(
            np.all(abs(self.normals @ middle - radius) < MAX_PLANE_SIGMAS * self.sigmas + 0.2 * radius)
        )


class CircleFit(NamedTuple):
    """The fitted centre."""

    position: np.ndarray  # (k,) metres
    covariance: np.ndarray  # (k, k)
    on: np.ndarray  # (n,) bool, inliers


def candidate_ranges(
    points: np.ndarray, sight: np.ndarray, radius: float, sigma: float, min_points: int
) -> List[float]:
    """Candidate distances (metres) of the centre along a line of sight (k,), the one with most points first.
    There may be several where something else is visible beside or in front of the object.

    :param points: (n, k) metres. :param sigma: standard deviation of a depth at 1 m, growing with its square
    :param min_points: that a candidate needs
    """
    along = points @ sight
    aside = np.linalg.norm(points - along[:, np.newaxis] * sight, axis=1)
    which = (aside < MAX_ASIDE * radius) & (along > 0.0)
    middles = np.sort(along[which] + np.sqrt(radius**2 - aside[which] ** 2))
    found: List[float] = []
    while len(found) < CANDIDATES and len(middles) >= min_points:
        ends = np.searchsorted(middles, middles + radius + 4.0 * sigma * middles**2, side="right")
        counts = ends - np.arange(len(middles))
        best = int(np.argmax(counts))
        if counts[best] < min_points:
            break
        found.append(float(np.median(middles[best : ends[best]])))
        middles = np.delete(middles, slice(best, ends[best]))
    return found


def fit_circle(
    points: np.ndarray,
    start: np.ndarray,
    radius: float,
    planes: TangentPlanes,
    sigma: float,
    correlated: float,
) -> Optional[CircleFit]:
    """Least squares of the depths along the rays and of the centre's distances to the tangent planes.

    :param start: (k,) initial centre. :param sigma: as candidate_ranges()
    :param correlated: number of neighbouring points with one common depth error
    :returns: None if no inliers are left, or the centre is unobservable
    """
    middle, far = start.astype(float), float(np.linalg.norm(start))
    away = np.linalg.norm(points - middle, axis=1)
    near = np.flatnonzero(away < SEARCH_RADIUS * radius + GATE_SIGMAS * sigma * far**2)
    points, on = points[near], np.zeros(len(points), bool)
    reach = np.linalg.norm(points, axis=1)
    rays = points / reach[:, np.newaxis]
    for i in range(ITERATIONS):
        along, noise = rays @ middle, sigma * (middle @ middle)
        square = radius**2 - (middle @ middle - along**2)  # of the half chord of each ray
        off = reach - (along - np.sqrt(np.maximum(square, 0.0)))
        gate = MAX_RESIDUALS[min(i, 1)] * radius + GATE_SIGMAS * noise
        which = (square > (1.0 - MAX_ASIDE**2) * radius**2) & (abs(off) < gate)
        count = int(which.sum())
        if not count:
            return None
        aside = middle - along[which, np.newaxis] * rays[which]
        rows = rays[which] + aside / np.sqrt(square[which, np.newaxis])
        weight, plane_weights = noise**-2 / min(max(correlated, 1.0), count), planes.sigmas**-2
        information = weight * rows.T @ rows + (planes.normals.T * plane_weights) @ planes.normals
        gradient = weight * rows.T @ off[which]
        gradient += (planes.normals.T * plane_weights) @ (radius - planes.normals @ middle)
        if np.linalg.cond(information) > MAX_CONDITION:
            return None
        middle = middle + np.linalg.solve(information, gradient)
    on[near] = which
    return CircleFit(middle, np.linalg.inv(information), on)


def extends_beyond(
    points: np.ndarray, fit: CircleFit, radius: float, planes: TangentPlanes, sigma: float
) -> bool:
    """Whether the surface continues outside a tangent plane: the points are of a wall."""
    far = float(np.linalg.norm(fit.position))
    is_there = abs(points @ (fit.position / far) - far) < radius + GATE_SIGMAS * sigma * far**2
    min_points = max(MIN_POINTS_BESIDE, MIN_SHARE_BESIDE * np.count_nonzero(fit.on))
    for offset in (planes.normals @ points.T) / -radius:
        strip = (offset > BESIDE[0]) & (offset < BESIDE[1])
        if strip.sum() >= min_points and is_there[strip].mean() > MAX_SHARE_BESIDE:
            return True
    return False
