# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Depth images as REP 118 has them."""

import numpy as np


def metres_of(depth: np.ndarray) -> np.ndarray:
    """float32 metres, 0 where there is none, of a depth image of REP 118 (uint16 mm or float32 m).

    :raises ValueError: it is of another kind
    """
    if depth.ndim == 2 and depth.dtype == np.uint16:
        return depth.astype(np.float32) * np.float32(1e-3)
    if depth.ndim == 2 and depth.dtype == np.float32:
        return np.where(np.isfinite(depth) & (depth > 0), depth, np.float32(0))
    raise ValueError(f"a depth image is {depth.dtype} {depth.shape}, it must be 16UC1 (mm) or 32FC1 (m)")
