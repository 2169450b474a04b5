# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whether what a picture and a photo of the map have in common lies in one arrangement.

Across seasons a vote on the displacement of keypoints stands where RANSAC finds nothing; it needs no overlap
of more than a few, and its cost does not depend on how many are wrong.
"""

import numpy as np

CELL = 0.2  # of a width: so much a displacement may differ between near and far
REACH = 1.6  # whole cells; widths; displacements beyond it do not occur


def displacement_support(
    query_xy: np.ndarray, photo_xy: np.ndarray, weights: np.ndarray, groups: np.ndarray, count: int
) -> np.ndarray:
    """The weight of the most common displacement of matched keypoints, in each group of matches; (count,).

    :param query_xy: (m, 2) keypoints of the picture, in widths of it
    :param photo_xy: (m, 2) their counterparts, in widths of their photo
    :param weights: (m,)
    :param groups: int (m,) from 0 to count - 1: which photo a match is of
    """
    side = int(np.ceil(2 * REACH / CELL)) + 2
    cells = np.clip((photo_xy - query_xy + REACH) / CELL, 0, side - 2 - 1e-6)
    low = np.floor(cells).astype(int)
    part = cells - low
    votes = np.zeros(count * side * side)
    for dx in (0, 1):  # shared among the four nearest cells, so that their borders do not matter
        for dy in (0, 1):
            share = np.abs(1 - dx - part[:, 0]) * np.abs(1 - dy - part[:, 1])
            index = (groups * side + low[:, 1] + dy) * side + low[:, 0] + dx
            votes += np.bincount(index, weights * share, minlength=len(votes))
    return votes.reshape(count, -1).max(axis=1) if count else np.zeros(0)
