# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whether what a picture and a photo of the map have in common lies in one arrangement.

Across seasons a vote on the displacement of keypoints stands where RANSAC finds nothing; it needs no overlap
of more than a few, and its cost does not depend on how many are wrong.
"""

import numpy as np

CELL = 0.2  # of a longer side: so much a displacement may differ between near and far
REACH = 1.6  # longer sides, a whole number of cells; displacements beyond it do not occur


def displacement_support(
    query_xy: np.ndarray, photo_xy: np.ndarray, weights: np.ndarray, photos: np.ndarray, count: int
) -> np.ndarray:
    """The weight of the most common displacement of matched keypoints, of each photo; (count,).

    :param query_xy: (m, 2) keypoints of the picture, in longer sides of it
    :param photo_xy: (m, 2) their counterparts, in longer sides of their photo
    :param weights: (m,)
    :param photos: int (m,) from 0 to count - 1: which photo a match is of
    """
    side = int(np.ceil(2 * REACH / CELL)) + 2
    cells = np.clip((photo_xy - query_xy + REACH) / CELL, 0, side - 2 - 1e-6)
    low = np.floor(cells).astype(int)
    part = cells - low
    keys, shares = [], []
    for dx in (0, 1):  # shared among the four nearest cells, so that their borders do not matter
        for dy in (0, 1):
            keys.append((photos.astype(np.int64) * side + low[:, 1] + dy) * side + low[:, 0] + dx)
            shares.append(weights * np.abs(1 - dx - part[:, 0]) * np.abs(1 - dy - part[:, 1]))
    taken, cell = np.unique(np.concatenate(keys), return_inverse=True)
    votes = np.bincount(cell, np.concatenate(shares), minlength=len(taken))
    support = np.zeros(count)
    if len(taken):
        voted, begin = np.unique(taken // side**2, return_index=True)
        support[voted] = np.maximum.reduceat(votes, begin)
    return support
