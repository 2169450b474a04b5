# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Image pyramids: textures of the ground, sampled at the size of a pixel (Williams 1983)."""

from typing import List

import cv2
import numpy as np

Pyramid = List[np.ndarray]  # uint8 (rows, columns) or (rows, columns, 3); each level has half the size


def pyramid(picture: np.ndarray) -> Pyramid:
    """The levels of a picture, the finest first."""
    levels = [picture]
    while min(levels[-1].shape[:2]) >= 16:
        rows, columns = levels[-1].shape[:2]
        levels.append(cv2.resize(levels[-1], (columns // 2, rows // 2), interpolation=cv2.INTER_AREA))
    return levels


def sampled(
    levels: Pyramid, x: np.ndarray, y: np.ndarray, footprint: np.ndarray, border: int = cv2.BORDER_REPLICATE
) -> np.ndarray:
    """Interpolates between the two levels whose texels are closest to the pixel size, float32.

    :param x: y: (rows, columns) texels of the finest level
    :param footprint: (rows,) size of a pixel, texels of the finest level
    :param border: of cv2.remap
    """
    wanted = np.clip(np.log2(np.maximum(footprint, 1e-6)), 0, len(levels) - 1.001)
    channels = levels[0].shape[2:]
    seen = np.empty((*x.shape, *channels), np.float32)
    for level in np.unique(wanted.astype(int)):
        rows = wanted.astype(int) == level
        finer, coarser = (
            cv2.remap(
                levels[each],
                np.float32((x[rows] + 0.5) / 2**each - 0.5),
                np.float32((y[rows] + 0.5) / 2**each - 0.5),
                cv2.INTER_LINEAR,
                borderMode=border,
            )
            for each in (level, level + 1)
        )
        share = np.float32(wanted[rows] - level).reshape(-1, 1, *(1 for _ in channels))
        seen[rows] = finer + share * (coarser.astype(np.float32) - finer)
    return seen
