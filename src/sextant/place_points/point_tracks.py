# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tracks of keypoints through photos with known poses: guided matching of neighbouring photos."""

from typing import List, Sequence, Tuple

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from sextant.place_points.point_keypoints import PointKeypoints
from sextant.place_points.point_triangulation import Observations

NEIGHBOURS = 6  # photos that each photo is matched with
MIN_COMMON_VIEW = np.cos(np.pi / 4)  # cosine of the largest angle between the directions of neighbours
BAND = 4.0  # standard deviations of a keypoint from the epipolar line of its match
MAX_SIZE_RATIO = 3.0  # of two matching keypoints
MAX_RATIO = 0.85  # of the distances of the best and the second descriptor (Lowe 2004)


def neighbours(poses: np.ndarray, photo: int, count: int) -> np.ndarray:
    """The nearest photos that look in a similar direction, nearest first, without the photo itself.

    :param poses: T_map_camera (n, 4, 4)
    """
    distance = np.linalg.norm(poses[:, :3, 3] - poses[photo, :3, 3], axis=1)
    similar = poses[:, :3, 2] @ poses[photo, :3, 2] > MIN_COMMON_VIEW
    similar[photo] = False
    return np.argsort(np.where(similar, distance, np.inf), kind="stable")[: min(count, similar.sum())]


def squared_distances(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Squared distances (n, m), float32, of descriptors (n, d) and (m, d), uint8."""
    a, b = a.astype(np.float32), b.astype(np.float32)
    return np.maximum((a * a).sum(axis=1)[:, None] + (b * b).sum(axis=1) - 2 * a @ b.T, 0)


def point_tracks(poses: np.ndarray, keypoints: Sequence[PointKeypoints]) -> Tuple[Observations, np.ndarray]:
    """Observations of points that two photos show, or one with depth, at most one per photo and point.

    :returns: the observations, and the index of each among the keypoints of all photos
    """
    first = np.cumsum([0, *(len(each.xy) for each in keypoints)])
    pairs = {(min(i, j), max(i, j)) for i in range(len(poses)) for j in neighbours(poses, i, NEIGHBOURS)}
    links: List[np.ndarray] = [np.zeros((0, 2), int)]
    for i, j in sorted(pairs):
        a, b = _matches(np.linalg.inv(poses[j]) @ poses[i], keypoints[i], keypoints[j])
        links.append(np.stack([first[i] + a, first[j] + b], axis=1))
    depth = np.concatenate([np.zeros(0), *(each.depth for each in keypoints)])
    photo_of = np.repeat(np.arange(len(keypoints)), np.diff(first))
    rows, point = _components(np.concatenate(links), photo_of, np.isfinite(depth))
    photo = np.searchsorted(first, rows, "right") - 1
    xy = np.concatenate([np.zeros((0, 2)), *(each.xy for each in keypoints)])
    sigma = np.concatenate([np.zeros(0), *(each.sigma for each in keypoints)])
    return Observations(point, photo, xy[rows], sigma[rows], depth[rows]), rows


def _components(links: np.ndarray, photo: np.ndarray, measured: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Keypoints of connected components without two keypoints of one photo, and their components from 0.

    :param measured: bool (n,) keypoints that may be alone
    """
    size = len(photo)
    graph = coo_matrix((np.ones(len(links)), links.T), (size, size))
    _, component = connected_components(graph, directed=False)
    good = (np.bincount(component)[component] > 1) | measured
    in_photo, count = np.unique(np.stack([component, photo], axis=1), axis=0, return_counts=True)
    good &= ~np.isin(component, in_photo[count > 1, 0])
    rows = np.flatnonzero(good)
    return rows, np.unique(component[rows], return_inverse=True)[1]


def _matches(T_b_a: np.ndarray, a: PointKeypoints, b: PointKeypoints) -> Tuple[np.ndarray, np.ndarray]:
    """Mutual nearest neighbours near each other's epipolar line, clearly better than the second candidate."""
    if min(len(a.xy), len(b.xy)) < 2:
        return np.zeros(0, int), np.zeros(0, int)
    distances = squared_distances(a.descriptors, b.descriptors)
    distances[~_is_possible(T_b_a, a, b)] = np.inf
    of_a, of_b = distances.argmin(axis=1), distances.argmin(axis=0)
    best = distances[np.arange(len(a.xy)), of_a]
    second_of_a = np.partition(distances, 1, axis=1)[:, 1]
    second_of_b = np.partition(distances, 1, axis=0)[1]
    limit = MAX_RATIO**2 * np.minimum(second_of_a, second_of_b[of_a])
    found = np.flatnonzero(np.isfinite(best) & (of_b[of_a] == np.arange(len(a.xy))) & (best < limit))
    return found, of_a[found]


def _is_possible(T_b_a: np.ndarray, a: PointKeypoints, b: PointKeypoints) -> np.ndarray:
    """Pairs (n, m) of similar size near each other's epipolar line (Sampson distance)."""
    x, y, z = T_b_a[:3, 3]
    E = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]) @ T_b_a[:3, :3]
    a_xy1, b_xy1 = (np.c_[each.xy, np.ones(len(each.xy))] for each in (a, b))
    in_b, in_a = a_xy1 @ E.T, b_xy1 @ E
    variance = np.outer((in_b[:, :2] ** 2).sum(axis=1), b.sigma**2)
    variance += np.outer(a.sigma**2, (in_a[:, :2] ** 2).sum(axis=1))
    near = (in_b @ b_xy1.T) ** 2 <= BAND**2 * variance
    return near & (np.abs(np.log(a.size[:, None] / b.size)) <= np.log(MAX_SIZE_RATIO))
