# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Geometric verification of matches by a Hough vote on the displacement of keypoints.

Across seasons the vote needs fewer inliers than RANSAC, and its cost does not depend on the outlier ratio.
"""

import numpy as np

CELL = 0.2  # fraction of the longer side; coarse, because displacements depend on depth
REACH = 1.6  # maximum displacement as a fraction of the longer side, a multiple of CELL


def displacement_support(
    query_xy: np.ndarray, photo_xy: np.ndarray, weights: np.ndarray, photos: np.ndarray, count: int
) -> np.ndarray:
    """Weight (count,) of the most common displacement of matched keypoints of each photo.

    :param query_xy: (m, 2) keypoints of the image, as fractions of its longer side
    :param photo_xy: (m, 2) matched keypoints of the photo, as fractions of its longer side
    :param weights: (m,) of the matches
    :param photos: int (m,) from 0 to count - 1: photo of each match
    :param count: number of photos
    """
    side = int(np.ceil(2 * REACH / CELL)) + 2  # cells per side of the Hough space
    cells = np.clip((photo_xy - query_xy + REACH) / CELL, 0, side - 2 - 1e-6)
    corner = np.floor(cells).astype(int)
    fraction = cells - corner
    keys, cell_weights = [], []
    for dx in (0, 1):  # bilinear interpolation between the four nearest cells
        for dy in (0, 1):
            keys.append((photos.astype(np.int64) * side + corner[:, 1] + dy) * side + corner[:, 0] + dx)
            cell_weights.append(weights * np.abs(1 - dx - fraction[:, 0]) * np.abs(1 - dy - fraction[:, 1]))
    occupied, cell = np.unique(np.concatenate(keys), return_inverse=True)
    votes = np.bincount(cell, np.concatenate(cell_weights), minlength=len(occupied))
    support = np.zeros(count)
    if len(occupied):
        matched, begin = np.unique(occupied // side**2, return_index=True)
        support[matched] = np.maximum.reduceat(votes, begin)
    return support
