# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Triangulates points from their observations in photos with known poses.

Observations are normalized image coordinates: (x / z, y / z) of the ray in the camera's optical frame, and
the depth z where a depth camera measured it.
"""

import math
from typing import NamedTuple, Tuple

import numpy as np

ITERATIONS = 8  # of Gauss-Newton; it converges quadratically
MAX_ERROR = 3.0  # standard deviations of an observation, above which it is no observation of the point
MIN_PARALLAX = np.deg2rad(1.5)  # largest angle between two rays of a point, below which it is left out
# Standard deviation of a depth: at 1 m, growing with its square, and by the scale of the depth camera
DEPTH_SIGMA, DEPTH_SCALE_SIGMA = 0.004, 0.01
MAX_DEPTH_ERROR = 0.3  # standard deviation of a point by its distance: beyond, the linear covariance is wrong


class Observations(NamedTuple):
    """Observations of points, in any order."""

    point: np.ndarray  # int (n,) index of the point
    photo: np.ndarray  # int (n,) index of the photo's pose
    xy: np.ndarray  # (n, 2) normalized image coordinates
    sigma: np.ndarray  # (n,) standard deviation of each coordinate
    depth: np.ndarray  # (n,) along the optical axis, metres; NaN: unknown


class Points(NamedTuple):
    """Triangulated points."""

    xyz: np.ndarray  # (m, 3) metres, in the frame of the poses
    covariances: np.ndarray  # (m, 3, 3) m^2
    valid: np.ndarray  # bool (m,); the other points have no meaning
    used: np.ndarray  # bool (n,) observations that fit a valid point
    errors: np.ndarray  # (n, 2) reprojection errors by their standard deviations; NaN where not used


def triangulated(poses: np.ndarray, count: int, seen: Observations) -> Points:
    """Least-squares points with covariances; observations that do not fit are left out, the worst first.

    :param poses: T_map_camera (photos, 4, 4)
    :param count: number of points
    """
    used, todo = np.ones(len(seen.point), bool), np.arange(count)
    xyz, information = _midpoints(poses, count, seen), np.zeros((count, 3, 3))
    while len(todo):
        rows = np.flatnonzero(np.isin(seen.point, todo))
        part = Observations(np.searchsorted(todo, seen.point[rows]), *(each[rows] for each in seen[1:]))
        xyz[todo], information[todo] = _refined(poses, xyz[todo], part, used[rows])
        out = rows[_worst(poses, xyz[todo], part, used[rows])]
        used[out] = False
        todo = np.unique(seen.point[out])
    covariances = np.linalg.inv(information)
    valid = _valid(poses, xyz, covariances, seen, used)
    used &= valid[seen.point]
    errors = _errors(poses, xyz, seen)[0][:, :2]
    errors[~used] = np.nan
    return Points(xyz, covariances, valid, used, errors)


def _midpoints(poses: np.ndarray, count: int, seen: Observations) -> np.ndarray:
    """Points (m, 3) with the least sum of squared distances from their rays, and from those with a depth."""
    ray = _rays(poses, seen)
    length = seen.depth * np.sqrt(1 + (seen.xy**2).sum(axis=1))
    known = np.isfinite(length)
    along = ray[:, :, None] * ray[:, None, :]
    across = np.eye(3) - np.where(known[:, None, None], 0.0, along)
    nearest = poses[seen.photo, :3, 3] + np.where(known, length, 0.0)[:, None] * ray
    matrix = _summed(seen.point, across, count)
    right = _summed(seen.point, np.einsum("nij,nj->ni", across, nearest), count)
    return np.linalg.solve(matrix + 1e-9 * np.eye(3), right[..., None])[..., 0]


def _rays(poses: np.ndarray, seen: Observations) -> np.ndarray:
    """Unit vectors (n, 3) along the rays in the map."""
    ray = np.c_[seen.xy, np.ones(len(seen.xy))]
    ray /= np.linalg.norm(ray, axis=1, keepdims=True)
    return np.einsum("nij,nj->ni", poses[seen.photo, :3, :3], ray)


def _summed(group: np.ndarray, values: np.ndarray, count: int) -> np.ndarray:
    """Sums (count, ...) of the values (n, ...) of each group."""
    flat = values.reshape(len(values), math.prod(values.shape[1:]))
    sums = np.stack([np.bincount(group, column, count) for column in flat.T], axis=1)
    return sums.reshape(count, *values.shape[1:])


def _errors(poses: np.ndarray, xyz: np.ndarray, seen: Observations) -> Tuple[np.ndarray, np.ndarray]:
    """Errors (n, 3) of the observations by their standard deviations, that of an unknown depth is 0, and
    their Jacobians (n, 3, 3) by the point, with the opposite sign."""
    R = poses[seen.photo, :3, :3]
    p = np.einsum("nji,nj->ni", R, xyz[seen.point] - poses[seen.photo, :3, 3])
    z = np.where(np.abs(p[:, 2]) < 1e-6, 1e-6, p[:, 2])
    xy = p[:, :2] / z[:, None]
    weight = np.stack([1 / seen.sigma, 1 / seen.sigma, _depth_weights(seen.depth)], axis=1)
    by_p = np.zeros((len(p), 3, 3))
    by_p[:, 0, 0] = by_p[:, 1, 1] = 1 / z
    by_p[:, :2, 2] = -xy / z[:, None]
    by_p[:, 2, 2] = 1
    errors = np.c_[seen.xy - xy, np.nan_to_num(seen.depth) - z]
    return weight * errors, np.einsum("nij,nkj->nik", weight[:, :, None] * by_p, R)


def _depth_weights(depth: np.ndarray) -> np.ndarray:
    """Inverse standard deviations (n,) of depths; 0: unknown."""
    known = np.isfinite(depth)
    z = np.where(known, depth, 1.0)
    return np.where(known, 1 / np.hypot(DEPTH_SCALE_SIGMA * z, DEPTH_SIGMA * z**2), 0.0)


def _refined(poses: np.ndarray, xyz: np.ndarray, seen: Observations, used: np.ndarray):
    """Gauss-Newton over all points at once; points and their information matrices (m, 3, 3)."""
    for _ in range(ITERATIONS):
        errors, J = _errors(poses, xyz, seen)
        information = _summed(seen.point, used[:, None, None] * np.einsum("nij,nik->njk", J, J), len(xyz))
        gradient = _summed(seen.point, used[:, None] * np.einsum("nij,ni->nj", J, errors), len(xyz))
        scale = np.trace(information, axis1=1, axis2=2)[:, None, None]
        information = information + (1e-9 * scale + 1e-9) * np.eye(3)  # a point with one ray is singular
        xyz = xyz + np.linalg.solve(information, gradient[..., None])[..., 0]
    return xyz, information


def _worst(poses: np.ndarray, xyz: np.ndarray, seen: Observations, used: np.ndarray) -> np.ndarray:
    """Which of the observations (n,) has the largest error of its point, if that exceeds MAX_ERROR."""
    errors = _errors(poses, xyz, seen)[0]
    distance = np.maximum(np.linalg.norm(errors[:, :2], axis=1), np.abs(errors[:, 2]))
    distance = np.where(used, np.nan_to_num(distance, nan=np.inf), 0.0)
    worst = np.zeros(len(xyz))
    np.maximum.at(worst, seen.point, distance)
    return (distance > MAX_ERROR) & (distance >= worst[seen.point])


def _valid(
    poses: np.ndarray, xyz: np.ndarray, covariances: np.ndarray, seen: Observations, used: np.ndarray
) -> np.ndarray:
    """Points (m,) with parallax or depth, in front of all their cameras, with a small enough covariance."""
    count = len(xyz)
    views = np.bincount(seen.point[used], minlength=count)
    measured = np.bincount(seen.point, used & np.isfinite(seen.depth), count) > 0
    offset = xyz[seen.point] - poses[seen.photo, :3, 3]
    distance = np.linalg.norm(offset, axis=1)
    depth = np.einsum("ni,ni->n", poses[seen.photo, :3, 2], offset)
    behind = np.bincount(seen.point, used & ~(depth > 0.1), count) > 0
    nearest = np.full(count, np.inf)
    np.minimum.at(nearest, seen.point[used], distance[used])
    spread = np.sqrt(np.linalg.eigvalsh(covariances)[:, 2])
    wide = _parallax(offset / distance[:, None], seen.point, used, count) >= MIN_PARALLAX
    return ((views >= 2) & wide | measured) & ~behind & (spread < MAX_DEPTH_ERROR * nearest)


def _parallax(ray: np.ndarray, point: np.ndarray, used: np.ndarray, count: int) -> np.ndarray:
    """Angle (m,) between the first ray of a point and that farthest from it."""
    rows = np.flatnonzero(used)
    first = np.zeros(count, int)
    first[point[rows[::-1]]] = rows[::-1]
    angle = np.arccos(np.clip(np.einsum("ni,ni->n", ray, ray[first[point]]), -1, 1))
    widest = np.zeros(count)
    np.maximum.at(widest, point[rows], angle[rows])
    return widest
